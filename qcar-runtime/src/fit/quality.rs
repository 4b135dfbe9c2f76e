//! The fit percentage of thesis section 3.5.2.4: `100 exp(−k E)`, with E the error of a channel in one run, weighted by
//! the width of its lines in log-frequency.

use super::cost::smallest;
use nalgebra::Complex;
use std::f64::consts::LN_10;

/// Decay with the mean magnitude error, 1/dB: each dB costs about a tenth. The thesis does not give its constant; with
/// this one its rig fits of 79 to 92 % (table 4.1) correspond to mean errors of 2.4 to 0.8 dB.
pub const K_MAGNITUDE: f64 = 0.1;

/// Decay with the RMS phase error, 1/rad: errors of equal size in the complex plane cost the same.
pub const K_PHASE: f64 = K_MAGNITUDE * 20.0 / LN_10;

/// Fit percentages and errors of a channel.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct Quality {
    /// Percent.
    pub fit_magnitude: f64,
    /// Percent.
    pub fit_phase: f64,
    /// Weighted mean of the absolute magnitude error, dB.
    pub error_magnitude: f64,
    /// Weighted RMS of the phase error, rad.
    pub error_phase: f64,
}

/// Compares a model with a measurement on the same lines (`frequency` ascending).
pub fn quality(frequency: &[f64], model: &[Complex<f64>], measured: &[Complex<f64>]) -> Quality {
    let weights = weights(frequency);
    let errors: Vec<(f64, f64)> = model
        .iter()
        .zip(measured)
        .map(|(model, measured)| error(*model, *measured))
        .collect();
    let error_magnitude: f64 = weights.iter().zip(&errors).map(|(w, error)| w * error.0.abs()).sum();
    let square: f64 = weights
        .iter()
        .zip(&errors)
        .map(|(w, error)| w * error.1 * error.1)
        .sum();
    let error_phase = square.sqrt();
    Quality {
        fit_magnitude: 100.0 * (-K_MAGNITUDE * error_magnitude).exp(),
        fit_phase: 100.0 * (-K_PHASE * error_phase).exp(),
        error_magnitude,
        error_phase,
    }
}

/// Magnitude error in dB and phase error in rad.
fn error(model: Complex<f64>, measured: Complex<f64>) -> (f64, f64) {
    (
        20.0 * (model.norm() / measured.norm()).log10(),
        smallest(model.arg() - measured.arg()),
    )
}

/// Share of each line in the log-frequency axis: half the distance to either neighbour.
fn weights(frequency: &[f64]) -> Vec<f64> {
    let last = frequency.len().saturating_sub(1);
    let width = |line: usize| (frequency[(line + 1).min(last)] / frequency[line.saturating_sub(1)]).ln();
    let widths: Vec<f64> = (0..frequency.len()).map(width).collect();
    let total: f64 = widths.iter().sum();
    // A single line has all the weight.
    widths
        .iter()
        .map(|width| if total > 0.0 { width / total } else { 1.0 })
        .collect()
}
