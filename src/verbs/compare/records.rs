//! Records of one cleat run, aligned at the time at which the wheel reaches the cleat: peaks and after-shakes of thesis
//! section 3.6.2, and traces.

use std::collections::BTreeMap;

use qcar_runtime::compare::{Alignment, CompareError, Errors, Windows};
use serde::Serialize;

use crate::report::rounded::curve;

/// A mass and an axis.
pub(super) type Key = (String, String);

/// Accelerations of a cleat run, m/s².
pub(super) type Record<'a> = BTreeMap<Key, &'a [f64]>;

/// Time before the impact that is shown, s.
const RUN_IN: f64 = 0.05;

/// A cleat run of both sides.
#[derive(Serialize)]
pub(super) struct Compared {
    /// One entry for each mass and axis of both sides.
    pub metrics: Vec<Metrics>,
    /// Time after the impact of the wheel of A, s.
    pub time: Vec<f64>,
    pub traces: Vec<Trace>,
}

/// A mass along an axis.
#[derive(Serialize)]
pub(super) struct Metrics {
    pub mass: String,
    pub axis: String,
    pub peak: Metric,
    pub after_shake: Metric,
}

/// A value of both sides, m/s².
#[derive(Serialize)]
pub(super) struct Metric {
    pub a: f64,
    pub b: f64,
    /// Relative difference (B - A)/A.
    pub change: Option<f64>,
    /// Measured value, of the common campaign or of both.
    pub measured: Vec<f64>,
}

impl Metric {
    /// Relative difference of both measurements.
    pub(super) fn measured_change(&self) -> Option<f64> {
        match self.measured[..] {
            [a, b] => Some((b - a) / a).filter(|change| change.is_finite()),
            _ => None,
        }
    }
}

/// Accelerations over time, m/s².
#[derive(Serialize)]
pub(super) struct Trace {
    pub mass: String,
    pub axis: String,
    pub a: Vec<f64>,
    pub b: Vec<f64>,
    pub measured: Vec<Vec<f64>>,
}

/// Compares simulated records of both sides, and measured records with them. All have one sample rate (Hz). The first
/// recorded mass of `feeling`, the wheel, determines the time of the impact.
///
/// # Errors
/// Fails if the wheel has no impact, or if a record ends too early.
pub(super) fn compared(
    sides: &[Record; 2],
    measured: &[Record],
    feeling: &[Key],
    rate: f64,
) -> Result<Compared, CompareError> {
    let [a, b] = sides;
    let onset = |of: &Record| onset(of, feeling);
    let felt = onset(a)?.unwrap_or(0);
    let onsets: Vec<usize> = measured
        .iter()
        .map(|own| Ok(onset(own)?.unwrap_or(felt)))
        .collect::<Result<_, CompareError>>()?;
    let shared: Vec<&Key> = a.keys().filter(|key| b.contains_key(*key)).collect();
    let window = Windows::default();
    let samples = |seconds: f64| (seconds * rate).round() as isize;
    let places = -samples(RUN_IN)..samples(window.impact + window.after_shake);
    let cut = |record: &Record, key: &Key, onset: usize| {
        curve(
            places
                .clone()
                .map(|place| sample(record.get(key).copied(), place + onset as isize)),
        )
    };
    let trace = |key: &&Key| Trace {
        mass: key.0.clone(),
        axis: key.1.clone(),
        a: cut(a, key, felt),
        b: cut(b, key, felt),
        measured: measured
            .iter()
            .zip(&onsets)
            .map(|(own, &onset)| cut(own, key, onset))
            .collect(),
    };
    let metrics = shared.iter().map(|key| metrics(key, sides, measured, (feeling, rate)));
    Ok(Compared {
        metrics: metrics.collect::<Result<_, _>>()?,
        time: curve(places.clone().map(|place| place as f64 / rate)),
        traces: shared.iter().map(trace).collect(),
    })
}

/// Time of the impact of the first recorded mass of `feeling`; `None` without any.
fn onset(of: &Record, feeling: &[Key]) -> Result<Option<usize>, CompareError> {
    let first = feeling.iter().find_map(|key| of.get(key));
    first
        .map(|wheel| Ok(Alignment::at_peak(wheel, wheel)?.onset))
        .transpose()
}

fn metrics(key: &Key, [a, b]: &[Record; 2], measured: &[Record], read: (&[Key], f64)) -> Result<Metrics, CompareError> {
    let (first, second) = (sizes(a, key, read)?, sizes(b, key, read)?);
    let observed = measured.iter().map(|own| sizes(own, key, read));
    let observed = observed.collect::<Result<Vec<_>, _>>()?;
    let metric = |at: usize| {
        let (a, b) = (first[at], second[at]);
        Metric {
            a,
            b,
            change: Some((b - a) / a).filter(|change| change.is_finite()),
            measured: observed.iter().map(|own| own[at]).collect(),
        }
    };
    Ok(Metrics {
        mass: key.0.clone(),
        axis: key.1.clone(),
        peak: metric(0),
        after_shake: metric(1),
    })
}

/// Peak and after-shake of a record, from the impact of its own wheel; NaN if they are not in the record.
fn sizes(of: &Record, key: &Key, (feeling, rate): (&[Key], f64)) -> Result<[f64; 2], CompareError> {
    let Some(own) = of.get(key) else {
        return Ok([f64::NAN; 2]);
    };
    let alignment = Alignment {
        onset: onset(of, feeling)?.unwrap_or(0),
        delay: 0,
    };
    let errors = Errors::between(own, own, &alignment, rate, &Windows::default())?;
    Ok([errors.peaks[0], errors.after_shakes[0]])
}

/// Value of a record; NaN beyond its ends and without a record.
fn sample(record: Option<&[f64]>, place: isize) -> f64 {
    let place = usize::try_from(place).ok();
    let found = record.zip(place).and_then(|(record, place)| record.get(place));
    found.copied().unwrap_or(f64::NAN)
}
