//! Recorded inputs at the ends and middles of the steps of an integration: every sample, and so many nodes between.

use std::f64::consts::TAU;

use nalgebra::Complex;

use crate::model::{About, InputKind, Quantity};
use crate::spectrum::{synthesize, transform};

/// What was recorded of an excitation.
#[derive(Clone, Debug)]
pub struct Recorded<'a> {
    /// The model's excitation.
    pub excitation: usize,
    /// How many times it has been differentiated where it was measured.
    pub power: i32,
    /// Its samples.
    pub samples: &'a [f64],
}

/// How recordings are to be read between their samples.
#[derive(Clone, Copy, Debug)]
pub struct Between {
    /// Hz.
    pub rate: f64,
    /// True where they hold nothing above half the sample rate; false where they are held.
    pub band_limited: bool,
    /// Hz: what lies outside is not motion but noise.
    pub band: (f64, f64),
    /// True where they go on at their end as they began.
    pub periodic: bool,
    /// Number of samples.
    pub samples: usize,
}

/// A row of values for each input of the model, so many for each sample; zero for one that was not recorded.
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
            Some(r) => derived(r.samples, power - r.power, how, nodes),
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

/// The derivative (or integral, below zero) of this order, by the spectrum.
///
/// The straight line between the ends goes its own way: without it a record that does not end where it began would
/// ring. An integral begins at zero, since its constant moves road and masses alike.
fn derived(samples: &[f64], power: i32, how: &Between, nodes: usize) -> Vec<f64> {
    let line = if power < 0 || how.periodic {
        Line::default()
    } else {
        Line::through_ends(samples, how.rate)
    };
    let bent: Vec<f64> = samples
        .iter()
        .enumerate()
        .map(|(k, y)| y - line.at(k as f64 / how.rate))
        .collect();
    let mut row = differentiated(&bent, power, how, nodes);
    let step = 1.0 / (how.rate * nodes as f64);
    let first = if power < 0 && !how.periodic { row[0] } else { 0.0 };
    for (k, value) in row.iter_mut().enumerate() {
        *value += match power {
            0 => line.at(k as f64 * step),
            1 => line.slope,
            _ => -first,
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
    /// Through the first sample and the one that would follow the last, if the record went on as it began.
    fn through_ends(samples: &[f64], rate: f64) -> Self {
        let (start, end) = (samples[0], samples[samples.len() - 1]);
        Self {
            start,
            slope: (end - start) * rate / (samples.len() - 1) as f64,
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
        // More samples share the same lines.
        if inside {
            line * factor * nodes as f64
        } else {
            Complex::ZERO
        }
    };
    let lines: Vec<Complex<f64>> = transform(samples).into_iter().enumerate().map(of_line).collect();
    synthesize(&lines, samples.len() * nodes)
}
