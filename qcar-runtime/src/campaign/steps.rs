//! How even times must be to be samples of one rate.

/// Largest relative difference between the declared sample rate and that of the whole record. Below it, the phase error
/// of a transmissibility is nil, since all channels share the clock, and frequencies are that exact.
const RATE_TOLERANCE: f64 = 1e-3;

/// How far a step may be from the mean for the shortest and the longest to be one sample by each other's length.
const ALIKE: f64 = 0.1;

/// Whether a step is one sample long, and not none or two. Printed times are rounded, so that a single step is only right to
/// that extent.
pub(super) fn is_one(step: f64, rate: f64) -> bool {
    (0.5..=1.5).contains(&(step * rate))
}

/// Whether all steps between times are one sample long, whichever of them is the reference: none is a tenth longer or shorter than
/// their mean.
pub(super) fn all_alike(times: &[f64]) -> bool {
    let ends = times.first().zip(times.last());
    let mean = ends.map_or(f64::NAN, |(first, last)| (last - first) / (times.len() - 1) as f64);
    mean > 0.0
        && times
            .windows(2)
            .all(|two| (two[1] - two[0] - mean).abs() < ALIKE * mean)
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
