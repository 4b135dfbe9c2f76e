//! Values that a discrepancy correlates: where they stand, and the signal that it is a part of.

use crate::discover::numbers::Numbers;
use crate::discover::observe::{Evidence, Kind, Series};
use crate::mean::rms;

/// A value of a group.
pub struct Value {
    pub run: usize,
    /// Where it stands, in units of the distance at which correlation ends.
    pub place: f64,
    pub rows: [usize; 2],
    pub parts: usize,
    /// The signal there over the noise.
    pub scale: f64,
}

/// The values of a series whose first residual stands in row `first`.
pub fn values(evidence: &Evidence, series: &Series, first: usize) -> Vec<Value> {
    let parts = if series.kind.complex() { 2 } else { 1 };
    let (places, signal) = (places(series, &evidence.numbers), signal(evidence, series));
    let of = |k: usize| Value {
        run: series.run,
        place: places[k],
        rows: [first + k * parts, first + k * parts + parts - 1],
        parts,
        scale: signal[k] / series.noise[k],
    };
    (0..series.at.len()).map(of).collect()
}

/// Where the values of a series stand, in units of the distance at which correlation ends: of harmonics a part of an
/// octave, of records half a period of their own mean frequency, of a cycle of travel a quarter of it.
fn places(series: &Series, numbers: &Numbers) -> Vec<f64> {
    let distance = match series.kind {
        Kind::Harmonic(_) | Kind::Cycle(_) => {
            let octaves = series.at.iter().map(|at| at.log2());
            return octaves.map(|at| at / numbers.correlation_octaves).collect();
        }
        Kind::Travel | Kind::Width | Kind::Speed => (series.at[series.at.len() - 1] - series.at[0]) / 4.0,
        Kind::Time | Kind::Passage => series.half_a_period(),
    };
    let distance = distance.max(f64::MIN_POSITIVE);
    let apart = match series.kind {
        Kind::Time | Kind::Passage => RECORDS_APART * series.run as f64,
        _ => 0.0,
    };
    series
        .at
        .iter()
        .map(|at| apart + (at - series.at[0]) / distance)
        .collect()
}

/// Two records have no time in common: they stand so far apart.
const RECORDS_APART: f64 = 1e6;

/// What a discrepancy is a part of: of harmonics the first one of the same sensor at the same frequency, of anything else
/// the RMS value of the series around.
fn signal(evidence: &Evidence, series: &Series) -> Vec<f64> {
    let fundamental = |order: usize| {
        let first = match series.kind {
            Kind::Cycle(_) => Kind::Cycle(1),
            _ => Kind::Harmonic(1),
        };
        let is_it = |other: &&Series| other.run == series.run && other.sensor == series.sensor && other.kind == first;
        evidence.series.iter().find(is_it).filter(|_| order > 1)
    };
    let own: Vec<f64> = series.value.iter().map(|value| value.norm()).collect();
    match series.kind {
        Kind::Harmonic(order) | Kind::Cycle(order) => match fundamental(order) {
            Some(first) => {
                let norms: Vec<f64> = first.value.iter().map(|value| value.norm()).collect();
                series.at.iter().map(|at| norms[nearest(&first.at, *at)]).collect()
            }
            None => own,
        },
        Kind::Time | Kind::Travel | Kind::Width | Kind::Speed => vec![rms(&own); own.len()],
        Kind::Passage => {
            let around = |k: usize| rms(&own[k.saturating_sub(AROUND)..(k + AROUND + 1).min(own.len())]);
            (0..own.len()).map(around).collect()
        }
    }
}

/// Values to each side over which the signal of a passage is taken: with means of 5 ms a period of a wheel's hop.
const AROUND: usize = 10;

fn nearest(at: &[f64], wanted: f64) -> usize {
    let after = at.partition_point(|at| *at < wanted).min(at.len() - 1);
    let before = after.saturating_sub(1);
    if (at[before] - wanted).abs() < (at[after] - wanted).abs() {
        before
    } else {
        after
    }
}

/// Number of runs that values are of.
pub fn runs(values: &[Value]) -> usize {
    let mut runs: Vec<usize> = values.iter().map(|value| value.run).collect();
    runs.sort_unstable();
    runs.dedup();
    runs.len().max(1)
}
