//! The calibration curve of a sensor: a gain that changes smoothly with frequency, and the phase that belongs to it.
//!
//! It is a product of shelving filters `(1 + s/ω_z) / (1 + s/ω_p)`. They have minimum phase, so Bode's relation gives
//! the phase from the gain (Bode, H. W.: Network analysis and feedback amplifier design, 1945, chapter 14).

use std::f64::consts::TAU;

use crate::random::Random;

/// Band in which the curve keeps within its size, Hz.
const BAND: (f64, f64) = (0.5, 30.0);
/// Number of frequencies in the band at which the gain is checked.
const POINTS: i32 = 100;

/// A calibration curve.
pub struct Curve {
    /// For each shelf: middle frequency, rad/s, and the logarithm of the ratio of the gain far above it to the gain far
    /// below it.
    shelves: [(f64, f64); 2],
    gain: f64,
}

impl Curve {
    /// A curve whose gain stays within 1 ± `size` in the band, and reaches both.
    pub fn draw(size: f64, mut random: Random) -> Self {
        let shelves = [(1.0, 5.0), (5.0, 25.0)].map(|(low, high): (f64, f64)| {
            let step = random.uniform(0.5, 1.0) * random.uniform(-1.0, 1.0).signum();
            (TAU * low * (high / low).powf(random.uniform(0.0, 1.0)), 0.01 * step)
        });
        let mut curve = Self { shelves, gain: 1.0 };
        let (low, high) = curve.extremes();
        let scale = 2.0 * size / (high / low).ln();
        curve.shelves.iter_mut().for_each(|shelf| shelf.1 *= scale);
        let (low, high) = curve.extremes();
        curve.gain = 2.0 / (low + high);
        curve
    }

    /// Least and greatest gain in the band.
    fn extremes(&self) -> (f64, f64) {
        let at = |k: i32| BAND.0 * (BAND.1 / BAND.0).powf(f64::from(k) / f64::from(POINTS));
        (0..=POINTS)
            .map(|k| self.magnitude(at(k)))
            .fold((f64::INFINITY, 0.0), |(low, high), gain| {
                (low.min(gain), high.max(gain))
            })
    }

    /// Gain at a frequency, Hz.
    pub fn magnitude(&self, hertz: f64) -> f64 {
        let shelf = |&(middle, step): &(f64, f64)| {
            let (u, root) = (TAU * hertz / middle, (step / 2.0).exp());
            (1.0_f64).hypot(u * root) / (1.0_f64).hypot(u / root)
        };
        self.gain * self.shelves.iter().map(shelf).product::<f64>()
    }

    /// The sensor's output for a signal that starts at rest (bilinear transform).
    pub fn pass(&self, signal: &[f64], rate: f64) -> Vec<f64> {
        let start: Vec<f64> = signal.iter().map(|value| self.gain * value).collect();
        self.shelves.iter().fold(start, |signal, &(middle, step)| {
            let root = (step / 2.0).exp();
            let (zero, pole) = (2.0 * rate * root / middle, 2.0 * rate / (root * middle));
            let (mut input, mut output) = (0.0, 0.0);
            let mut next = |value: f64| {
                output = ((1.0 + zero) * value + (1.0 - zero) * input - (1.0 - pole) * output) / (1.0 + pole);
                input = value;
                output
            };
            signal.into_iter().map(&mut next).collect()
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const RATE: f64 = 1000.0;

    /// Gain and phase of a curve at a frequency, from its response to a sine.
    fn response(curve: &Curve, hertz: f64) -> (f64, f64) {
        let wave: Vec<f64> = (0..20_000).map(|i| (TAU * hertz * f64::from(i) / RATE).sin()).collect();
        let seen = curve.pass(&wave, RATE);
        let part = |wave: fn(f64) -> f64| {
            let own = |i: usize| wave(TAU * hertz * i as f64 / RATE);
            (10_000..20_000).map(|i| seen[i] * own(i)).sum::<f64>() / 5000.0
        };
        let (re, im) = (part(f64::sin), part(f64::cos));
        (re.hypot(im), im.atan2(re))
    }

    /// Bode's relation: the phase is the slope of the logarithmic gain over ln f, weighted by ln coth |u/2| / π.
    fn phase_of_gain(curve: &Curve, hertz: f64) -> f64 {
        let step = 1e-3;
        let slope = |u: f64| {
            let gain = |u: f64| curve.magnitude(hertz * u.exp()).ln();
            (gain(u + step) - gain(u - step)) / (2.0 * step)
        };
        let weight = |u: f64| (1.0 / (u.abs() / 2.0).tanh()).ln();
        let points = (-8000..8000).map(|k| (f64::from(k) + 0.5) * step);
        points.map(|u| slope(u) * weight(u) * step).sum::<f64>() / std::f64::consts::PI
    }

    #[test]
    fn the_phase_belongs_to_the_gain() {
        let curve = Curve::draw(0.02, Random::new(5, "a test"));
        for hertz in [1.0, 4.0, 10.0, 25.0] {
            let (gain, phase) = response(&curve, hertz);
            assert!((gain - curve.magnitude(hertz)).abs() < 2e-4, "{gain} at {hertz} Hz");
            let belongs = phase_of_gain(&curve, hertz);
            assert!(
                (phase - belongs).abs() < 3e-4,
                "{phase} rad at {hertz} Hz, {belongs} belongs"
            );
            assert!(phase.abs() > 1e-3);
        }
        let (low, high) = curve.extremes();
        assert!(
            (low - 0.98).abs() < 1e-3 && (high - 1.02).abs() < 1e-3,
            "{low} to {high}"
        );
    }
}
