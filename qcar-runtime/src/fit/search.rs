//! Searches from several starts within the bounds, because the cost has several local minima.
//!
//! The starts after the first are points of the additive low-discrepancy sequence of Roberts, "The unreasonable
//! effectiveness of quasirandom sequences" (2018): `frac(s + j α^k)`, with 1/α the root of `x^(n+1) = x + 1`. They
//! depend on the seed alone, and each search on its start alone, so the result does not depend on the threads.

use super::cost::Cost;
use super::setup::Setup;
use crate::least_squares::{Bounds, Options, Outcome, minimize};
use crate::model::Model;
use crate::progress::{self, OnProgress};

/// Tolerances of a local search: tight enough that searches to one minimum agree.
pub(super) const OPTIONS: Options = Options {
    gradient: 1e-8,
    cost: 1e-9,
    step: 1e-7,
    decrement: 0.0,
    evaluations: 100,
};

/// Relative difference of costs below which two searches found the same minimum.
const SAME_COST: f64 = 1e-5;

/// Results of all local searches.
pub(super) struct Search {
    /// The lowest minimum; the start if there are no free parameters.
    pub best: Outcome,
    /// Distinct minima, lowest first.
    pub minima: Vec<Minimum>,
    /// Number of evaluations in all searches.
    pub evaluations: usize,
    /// Number of local searches.
    pub starts: usize,
}

/// A minimum and the searches that ended in it.
pub(super) struct Minimum {
    pub cost: f64,
    pub x: Vec<f64>,
    pub starts: Vec<usize>,
}

impl<M: Model + ?Sized> Setup<'_, M> {
    /// One local search from these values of the free parameters. A fit spends nearly all its time here.
    pub fn local(&self, start: &[f64]) -> Outcome {
        self.search(&mut self.cost(), start)
    }

    fn search(&self, cost: &mut Cost<'_, '_, M>, start: &[f64]) -> Outcome {
        minimize(cost, start, &self.bounds, &OPTIONS)
    }
}

impl Search {
    pub fn run<M: Model + ?Sized>(setup: &Setup<'_, M>, on_progress: OnProgress<'_>) -> Self {
        let points = starts(&setup.start(), &setup.bounds, setup.plan.starts.max(1), setup.plan.seed);
        // The searches of a thread share buffers for responses and their logarithms.
        let outcomes = progress::map_with(
            &points,
            on_progress,
            || setup.cost(),
            |cost, start| setup.search(cost, start),
        );
        let evaluations = outcomes.iter().map(|outcome| outcome.evaluations).sum();
        let minima = distinct(&outcomes);
        // If no search converged, the first one is reported with its stopping reason.
        let best = minima.first().map_or(0, |minimum| minimum.starts[0]);
        let starts = outcomes.len();
        let best = outcomes.into_iter().nth(best).expect("there is at least one start");
        Self {
            best,
            minima,
            evaluations,
            starts,
        }
    }
}

/// The minima of the searches that converged, lowest first, each with the searches that found it.
fn distinct(outcomes: &[Outcome]) -> Vec<Minimum> {
    let mut order: Vec<usize> = (0..outcomes.len()).filter(|&k| outcomes[k].stop.converged()).collect();
    order.sort_by(|&a, &b| outcomes[a].cost.total_cmp(&outcomes[b].cost).then(a.cmp(&b)));
    let mut minima: Vec<Minimum> = Vec::new();
    for k in order {
        let Outcome { cost, x, .. } = &outcomes[k];
        match minima.last_mut() {
            Some(last) if cost - last.cost <= SAME_COST * last.cost => last.starts.push(k),
            _ => minima.push(Minimum {
                cost: *cost,
                x: x.clone(),
                starts: vec![k],
            }),
        }
    }
    minima
}

/// The given start, then points spread over the bounds, on a logarithmic scale if both bounds are positive. A variable
/// without finite bounds keeps its start value.
pub(crate) fn starts(given: &[f64], bounds: &Bounds, count: usize, seed: u64) -> Vec<Vec<f64>> {
    let growth = growth(given.len());
    let spread = |j: usize, k: usize| {
        // The seed times the golden section shifts the whole sequence, which keeps its spread.
        let shift = 0.5 + seed as f64 * 0.618_033_988_749_894_9;
        let part = (shift + j as f64 * growth.powi(-(k as i32 + 1))).fract();
        let (lower, upper) = (bounds.lower[k], bounds.upper[k]);
        match (lower.is_finite() && upper.is_finite(), lower > 0.0) {
            (false, _) => given[k],
            (true, true) => lower * (upper / lower).powf(part),
            (true, false) => lower + (upper - lower) * part,
        }
    };
    let others = (1..count).map(|j| (0..given.len()).map(|k| spread(j, k)).collect());
    std::iter::once(given.to_vec()).chain(others).collect()
}

/// The positive root of `x^(n+1) = x + 1`, by a fixed-point iteration.
fn growth(n: usize) -> f64 {
    (0..40).fold(1.5, |x: f64, _| (1.0 + x).powf(1.0 / (n as f64 + 1.0)))
}
