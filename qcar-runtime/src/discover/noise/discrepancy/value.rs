//! Values that a discrepancy correlates, with their position and signal.

use crate::discover::numbers::Numbers;
use crate::discover::observe::{Evidence, Kind, Series, envelope, nearest};
use crate::mean::rms;

/// A value of a group.
pub struct Value {
    pub run: usize,
    /// Position, in units of the correlation length.
    pub place: f64,
    pub rows: [usize; 2],
    pub parts: usize,
    /// Ratio of signal to noise.
    pub scale: f64,
}

/// The values of a series; `first` is the row of its first residual.
pub fn values(evidence: &Evidence, series: &Series, first: usize) -> Vec<Value> {
    let parts = series.kind.parts();
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

/// Positions of the values of a series in units of the correlation length: a part of an octave for harmonics, half the
/// mean period for records and passages, a quarter of the range for K&C curves and dynamometer tables.
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

/// Distance between two records, in correlation lengths, so that they are uncorrelated: longer than any record.
const RECORDS_APART: f64 = 1e6;

/// Signal that scales the discrepancy of each value: for harmonics, the first harmonic of the same sensor at the same
/// frequency; for a passage, the RMS around the value; otherwise the RMS of the series.
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
        Kind::Passage => (0..own.len()).map(|k| envelope(&own, k)).collect(),
    }
}

/// Number of runs among the values, at least 1.
pub fn runs(values: &[Value]) -> usize {
    let mut runs: Vec<usize> = values.iter().map(|value| value.run).collect();
    runs.sort_unstable();
    runs.dedup();
    runs.len().max(1)
}
