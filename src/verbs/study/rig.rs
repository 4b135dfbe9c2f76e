//! Ratios over frequency, measured and of the model: at its start values, fitted, and extended.

use nalgebra::Complex;
use qcar_runtime::campaign::Role;
use qcar_runtime::fit::observation::Observation;
use qcar_runtime::fit::quality::{Quality, quality};
use serde::Serialize;

use super::gather::Study;
use super::level_responses::{LevelResponses, swept_by};
use crate::progress::while_counting;
use crate::report::rounded::curve;
use crate::verbs::fit::files::{Compared, compare};

/// A channel in a run.
#[derive(Serialize)]
pub struct Ratio {
    run: String,
    /// Role: `fit` or `held_out`.
    pub role: &'static str,
    channel: String,
    /// SI unit of the ratio.
    unit: String,
    /// True if it is part of the cost.
    fitted: bool,
    /// Frequencies, Hz.
    frequency: Vec<f64>,
    coherence: Vec<f64>,
    measured: Polar,
    /// Uncertainty of the measurement to either side.
    band: Polar,
    start: Polar,
    before: Polar,
    after: Option<Polar>,
    /// Ratio of the fitted model.
    pub quality_before: Quality,
    /// Ratio of the extended model.
    pub quality_after: Option<Quality>,
}

/// Magnitude and phase.
#[derive(Serialize)]
pub struct Polar {
    /// Magnitude, dB.
    pub magnitude: Vec<f64>,
    /// Phase, degrees.
    pub phase: Vec<f64>,
}

/// All measured ratios.
pub fn ratios(of: &Study) -> Vec<Ratio> {
    let after = of.after.as_ref();
    let mut after = after.map(|after| {
        while_counting(swept_by(&of.fitted.campaign.name, &*after.model), |on_progress| {
            LevelResponses::new(&*after.model, &after.values, &of.answer.evidence, on_progress)
        })
    });
    let compared = compare(&of.fitted);
    compared
        .iter()
        .map(|compared| together(compared, after.as_mut()))
        .collect()
}

fn together(of: &Compared, after: Option<&mut LevelResponses>) -> Ratio {
    let Compared { level, observation, .. } = of;
    let measured = unwrapped(&observation.value);
    let after = after.and_then(|after| {
        after.ratio(
            &level.name,
            level.excitation,
            &observation.channel,
            &observation.frequency,
        )
    });
    let quality = |values: &[Complex<f64>]| known(observation, values);
    let beside = |values: &[Complex<f64>]| Polar::new(values, &nearest(values, &measured));
    Ratio {
        run: level.name.clone(),
        role: if level.role == Role::Fit { "fit" } else { "held_out" },
        channel: observation.channel.name.to_string(),
        unit: of.unit.clone(),
        fitted: observation.fitted && level.role == Role::Fit,
        frequency: curve(observation.frequency.iter().copied()),
        coherence: curve(observation.coherence.iter().copied()),
        measured: Polar::new(&observation.value, &measured),
        band: band(observation),
        start: beside(&of.before),
        before: beside(&of.after),
        after: after.as_deref().map(beside),
        quality_before: quality(&of.after),
        quality_after: after.as_deref().map(quality),
    }
}

impl Polar {
    /// Values with these phases (rad).
    pub fn new(values: &[Complex<f64>], phase: &[f64]) -> Self {
        Polar {
            magnitude: curve(values.iter().map(|value| 20.0 * value.norm().log10())),
            phase: curve(phase.iter().map(|phase| phase.to_degrees())),
        }
    }
}

/// Fit percentages over the lines at which the model is known.
fn known(of: &Observation, values: &[Complex<f64>]) -> Quality {
    let lines: Vec<usize> = (0..values.len()).filter(|&line| values[line].re.is_finite()).collect();
    let at = |values: &[Complex<f64>]| lines.iter().map(|&line| values[line]).collect::<Vec<_>>();
    let frequency: Vec<f64> = lines.iter().map(|&line| of.frequency[line]).collect();
    quality(&frequency, &at(values), &at(&of.value))
}

/// Uncertainty of the measurement, to either side.
pub fn band(of: &Observation) -> Polar {
    let spread = of.spread();
    Polar {
        magnitude: curve(spread.iter().map(|spread| 20.0 * spread.re / std::f64::consts::LN_10)),
        phase: curve(spread.iter().map(|spread| spread.im.to_degrees())),
    }
}

/// Unwrapped phases, rad.
pub fn unwrapped(values: &[Complex<f64>]) -> Vec<f64> {
    let mut last = 0.0;
    let phases = values.iter().map(|value| {
        last = close(value.arg(), last);
        last
    });
    phases.collect()
}

/// Phases shifted by full turns to be close to others.
pub fn nearest(values: &[Complex<f64>], others: &[f64]) -> Vec<f64> {
    values
        .iter()
        .zip(others)
        .map(|(value, &other)| close(value.arg(), other))
        .collect()
}

/// An angle plus the full turns that bring it closest to another.
fn close(angle: f64, other: f64) -> f64 {
    if other.is_finite() && angle.is_finite() {
        angle + std::f64::consts::TAU * ((other - angle) / std::f64::consts::TAU).round()
    } else {
        angle
    }
}
