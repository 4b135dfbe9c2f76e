//! Weighted means of a record at given instants, which reduce it to few values.
//!
//! The weight is a Hann pulse, `h(t) = (1 + cos(π t/T)) / 2T` for `|t| < T`. It is a low-pass with half its gain at
//! `1/2T` and none at `1/T`. Its shifted copies sum to one, so a constant is preserved. The noise of means at a
//! distance `T` has a correlation of one sixth. Means can be taken at any instant, which shifts a record by any
//! fraction of a sample.

use std::f64::consts::PI;

use nalgebra::Complex;

use crate::vectors::{Loops, dot, widest};

/// Smallest number of samples on each side of a mean. With fewer, the pulse does not suppress aliases; with this number
/// it passes 0.1 % of the alias of 50 Hz.
const FEWEST: usize = 4;

/// Means of records with one sample rate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Means {
    /// Sample rate, Hz.
    rate: f64,
    /// Number of samples on each side of a mean.
    reach: usize,
    /// Rotation of the pulse angle from one sample to the next.
    turn: Complex<f64>,
}

impl Means {
    /// Means over `half` s to each side, rounded to whole samples, at least `FEWEST`. `rate` is in Hz.
    pub fn new(rate: f64, half: f64) -> Self {
        Self::reaching(rate, ((half * rate).round() as usize).max(FEWEST))
    }

    /// Means of the same width at the lowest sample rate that they allow.
    pub fn sparse(&self) -> Self {
        Self::reaching(FEWEST as f64 / self.half(), FEWEST)
    }

    fn reaching(rate: f64, reach: usize) -> Self {
        Self {
            rate,
            reach,
            turn: Complex::cis(-PI / reach as f64),
        }
    }

    /// `T`, s.
    pub fn half(&self) -> f64 {
        self.reach as f64 / self.rate
    }

    /// Sample rate, Hz.
    pub fn rate(&self) -> f64 {
        self.rate
    }

    /// Means at every sample whose pulse lies inside the record.
    pub fn inside(&self, samples: &[f64]) -> impl Iterator<Item = f64> {
        (self.reach..samples.len().saturating_sub(self.reach)).map(|k| self.at(samples, k as f64 / self.rate).0)
    }

    /// Mean at `t` (s after the first sample) and its derivative by `t`. Samples beyond the ends count as zero.
    pub fn at(&self, samples: &[f64], t: f64) -> (f64, f64) {
        let reach = self.reach as f64;
        let (first, last, mut angle) = self.pulse(t, samples.len());
        let (mut mean, mut slope) = (0.0, 0.0);
        for sample in samples.iter().take(last).skip(first) {
            mean += sample * (1.0 + angle.re);
            slope -= sample * angle.im;
            angle *= self.turn;
        }
        (mean / (2.0 * reach), slope * PI * self.rate / (2.0 * reach * reach))
    }

    /// The first sample under the pulse at `t`, the one after the last, and the angle of the pulse at the first.
    fn pulse(&self, t: f64, samples: usize) -> (usize, usize, Complex<f64>) {
        let (place, reach) = (t * self.rate, self.reach as f64);
        let first = (place - reach).ceil().max(0.0) as usize;
        let last = ((place + reach).floor() + 1.0).clamp(0.0, samples as f64) as usize;
        (first, last, Complex::cis(PI * (place - first as f64) / reach))
    }

    /// The pulses at some instants, for many records of `samples` samples.
    pub fn pulses(&self, instants: impl Iterator<Item = f64>, samples: usize) -> Pulses {
        let mut pulses = Pulses {
            ends: Vec::with_capacity(instants.size_hint().0),
            weights: Vec::new(),
        };
        for t in instants {
            let (first, last, mut angle) = self.pulse(t, samples);
            pulses.ends.push((first, last));
            for _ in first..last {
                pulses.weights.push((1.0 + angle.re) / (2.0 * self.reach as f64));
                angle *= self.turn;
            }
        }
        pulses
    }
}

/// Pulses at several instants.
pub struct Pulses {
    /// For each, the first sample under it, and the one after the last.
    ends: Vec<(usize, usize)>,
    /// Their weights, one pulse after the other.
    weights: Vec<f64>,
}

impl Pulses {
    /// The means of a record.
    pub fn means(&self, samples: &[f64]) -> Vec<f64> {
        let mut means = vec![0.0; self.ends.len()];
        widest(Weighting {
            pulses: self,
            samples,
            means: &mut means,
        });
        means
    }
}

struct Weighting<'a> {
    pulses: &'a Pulses,
    samples: &'a [f64],
    means: &'a mut [f64],
}

impl Loops for Weighting<'_> {
    type Result = ();

    #[inline(always)]
    fn run(self) {
        let mut weights = &self.pulses.weights[..];
        for (mean, &(first, last)) in self.means.iter_mut().zip(&self.pulses.ends) {
            let samples = &self.samples[first..last];
            *mean = dot(samples, weights.split_off(..samples.len()).unwrap_or_default());
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_mean_is_the_sum_of_all_samples_by_its_pulse() {
        let samples: Vec<f64> = (0..900).map(|k| ((7 * k) % 31) as f64 - 11.0).collect();
        for (rate, half) in [(500.0, 0.008), (2000.0, 0.01), (10_000.0, 0.02)] {
            let means = Means::new(rate, half);
            let pulse = |t: f64| (t.abs() < half).then(|| (1.0 + (PI * t / half).cos()) / (2.0 * half * rate));
            let slope = |t: f64| (t.abs() < half).then(|| -(PI * t / half).sin() * PI / (2.0 * half * half * rate));
            let sum = |weight: &dyn Fn(f64) -> Option<f64>, t: f64| -> f64 {
                let all = samples.iter().zip(0..);
                all.map(|(y, k)| y * weight(t - f64::from(k) / rate).unwrap_or(0.0))
                    .sum()
            };
            // Pulses inside the record and across either end of it.
            let instants = [0.3 * half, 3.37 * half, samples.len() as f64 / rate - 0.21 * half];
            let by_pulses = means.pulses(instants.into_iter(), samples.len()).means(&samples);
            for (t, by_pulse) in instants.into_iter().zip(by_pulses) {
                let (found, expected) = (means.at(&samples, t), (sum(&pulse, t), sum(&slope, t)));
                assert!((found.0 - expected.0).abs() < 1e-11, "{found:?}, not {expected:?}");
                assert!((by_pulse - expected.0).abs() < 1e-11, "{by_pulse}, not {expected:?}");
                assert!(
                    (found.1 - expected.1).abs() < 1e-11 / half,
                    "{found:?}, not {expected:?}"
                );
            }
        }
    }
}
