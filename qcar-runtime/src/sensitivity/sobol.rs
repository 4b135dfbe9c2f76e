//! Sobol indices: the share of a parameter in the variance of a result, alone and in interaction with others.
//!
//! The estimators are those of Saltelli, Annoni, Azzini, Campolongo, Ratto and Tarantola, "Variance based sensitivity
//! analysis of model output", Comp. Phys. Comm. 181 (2010), table 2: for the first order (b), for the total (f), which
//! is Jansen's. Confidence is by a bootstrap over the base designs (Archer, Saltelli and Sobol, J. Stat. Comput. Simul.
//! 58, 1997).

use crate::progress::{self, OnProgress};
use crate::random::SplitMix;

/// Number of designs, and seed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Plan {
    /// Largest number of designs in total. Each base design needs two more than the number of parameters.
    pub designs: usize,
    /// Seed of the random numbers.
    pub seed: u64,
}

/// The indices of every result.
#[derive(Clone, Debug, PartialEq)]
pub struct Indices {
    /// For each result and each parameter.
    pub of: Vec<Vec<Index>>,
    /// Mean and standard deviation of each result over the designs.
    pub moments: Vec<[f64; 2]>,
    /// Number of evaluated designs.
    pub designs: usize,
    /// Number of base designs that were left out because one of their designs has no results.
    pub failed: usize,
}

/// Shares of a variance with their 95 % intervals.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct Index {
    /// First-order index: share of the parameter alone.
    pub first: f64,
    /// Its confidence interval.
    pub first_interval: [f64; 2],
    /// Total index: share of the parameter with all its interactions.
    pub total: f64,
    /// Its confidence interval.
    pub total_interval: [f64; 2],
}

/// Resamples of the bootstrap.
const RESAMPLES: usize = 400;

/// The results of a base design: at A, at B, and at A with each parameter from B.
struct Row {
    a: Vec<f64>,
    b: Vec<f64>,
    mixed: Vec<Vec<f64>>,
}

/// Indices of `parameters` parameters that are uniform in a unit cube. `evaluate` gives the results of several designs
/// at once; `None` for a design without results.
pub fn indices(
    parameters: usize,
    plan: Plan,
    on_progress: OnProgress<'_>,
    evaluate: impl Fn(&[Vec<f64>]) -> Vec<Option<Vec<f64>>> + Sync + Send,
) -> Indices {
    let bases = (plan.designs / (parameters + 2)).max(2);
    // One hypercube for both, so that A and B are independent and each covers the ranges evenly.
    let points = SplitMix::new(plan.seed).hypercube(bases, 2 * parameters);
    let row = |point: &Vec<f64>| {
        let (a, b) = point.split_at(parameters);
        let mixed = (0..parameters).map(|k| {
            let mut design = a.to_vec();
            design[k] = b[k];
            design
        });
        let designs: Vec<Vec<f64>> = [a.to_vec(), b.to_vec()].into_iter().chain(mixed).collect();
        let mut found = evaluate(&designs).into_iter();
        Some(Row {
            a: found.next()??,
            b: found.next()??,
            mixed: found.collect::<Option<_>>()?,
        })
    };
    let rows: Vec<Row> = progress::map(&points, on_progress, row).into_iter().flatten().collect();
    let results = rows.first().map_or(0, |row| row.a.len());
    let all: Vec<usize> = (0..rows.len()).collect();
    let resamples = resamples(rows.len(), plan.seed);
    let of = |result: usize| {
        (0..parameters)
            .map(|k| index(&rows, &all, &resamples, result, k))
            .collect()
    };
    Indices {
        of: (0..results).map(of).collect(),
        moments: (0..results).map(|result| moments(&rows, &all, result)).collect(),
        designs: bases * (parameters + 2),
        failed: bases - rows.len(),
    }
}

fn resamples(rows: usize, seed: u64) -> Vec<Vec<usize>> {
    let mut random = SplitMix::new(seed ^ 0x5bd1_e995);
    let mut resample = || (0..rows).map(|_| random.below(rows)).collect();
    (0..if rows == 0 { 0 } else { RESAMPLES }).map(|_| resample()).collect()
}

fn index(rows: &[Row], all: &[usize], resamples: &[Vec<usize>], result: usize, k: usize) -> Index {
    let [first, total] = shares(rows, all, result, k);
    let again: Vec<[f64; 2]> = resamples.iter().map(|own| shares(rows, own, result, k)).collect();
    Index {
        first,
        first_interval: interval(again.iter().map(|own| own[0])),
        total,
        total_interval: interval(again.iter().map(|own| own[1])),
    }
}

/// First-order and total index from the chosen rows.
fn shares(rows: &[Row], chosen: &[usize], result: usize, k: usize) -> [f64; 2] {
    let [mean, deviation] = moments(rows, chosen, result);
    let (mut alone, mut together) = (0.0, 0.0);
    for row in chosen.iter().map(|&at| &rows[at]) {
        let [a, b, mixed] = [row.a[result], row.b[result], row.mixed[k][result]];
        // The mean is subtracted: the estimate stays the same, and its scatter does not grow with a constant in the
        // result.
        alone += (b - mean) * (mixed - a);
        together += 0.5 * (a - mixed).powi(2);
    }
    let scale = chosen.len() as f64 * deviation * deviation;
    if scale > 0.0 {
        [alone / scale, together / scale]
    } else {
        [0.0; 2]
    }
}

/// Mean and standard deviation of a result over A and B.
fn moments(rows: &[Row], chosen: &[usize], result: usize) -> [f64; 2] {
    let values = || chosen.iter().flat_map(|&at| [rows[at].a[result], rows[at].b[result]]);
    let count = 2.0 * chosen.len() as f64;
    let mean = values().sum::<f64>() / count;
    let variance = values().map(|value| (value - mean).powi(2)).sum::<f64>() / (count - 1.0);
    [mean, variance.sqrt()]
}

/// The central 95 % of values.
fn interval(of: impl Iterator<Item = f64>) -> [f64; 2] {
    let mut sorted: Vec<f64> = of.collect();
    sorted.sort_by(f64::total_cmp);
    let at = |part: f64| sorted.get(((sorted.len().max(1) - 1) as f64 * part).round() as usize);
    [0.025, 0.975].map(|part| at(part).copied().unwrap_or(f64::NAN))
}
