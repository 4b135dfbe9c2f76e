//! Frequency band of a record: a linear-phase filter that is applied to measurement and prediction alike.
//!
//! Its weights are an ideal band-pass with a Hamming window (Oppenheim and Schafer, Discrete-time signal processing,
//! 3rd edition, section 7.5). They are centred, so there is no delay. Half the filter length at each end of a record is
//! not compared because the filter reaches beyond the record there. A periodic record has no ends.

use std::f64::consts::{PI, TAU};

use crate::spectrum::{synthesize, transform};

/// Frequency band of a record.
#[derive(Clone, Debug, PartialEq)]
pub struct Band {
    /// Filter weights; their number is odd.
    weights: Vec<f64>,
    /// Lowest and highest frequency, Hz.
    range: (f64, f64),
}

/// Length of a Hamming window in samples for a transition as wide as the sample rate.
const HAMMING: f64 = 3.3;

impl Band {
    /// The band from `low` to `high` (Hz), where the gain is one half. The transition is as wide as `low`, but at most
    /// the band, or half of `high` if `low` is zero. `rate` is in Hz.
    pub fn new((low, high): (f64, f64), rate: f64) -> Self {
        let slope = if low > 0.0 { low.min(high - low) } else { high / 2.0 };
        let half = (HAMMING * rate / slope / 2.0).ceil() as usize;
        let weight = |k: usize| {
            let t = (k as f64 - half as f64) / rate;
            let window = 0.54 - 0.46 * (TAU * (k as f64 + 1.0) / (2 * half + 2) as f64).cos();
            window * (ideal(high, t) - ideal(low, t)) / rate
        };
        Band {
            weights: (0..=2 * half).map(weight).collect(),
            range: (low, high),
        }
    }

    /// Number of samples to either side that the filter reaches.
    pub fn half(&self) -> usize {
        self.weights.len() / 2
    }

    /// True if a constant passes.
    pub fn passes_mean(&self) -> bool {
        self.range.0 == 0.0
    }

    /// Standard deviation of filtered white noise, relative to that of its input.
    pub fn of_noise(&self) -> f64 {
        self.weights.iter().map(|w| w * w).sum::<f64>().sqrt()
    }

    /// Number of samples between independent values.
    pub fn stride(&self, rate: f64) -> usize {
        ((rate / (2.0 * (self.range.1 - self.range.0))) as usize).max(1)
    }

    /// Filters a signal. A `periodic` signal repeats beyond its ends; any other signal is zero there.
    pub fn of(&self, samples: &[f64], periodic: bool) -> Vec<f64> {
        let (count, half) = (samples.len(), self.half());
        let length = if periodic { count } else { count + 2 * half };
        let mut signal = samples.to_vec();
        signal.resize(length, 0.0);
        let mut weights = vec![0.0; length];
        for (k, weight) in self.weights.iter().enumerate() {
            let place = (k as i64 - half as i64).rem_euclid(length as i64);
            weights[place as usize] += weight;
        }
        let lines: Vec<_> = transform(&signal)
            .iter()
            .zip(transform(&weights))
            .map(|(a, b)| a * b)
            .collect();
        let mut passed = synthesize(&lines, length);
        passed.truncate(count);
        passed
    }
}

/// Impulse response of the ideal low-pass with cut-off `f` (Hz) at time `t` (s), 1/s.
fn ideal(f: f64, t: f64) -> f64 {
    let angle = TAU * f * t;
    if angle == 0.0 { 2.0 * f } else { angle.sin() / (PI * t) }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A tone in the band passes unchanged and without delay; tones outside the band and a drift do not pass.
    #[test]
    fn a_band_passes_its_own_frequencies_alone() {
        let rate = 200.0;
        let record = |signal: &dyn Fn(f64) -> f64| -> Vec<f64> { (0..4000).map(|k| signal(k as f64 / rate)).collect() };
        let tone = |f: f64| move |t: f64| (TAU * f * t + 0.3).sin();
        let band = Band::new((2.0, 20.0), rate);
        let whole = band.half()..4000 - band.half();
        let most = |a: &[f64], b: &[f64]| {
            let difference = a[whole.clone()]
                .iter()
                .zip(&b[whole.clone()])
                .map(|(a, b)| (a - b).abs());
            difference.fold(0.0, f64::max)
        };
        let inside = record(&tone(7.0));
        assert!(most(&band.of(&inside, false), &inside) < 0.005);
        let outside = record(&|t| tone(0.5)(t) + tone(30.0)(t) + 5.0 + 0.3 * t);
        assert!(most(&band.of(&outside, false), &vec![0.0; 4000]) < 0.03);
        // The record holds whole periods, so it has no ends.
        let tone = record(&tone(2.0 * 5.0));
        let all = band.of(&tone, true);
        assert!(all.iter().zip(&tone).all(|(a, b)| (a - b).abs() < 0.005));
    }
}
