//! Lines of different runs at the same frequency. Runs may differ in their bands and in the distances of their lines.

use crate::discover::observe::nearest;

/// Position of the line at `wanted` (Hz) among the increasing frequencies of a run: the nearest one. `None` if it lies
/// beyond the first or the last line by more than half the distance of the lines there.
pub fn same_line(frequency: &[f64], wanted: f64) -> Option<usize> {
    let last = frequency.len().checked_sub(1)?;
    let half = |[low, high]: [usize; 2]| (frequency[high] - frequency[low]) / 2.0;
    let low = frequency[0] - half([0, last.min(1)]);
    let high = frequency[last] + half([last.saturating_sub(1), last]);
    (low..=high).contains(&wanted).then(|| nearest(frequency, wanted))
}
