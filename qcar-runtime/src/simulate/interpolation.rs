//! Polynomial interpolation where only one sample in each stride is known.

use std::array;
use std::ops::Range;

use crate::solver::PAST;
use crate::vectors::{Loops, widest};

/// A range of samples of which one in each stride is known.
pub(super) struct SparseRange {
    pub from: usize,
    pub to: usize,
    pub stride: usize,
    /// Reach of the anti-alias filter to each side, in samples.
    pub reach: usize,
}

/// Number of known samples that a polynomial interpolates, half of them on each side if possible. A vibration with a
/// period of ten strides is accurate to 3e-5.
const AROUND: usize = 8;
const BEFORE: usize = AROUND / 2 - 1;

impl SparseRange {
    /// Interpolates the missing points of signals that are stored phase by phase; the first phase has the samples.
    ///
    /// The signals must be smooth in the range and for as many strides before it as the integration method looked back.
    /// Points further away are not used.
    pub fn fill(&self, signals: &mut [f64], (phases, length): (usize, usize)) {
        let before = (PAST - 1).min(self.from / self.stride);
        let count = before + (self.to - self.from) / self.stride + 1;
        let points = self.stride * phases;
        let between: Vec<Interpolator> = (1..points)
            .map(|point| Interpolator::new(point as f64 / points as f64, count))
            .collect();
        let mut filled = vec![0.0; count];
        for signal in signals.chunks_exact_mut(phases * length) {
            let known = signal[self.from - before * self.stride..=self.to].iter();
            let known: Vec<f64> = known.step_by(self.stride).copied().chain([0.0; AROUND]).collect();
            for (point, between) in (1..).zip(&between) {
                let wanted = if point % phases == 0 {
                    [self.from..self.to, self.to..self.to]
                } else {
                    self.ends()
                };
                for range in wanted.into_iter().filter(|range| !range.is_empty()) {
                    let filled = &mut filled[..range.len() / self.stride];
                    between.fill(&known, before + (range.start - self.from) / self.stride, filled);
                    let place = point % phases * length + range.start + point / phases;
                    let places = signal[place..].iter_mut().step_by(self.stride);
                    places.zip(filled).for_each(|(place, value)| *place = *value);
                }
            }
        }
    }

    /// The ends of the range in which the filter reaches outside of it; a short range is one such end.
    fn ends(&self) -> [Range<usize>; 2] {
        let reach = (2 * self.reach).next_multiple_of(self.stride);
        if 2 * reach < self.to - self.from {
            [self.from..self.from + reach, self.to - reach..self.to]
        } else {
            [self.from..self.to, self.to..self.to]
        }
    }

    /// The samples at which the filter's reach is entirely within the smooth range.
    pub fn all_smooth(&self) -> Range<usize> {
        self.from..(self.to + 1).saturating_sub(2 * self.reach).max(self.from)
    }
}

/// A position between two known samples.
struct Interpolator {
    /// Number of known samples.
    count: usize,
    /// Interpolation weights by the number of known samples before the position, less one.
    weights: [[f64; AROUND]; AROUND],
}

impl Interpolator {
    fn new(part: f64, count: usize) -> Self {
        let places = array::from_fn(|before| before as f64 + part);
        Self {
            count,
            weights: lagrange(places, count.min(AROUND)),
        }
    }

    /// The interpolated values after each known sample from `first` on; zero after the last.
    fn fill(&self, known: &[f64], first: usize, filled: &mut [f64]) {
        let (end, last_start) = (first + filled.len(), self.count.saturating_sub(AROUND));
        // Near the ends of the range there are fewer samples on one side.
        let from = first.max(BEFORE).min(end);
        let to = (last_start + BEFORE + 1).clamp(from, end);
        for k in (first..from).chain(to..end) {
            let start = k.saturating_sub(BEFORE).min(last_start);
            let terms = self.weights[k - start].iter().zip(&known[start..]);
            filled[k - first] = terms.map(|(weight, y)| weight * y).sum();
        }
        widest(Central {
            weights: &self.weights[BEFORE],
            known: &known[from.saturating_sub(BEFORE)..],
            filled: &mut filled[from - first..to - first],
        });
    }
}

/// Values with enough known samples on both sides.
struct Central<'a> {
    weights: &'a [f64; AROUND],
    known: &'a [f64],
    filled: &'a mut [f64],
}

impl Loops for Central<'_> {
    type Result = ();

    #[inline(always)]
    fn run(self) {
        self.filled.fill(0.0);
        for (place, weight) in self.weights.iter().enumerate() {
            for (value, y) in self.filled.iter_mut().zip(&self.known[place..]) {
                *value += weight * y;
            }
        }
    }
}

/// Lagrange weights of values at 0, 1, 2, … for several positions that coincide with none of them.
fn lagrange<const N: usize>(places: [f64; N], count: usize) -> [[f64; AROUND]; N] {
    let others = |i: usize| {
        (0..count)
            .filter(move |&j| j != i)
            .map(move |j| i as f64 - j as f64)
            .product::<f64>()
    };
    let scales: [f64; AROUND] = array::from_fn(|i| if i < count { 1.0 / others(i) } else { 0.0 });
    places.map(|x| {
        let all: f64 = (0..count).map(|j| x - j as f64).product();
        array::from_fn(|i| all * scales[i] / (x - i as f64))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_vibrates_slowly_is_filled_in_from_every_other_sample() {
        let wave = |sample: f64| (0.3 * sample).sin();
        let (length, phases) = (200, 2);
        let value = |i: usize| wave((i % length) as f64 + (i / length) as f64 / phases as f64);
        let full: Vec<f64> = (0..length * phases).map(value).collect();
        let range = SparseRange {
            from: 31,
            to: 199,
            stride: 2,
            reach: 13,
        };
        let known = |i: usize| i % length <= range.from || i < length && (i - range.from).is_multiple_of(range.stride);
        let mut signal: Vec<f64> = (0..full.len())
            .map(|i| if known(i) { full[i] } else { f64::NAN })
            .collect();
        range.fill(&mut signal, (phases, length));
        let needed = |i: usize| i < length || !(57..173).contains(&(i % length));
        for i in (0..full.len()).filter(|&i| needed(i) && i != full.len() - 1) {
            let error = (signal[i] - full[i]).abs();
            // At the end of the record all known samples are on one side.
            let allowed = if i % length > 190 { 3e-3 } else { 1e-4 };
            assert!(error < allowed, "{i}: {error}");
        }
        assert_eq!(range.all_smooth(), 31..174);
    }

    #[test]
    fn a_short_range_of_long_strides_may_end_with_the_record() {
        let (length, phases) = (41, 2);
        let value = |i: usize| 3.0 + (i % length) as f64 + (i / length) as f64 / phases as f64;
        let range = SparseRange {
            from: 32,
            to: 40,
            stride: 8,
            reach: 13,
        };
        let known = |i: usize| i <= range.from || i == range.to;
        let mut signal: Vec<f64> = (0..length * phases)
            .map(|i| if known(i) { value(i) } else { f64::NAN })
            .collect();
        range.fill(&mut signal, (phases, length));
        for i in (0..length).chain(length + range.from..length * phases - 1) {
            assert!((signal[i] - value(i)).abs() < 1e-9, "{i}: {}", signal[i]);
        }
    }
}
