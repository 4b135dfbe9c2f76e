//! The signal of an accelerometer: gain error, delay, noise, quantisation and the flaws of hardware.

use std::f64::consts::TAU;

use crate::calibration::Curve;
use crate::hardware::Hardware;
use crate::hidden::Hidden;
use crate::random::Random;

/// Frequency of the mains, Hz.
const MAINS: f64 = 50.0;
/// Time to which the drift of [`Hardware::drift`] refers, s.
const WANDERING: f64 = 30.0;

/// One accelerometer.
pub struct Sensor {
    name: String,
    gain: f64,
    delay: f64,
    noise: f64,
    step: f64,
    /// Outside the catalogue: acceleration at which the amplifier begins to saturate, m/s².
    soft_limit: f64,
    curve: Option<Curve>,
    /// Drift of the zero in [`WANDERING`], m/s².
    drift: f64,
    /// Amplitude of the hum, m/s².
    hum: f64,
}

impl Sensor {
    /// A sensor with a random gain error (`systematic` is its standard deviation) and its hidden effects.
    pub fn new(
        name: &str,
        location: &str,
        (systematic, noise): (f64, f64),
        hidden: &[Hidden],
        hardware: &Hardware,
        seed: u64,
    ) -> Self {
        let mut random = Random::new(seed, &format!("gain of {name}"));
        let of = |effect: &str, parameter: &str| {
            let at = hidden.iter().find(|h| h.name == effect && h.at == location);
            at.map(|h| h.get(parameter))
        };
        Self {
            name: name.to_owned(),
            gain: (1.0 + systematic * random.normal()) * of("sensor_gain", "gain").unwrap_or(1.0),
            delay: of("sensor_delay", "delay").unwrap_or(0.0),
            noise,
            step: noise / 6.0,
            soft_limit: of("sensor_saturation", "soft_limit").unwrap_or(f64::INFINITY),
            curve: hardware
                .calibration(name)
                .map(|(size, random)| Curve::draw(size, random)),
            drift: noise * hardware.drift(name),
            hum: noise * hardware.hum(name),
        }
    }

    /// The record of a motion that is sampled at `rate` Hz. `seed` and `run` seed its noise.
    pub fn record(&self, motion: &[f64], rate: f64, seed: u64, run: u32) -> Vec<f64> {
        let stream = |what: &str| Random::new(seed, &format!("{what} {} in {run}", self.name));
        let mut random = stream("noise of");
        let late = self.delay * rate;
        let at = |i: usize| {
            let place = (i as f64 - late).max(0.0);
            let before = place as usize;
            let after = (before + 1).min(motion.len() - 1);
            motion[before] + (motion[after] - motion[before]) * place.fract()
        };
        let seen: Vec<f64> = (0..motion.len())
            .map(|i| at(i) / (1.0 + (at(i) / self.soft_limit).powi(2)).sqrt())
            .collect();
        let seen = match &self.curve {
            Some(curve) => curve.pass(&seen, rate),
            None => seen,
        };
        let mut beside = self.beside(rate, stream("zero and hum of"));
        let quantise = |value: f64| (value / self.step).round() * self.step;
        (0..motion.len())
            .map(|i| quantise(self.gain * seen[i] + beside(i) + self.noise * random.normal()))
            .collect()
    }

    /// Drift of the zero (a random walk) and hum (with a third harmonic of a third of its amplitude), m/s², for each
    /// sample.
    fn beside(&self, rate: f64, mut random: Random) -> impl FnMut(usize) -> f64 {
        let (drift, hum) = (self.drift, self.hum);
        let phases = [(); 2].map(|()| random.uniform(0.0, TAU));
        let mut zero = drift * random.normal();
        move |i| {
            let angle = TAU * MAINS * i as f64 / rate;
            zero += drift * random.normal() / (WANDERING * rate).sqrt();
            zero + hum * ((angle + phases[0]).sin() + (3.0 * angle + phases[1]).sin() / 3.0)
        }
    }
}
