//! Recorded inputs on the nodes of a fixed-step integration: every sample, and so many nodes between.

use std::f64::consts::TAU;

use nalgebra::Complex;
use realfft::RealFftPlanner;

use crate::model::{About, InputKind, Quantity};
use crate::spectrum::transform;

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
    /// Nodes for each sample.
    pub nodes: usize,
}

/// A row of node values for each input of the model; zero for one that was not recorded.
pub fn rows(about: &About, recorded: &[Recorded], how: &Between) -> Vec<Vec<f64>> {
    let length = recorded.first().map_or(0, |r| r.samples.len() * how.nodes);
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
            Some(r) if !how.band_limited && r.power == power => held(r.samples, how.nodes),
            Some(r) => derived(r.samples, power - r.power, how),
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
fn derived(samples: &[f64], power: i32, how: &Between) -> Vec<f64> {
    let line = if power < 0 {
        Line::default()
    } else {
        Line::through_ends(samples, how.rate)
    };
    let bent: Vec<f64> = samples
        .iter()
        .enumerate()
        .map(|(k, y)| y - line.at(k as f64 / how.rate))
        .collect();
    let mut row = differentiated(&bent, power, how);
    let step = 1.0 / (how.rate * how.nodes as f64);
    let first = if power < 0 { row[0] } else { 0.0 };
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

fn differentiated(samples: &[f64], power: i32, how: &Between) -> Vec<f64> {
    let line = how.rate / samples.len() as f64;
    let count = samples.len() * how.nodes;
    let mut fine = vec![Complex::ZERO; count / 2 + 1];
    for (k, value) in transform(samples).into_iter().enumerate() {
        let f = k as f64 * line;
        let rate = Complex::new(0.0, TAU * f);
        if f >= how.band.0 && f <= how.band.1 && (k > 0 || power == 0) {
            fine[k] = value / samples.len() as f64 * if power == 0 { Complex::ONE } else { rate.powi(power) };
        }
    }
    let plan = RealFftPlanner::new().plan_fft_inverse(count);
    let mut row = plan.make_output_vec();
    fine[0].im = 0.0;
    if count.is_multiple_of(2) {
        fine[count / 2].im = 0.0;
    }
    plan.process(&mut fine, &mut row)
        .expect("the plan was made for these lengths");
    row
}
