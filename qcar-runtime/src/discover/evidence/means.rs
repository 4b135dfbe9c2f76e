//! A record as weighted means around given instants, so that few values say all that matters of it.
//!
//! The weight is a Hann pulse, `h(t) = (1 + cos(π t/T)) / 2T` for `|t| < T`: a low-pass that has lost half its gain at
//! `1/2T` and all of it at `1/T`, and whose shifted copies sum to one, so that a constant stays what it is. Means that
//! lie `T` apart have a sixth of their noise in common. They can be asked for at any instant, which shifts a record by
//! any part of a sample.

use std::f64::consts::PI;

/// Samples on each side of a mean, below which its pulse no longer tells a signal from its alias: that of 50 Hz is then
/// let through by 0.1 %.
const FEWEST: usize = 4;

/// Means of records of one sample rate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Means {
    /// Hz.
    rate: f64,
    /// Samples on each side of a mean.
    reach: usize,
}

impl Means {
    /// Means over `half` s to each side, in whole samples and at least `FEWEST` of them.
    pub fn new(rate: f64, half: f64) -> Self {
        Self {
            rate,
            reach: ((half * rate).round() as usize).max(FEWEST),
        }
    }

    /// The same means of a record that has no more samples than they need.
    pub fn sparse(&self) -> Self {
        Self {
            rate: FEWEST as f64 / self.half(),
            reach: FEWEST,
        }
    }

    /// `T`, s.
    pub fn half(&self) -> f64 {
        self.reach as f64 / self.rate
    }

    /// Hz.
    pub fn rate(&self) -> f64 {
        self.rate
    }

    /// The means around every sample that has all its neighbours.
    pub fn inside(&self, samples: &[f64]) -> impl Iterator<Item = f64> {
        (self.reach..samples.len().saturating_sub(self.reach)).map(|k| self.at(samples, k as f64 / self.rate).0)
    }

    /// The mean around `t` (s after the first sample), and its derivative by `t`. What lies beyond the ends is zero.
    pub fn at(&self, samples: &[f64], t: f64) -> (f64, f64) {
        let (place, reach) = (t * self.rate, self.reach as f64);
        let first = (place - reach).ceil().max(0.0) as usize;
        let last = ((place + reach).floor() + 1.0).clamp(0.0, samples.len() as f64) as usize;
        let (mut mean, mut slope) = (0.0, 0.0);
        for (k, sample) in samples.iter().enumerate().take(last).skip(first) {
            let angle = PI * (place - k as f64) / reach;
            mean += sample * (1.0 + angle.cos());
            slope -= sample * angle.sin();
        }
        (mean / (2.0 * reach), slope * PI * self.rate / (2.0 * reach * reach))
    }
}
