//! Tolerances for evenly spaced times.

/// Largest relative difference between the declared sample rate and the mean rate of a record. All channels share the
/// clock, so transmissibilities have no phase error, and their frequencies have this relative error.
const RATE_TOLERANCE: f64 = 1e-3;

/// Largest relative deviation of a step from the mean if the shortest and the longest step are to count as equal.
const ALIKE: f64 = 0.1;

/// Largest relative deviation of a typical step from one sample. A choice, midway between none and that of half the true
/// rate, 0.5.
const NEAR: f64 = 0.25;

/// True if a step is one sample long, instead of none or two. Printed times are rounded, so a single step is only this
/// accurate.
pub(super) fn is_one(step: f64, rate: f64) -> bool {
    (0.5..=1.5).contains(&(step * rate))
}

/// True if a typical or mean step (s) is one sample long and not, say, two.
pub(super) fn is_near(step: f64, rate: f64) -> bool {
    (step * rate - 1.0).abs() < NEAR
}

/// True if all steps are one sample long: none differs from the mean by more than a tenth.
pub(super) fn all_alike(times: &[f64]) -> bool {
    let ends = times.first().zip(times.last());
    let mean = ends.map_or(f64::NAN, |(first, last)| (last - first) / (times.len() - 1) as f64);
    mean > 0.0
        && times
            .windows(2)
            .all(|two| (two[1] - two[0] - mean).abs() < ALIKE * mean)
}

/// True if a record with this number of steps and this mean rate may have been sampled at another rate.
pub(super) fn agree(measured: f64, rate: f64, steps: usize) -> bool {
    (measured / rate - 1.0).abs() <= RATE_TOLERANCE + 0.5 / steps as f64
}

/// Median; there must be a value.
pub(super) fn median(values: &[f64]) -> f64 {
    let mut sorted = values.to_vec();
    let (_, median, _) = sorted.select_nth_unstable_by(values.len() / 2, f64::total_cmp);
    *median
}
