//! How evenly times must come to be samples of one rate.

/// Largest relative difference between the declared sample rate and that of the whole record. Below it, the phase error
/// of a transmissibility is nil, since all channels share the clock, and frequencies are that exact.
const RATE_TOLERANCE: f64 = 1e-3;

/// Whether a step is one sample long, and not none or two. Printed times are rounded, so that a single step is only right to
/// that extent.
pub(super) fn is_one(step: f64, rate: f64) -> bool {
    (0.5..=1.5).contains(&(step * rate))
}

/// Whether a record of so many steps that has this rate on average may have been taken at another.
pub(super) fn agree(measured: f64, rate: f64, steps: usize) -> bool {
    (measured / rate - 1.0).abs() <= RATE_TOLERANCE + 0.5 / steps as f64
}

/// The middle value; there must be one.
pub(super) fn median(values: &[f64]) -> f64 {
    let mut sorted = values.to_vec();
    let (_, median, _) = sorted.select_nth_unstable_by(values.len() / 2, f64::total_cmp);
    *median
}
