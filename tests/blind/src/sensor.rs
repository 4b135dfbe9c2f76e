//! What an accelerometer makes of a motion: gain error, delay, noise and quantisation.

use crate::hidden::Hidden;
use crate::random::Random;

/// One accelerometer.
pub struct Sensor {
    gain: f64,
    delay: f64,
    noise: f64,
    step: f64,
    /// Outside the catalogue: where an amplifier begins to saturate, m/s².
    soft_limit: f64,
}

impl Sensor {
    /// A sensor with a gain error of its own (`systematic` is its standard deviation) and what is hidden in it.
    pub fn new(name: &str, location: &str, systematic: f64, noise: f64, hidden: &[Hidden], seed: u64) -> Self {
        let mut random = Random::new(seed, &format!("gain of {name}"));
        let of = |effect: &str, parameter: &str| {
            let at = hidden.iter().find(|h| h.name == effect && h.at == location);
            at.map(|h| h.get(parameter))
        };
        Self {
            gain: (1.0 + systematic * random.normal()) * of("sensor_gain", "gain").unwrap_or(1.0),
            delay: of("sensor_delay", "delay").unwrap_or(0.0),
            noise,
            step: noise / 6.0,
            soft_limit: of("sensor_saturation", "soft_limit").unwrap_or(f64::INFINITY),
        }
    }

    /// The record of a motion sampled at `rate` Hz.
    pub fn record(&self, motion: &[f64], rate: f64, random: &mut Random) -> Vec<f64> {
        let late = self.delay * rate;
        let at = |i: usize| {
            let place = (i as f64 - late).max(0.0);
            let before = place as usize;
            let after = (before + 1).min(motion.len() - 1);
            motion[before] + (motion[after] - motion[before]) * place.fract()
        };
        let quantise = |value: f64| (value / self.step).round() * self.step;
        (0..motion.len())
            .map(|i| {
                let a = at(i) / (1.0 + (at(i) / self.soft_limit).powi(2)).sqrt();
                quantise(self.gain * a + self.noise * random.normal())
            })
            .collect()
    }
}
