//! Recorded inputs at the integration nodes: every sample and equally spaced nodes between samples.

use std::f64::consts::TAU;

use nalgebra::Complex;

use super::accuracy::Accuracy;
use crate::model::{About, InputKind, Quantity};
use crate::spectrum::{synthesize, transform};

/// Recorded signal of an excitation.
#[derive(Clone, Debug)]
pub struct Recorded<'a> {
    /// Position of the excitation in the model.
    pub excitation: usize,
    /// Order of the time derivative that was measured.
    pub power: i32,
    /// Samples.
    pub samples: &'a [f64],
}

/// Interpolation of recordings between their samples.
#[derive(Clone, Copy, Debug)]
pub struct Between {
    /// Sample rate, Hz.
    pub rate: f64,
    /// True if the signals contain nothing above half the sample rate; false if they are held between samples.
    pub band_limited: bool,
    /// Lowest and highest frequency, Hz; the signal outside is noise.
    pub band: (f64, f64),
    /// True if the signals are periodic.
    pub periodic: bool,
    /// Number of samples.
    pub samples: usize,
    /// Accuracy of the integration.
    pub accuracy: Accuracy,
}

/// Node values for each input of the model, `nodes` of them for each sample; zero for an input that was not recorded.
pub fn rows(about: &About, recorded: &[Recorded], how: &Between, nodes: usize) -> Vec<Vec<f64>> {
    let length = how.samples * nodes;
    let row = |kind| {
        let (place, power) = match kind {
            InputKind::Force(place) => (place, 0),
            InputKind::Motion(place, Quantity::Position) => (place, 0),
            InputKind::Motion(place, Quantity::Velocity) => (place, 1),
            InputKind::Motion(place, Quantity::Acceleration) => (place, 2),
            InputKind::Gravity => return vec![0.0; length],
        };
        match recorded.iter().find(|r| r.excitation == usize::from(place)) {
            None => vec![0.0; length],
            Some(r) if !how.band_limited && r.power == power => held(r.samples, nodes),
            Some(r) => {
                let line = match kind {
                    _ if power < r.power || how.periodic => Line::default(),
                    InputKind::Motion(..) if r.power == 0 => Line::through_next(r.samples, how.rate),
                    _ => Line::through_ends(r.samples, how.rate),
                };
                let mut row = derived(r.samples, power - r.power, &line, how, nodes);
                // The constant of a position moves road and masses alike. A velocity keeps its own, so that it stays
                // the derivative of the position.
                if power == 0 && r.power > 0 && !how.periodic {
                    let first = row[0];
                    row.iter_mut().for_each(|value| *value -= first);
                }
                row
            }
        }
    };
    about.inputs.iter().map(|input| row(input.kind)).collect()
}

fn held(samples: &[f64], nodes: usize) -> Vec<f64> {
    samples
        .iter()
        .flat_map(|&sample| std::iter::repeat_n(sample, nodes))
        .collect()
}

/// Derivative of order `power` by the spectrum; a negative order integrates.
///
/// The straight `line` between the ends is treated separately, since a record with different ends would ring. An
/// integral has no mean.
fn derived(samples: &[f64], power: i32, line: &Line, how: &Between, nodes: usize) -> Vec<f64> {
    let bent: Vec<f64> = samples
        .iter()
        .enumerate()
        .map(|(k, y)| y - line.at(k as f64 / how.rate))
        .collect();
    let mut row = differentiated(&bent, power, how, nodes);
    let step = 1.0 / (how.rate * nodes as f64);
    for (k, value) in row.iter_mut().enumerate() {
        *value += match power {
            0 => line.at(k as f64 * step),
            1 => line.slope,
            _ => 0.0,
        };
    }
    row
}

/// A straight line over time.
#[derive(Default)]
struct Line {
    start: f64,
    slope: f64,
}

impl Line {
    /// Line through the first and the last sample.
    fn through_ends(samples: &[f64], rate: f64) -> Self {
        let (start, end) = (samples[0], samples[samples.len() - 1]);
        Self {
            start,
            slope: (end - start) * rate / (samples.len() - 1) as f64,
        }
    }

    /// Line through the first sample and the one that would follow the last, on the parabola through the last three: a
    /// displacement is smooth, and its derivatives need an end that closes well. A force up to half the sample rate
    /// does not tell that sample.
    fn through_next(samples: &[f64], rate: f64) -> Self {
        let [.., a, b, c] = samples else {
            return Self::through_ends(samples, rate);
        };
        Self {
            start: samples[0],
            slope: (3.0 * (c - b) + a - samples[0]) * rate / samples.len() as f64,
        }
    }

    fn at(&self, t: f64) -> f64 {
        self.start + self.slope * t
    }
}

fn differentiated(samples: &[f64], power: i32, how: &Between, nodes: usize) -> Vec<f64> {
    let spacing = how.rate / samples.len() as f64;
    let of_line = |(k, line): (usize, Complex<f64>)| {
        let f = k as f64 * spacing;
        let factor = match power {
            0 => Complex::ONE,
            _ if k == 0 => Complex::ZERO,
            _ => Complex::new(0.0, TAU * f).powi(power),
        };
        let inside = f >= how.band.0 && f <= how.band.1;
        // The inverse transform gives `nodes` times as many samples from the same lines.
        if inside {
            line * factor * nodes as f64
        } else {
            Complex::ZERO
        }
    };
    let lines: Vec<Complex<f64>> = transform(samples).into_iter().enumerate().map(of_line).collect();
    synthesize(&lines, samples.len() * nodes)
}
