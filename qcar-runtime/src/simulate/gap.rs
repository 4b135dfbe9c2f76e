//! Stretches of a signal of which every so many samples are known, filled in by polynomials.

use std::ops::Range;

use crate::solver::PAST;
use crate::vectors::{Loops, widest};

/// Of the samples from one to another those a stride apart are known, and of what is between nothing.
pub(super) struct Gap {
    pub from: usize,
    pub to: usize,
    pub stride: usize,
    /// The filter sees so many samples on each side.
    pub reach: usize,
}

/// So many known samples make a polynomial, half of them before the point where there are as many. What vibrates with a
/// period of ten strides is exact to 3e-5.
const AROUND: usize = 8;
const BEFORE: usize = AROUND / 2 - 1;

impl Gap {
    /// Fills in the points of a signal that stands in `phases` of some length; the first phase has the samples.
    ///
    /// The signal is smooth in the gap, and for so many strides before it as the method that left the gap has looked back.
    /// What lies further away is left out of account.
    pub fn fill(&self, signal: &mut [f64], (phases, length): (usize, usize)) {
        let before = (PAST - 1).min(self.from / self.stride);
        let known = signal[self.from - before * self.stride..=self.to].iter();
        let known: Vec<f64> = known.step_by(self.stride).copied().collect();
        let mut filled = vec![0.0; (self.to - self.from) / self.stride];
        for point in 1..self.stride * phases {
            let part = point as f64 / (self.stride * phases) as f64;
            let wanted = if point % phases == 0 {
                [self.from..self.to, self.to..self.to]
            } else {
                self.ends()
            };
            for range in wanted {
                let filled = &mut filled[..range.len() / self.stride];
                widest(Between {
                    known: &known,
                    first: before + (range.start - self.from) / self.stride,
                    part,
                    filled,
                });
                let place = point % phases * length + range.start + point / phases;
                let places = signal[place..].iter_mut().step_by(self.stride);
                places.zip(filled).for_each(|(place, value)| *place = *value);
            }
        }
    }

    /// Both ends, in which the filter has to do with what is outside; one for a short gap.
    fn ends(&self) -> [Range<usize>; 2] {
        let reach = (2 * self.reach).next_multiple_of(self.stride);
        if 2 * reach < self.to - self.from {
            [self.from..self.from + reach, self.to - reach..self.to]
        } else {
            [self.from..self.to, self.to..self.to]
        }
    }

    /// Where the filter, which begins to see a sample so many before it, sees nothing but what is smooth.
    pub fn all_smooth(&self) -> Range<usize> {
        self.from..(self.to + 1).saturating_sub(2 * self.reach).max(self.from)
    }
}

/// A point behind each of several known samples.
struct Between<'a> {
    known: &'a [f64],
    /// The first of these samples.
    first: usize,
    /// How far behind, in strides.
    part: f64,
    filled: &'a mut [f64],
}

impl Loops for Between<'_> {
    type Result = ();

    #[inline(always)]
    fn run(self) {
        let value = |weights: &[f64; AROUND], known: &[f64]| weights.iter().zip(known).map(|(w, y)| w * y).sum();
        let around = AROUND.min(self.known.len());
        let weights = lagrange(BEFORE as f64 + self.part, around);
        // Near the ends of the gap there are fewer samples on one side.
        let central = BEFORE..self.known.len() - around / 2;
        for (k, filled) in (self.first..).zip(self.filled.iter_mut()) {
            if central.contains(&k) && around == AROUND {
                *filled = value(&weights, &self.known[k - BEFORE..][..AROUND]);
            } else {
                let start = k.saturating_sub(BEFORE).min(self.known.len() - around);
                *filled = value(&lagrange((k - start) as f64 + self.part, around), &self.known[start..]);
            }
        }
    }
}

/// The weights at `x` of so many values at 0, 1, 2, ….
fn lagrange(x: f64, count: usize) -> [f64; AROUND] {
    let mut weights = [0.0; AROUND];
    for (i, weight) in weights[..count].iter_mut().enumerate() {
        let others = (0..count).filter(|&j| j != i);
        *weight = others.map(|j| (x - j as f64) / (i as f64 - j as f64)).product();
    }
    weights
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
        let gap = Gap {
            from: 31,
            to: 199,
            stride: 2,
            reach: 13,
        };
        let known = |i: usize| i % length <= gap.from || i < length && (i - gap.from).is_multiple_of(gap.stride);
        let mut signal: Vec<f64> = (0..full.len())
            .map(|i| if known(i) { full[i] } else { f64::NAN })
            .collect();
        gap.fill(&mut signal, (phases, length));
        let needed = |i: usize| i < length || !(57..173).contains(&(i % length));
        for i in (0..full.len()).filter(|&i| needed(i) && i != full.len() - 1) {
            let error = (signal[i] - full[i]).abs();
            // At the end of the record all known samples are on one side.
            let allowed = if i % length > 190 { 3e-3 } else { 1e-4 };
            assert!(error < allowed, "{i}: {error}");
        }
        assert_eq!(gap.all_smooth(), 31..174);
    }
}
