//! Steps of the classical Runge-Kutta method, halved where a law is too stiff or too sharp for them.
//!
//! The slope at the end of a step, which the next one begins with, makes a method of third order of the same stages: the
//! difference of both is the error that is held down (Hairer, Norsett, Wanner: Solving ordinary differential equations I,
//! section II.4). How often each step was halved is kept: where parameters move by a difference, the steps stay.

use super::sets::Sets;
use crate::solver::rk4;

/// Error of a step that is allowed, over the largest value that a state had.
const TOLERANCE: f64 = 1e-3;
/// How often a step is halved at most.
const MOST: u8 = 4;
/// An error that leaves room for steps of twice the length: theirs is some 16 times as large.
const ROOM: f64 = 1.0 / 32.0;

/// Goes from step to step.
pub struct Stepper<'a, S> {
    /// The model.
    pub sets: &'a mut S,
    /// Of a whole step, s.
    length: f64,
    k: [Vec<f64>; 5],
    x: Vec<f64>,
    /// Inputs at the ends and in the middle of a part of a step.
    inputs: [Vec<f64>; 3],
    /// Inputs at the end of the step before.
    last: Vec<f64>,
    /// True where the last of the slopes is that at the present state, with these inputs.
    knows_slope: bool,
    /// State and slope at the start of a step, which may have to be taken again.
    start: [Vec<f64>; 2],
    largest: Vec<f64>,
    halvings: u8,
}

impl<'a, S: Sets> Stepper<'a, S> {
    /// Of so many states, those of all sets, and inputs, in steps of a length in s.
    pub fn new(sets: &'a mut S, (states, inputs): (usize, usize), length: f64) -> Self {
        Self {
            sets,
            length,
            k: std::array::from_fn(|_| vec![0.0; states]),
            x: vec![0.0; states],
            inputs: std::array::from_fn(|_| vec![0.0; inputs]),
            last: vec![0.0; inputs],
            knows_slope: false,
            start: std::array::from_fn(|_| vec![0.0; states]),
            largest: vec![0.0; states],
            halvings: 0,
        }
    }

    /// The state was changed from outside.
    pub fn forget(&mut self) {
        self.knows_slope = false;
    }

    /// A step, with the inputs at its start, middle and end, halved as often as it needs: how often.
    pub fn find(&mut self, inputs: [&[f64]; 3], x: &mut [f64]) -> u8 {
        let knew_slope = self.knows_slope && self.last == inputs[0];
        self.start[0].copy_from_slice(x);
        self.start[1].copy_from_slice(&self.k[4]);
        loop {
            let halvings = self.halvings;
            let error = self.parts(inputs, halvings, x, Self::error);
            if error <= 1.0 || halvings == MOST {
                let sizes = self.largest.iter_mut().zip(&*x);
                sizes.for_each(|(largest, x)| *largest = largest.max(x.abs()));
                if error < ROOM {
                    self.halvings = halvings.saturating_sub(1);
                }
                return halvings;
            }
            self.halvings += 1;
            x.copy_from_slice(&self.start[0]);
            self.k[4].copy_from_slice(&self.start[1]);
            self.knows_slope = knew_slope;
            self.last.copy_from_slice(inputs[0]);
        }
    }

    /// A step that is halved so many times.
    pub fn follow(&mut self, inputs: [&[f64]; 3], halvings: u8, x: &mut [f64]) {
        self.parts(inputs, halvings, x, |_, _, _| 0.0);
    }

    /// All parts of a step. Returns the largest value of `error`, which is called after each part with its length.
    fn parts(&mut self, inputs: [&[f64]; 3], halvings: u8, x: &mut [f64], error: fn(&Self, f64, &[f64]) -> f64) -> f64 {
        // What is held jumps from one sample to the next.
        self.knows_slope &= self.last == inputs[0];
        let error = if halvings == 0 {
            self.part(inputs, self.length, x);
            error(self, self.length, x)
        } else {
            let parts = 1_u32 << halvings;
            let length = self.length / f64::from(parts);
            let errors = (0..parts).map(|part| {
                self.short_part(inputs, (part, parts), x);
                error(self, length, x)
            });
            // What is no number is no small error either.
            errors.fold(0.0, |a, b| if b.is_nan() { f64::INFINITY } else { a.max(b) })
        };
        self.last.copy_from_slice(inputs[2]);
        if error.is_nan() { f64::INFINITY } else { error }
    }

    /// One of the parts of a step. Between the start, the middle and the end of it inputs lie on a parabola.
    fn short_part(&mut self, [a, b, c]: [&[f64]; 3], (part, parts): (u32, u32), x: &mut [f64]) {
        let mut inputs = std::mem::take(&mut self.inputs);
        for (half, into) in inputs.iter_mut().enumerate() {
            let t = (f64::from(2 * part) + half as f64) / f64::from(2 * parts);
            let weights = [(2.0 * t - 1.0) * (t - 1.0), 4.0 * t * (1.0 - t), t * (2.0 * t - 1.0)];
            for (k, value) in into.iter_mut().enumerate() {
                *value = weights[0] * a[k] + weights[1] * b[k] + weights[2] * c[k];
            }
        }
        self.part([&inputs[0], &inputs[1], &inputs[2]], self.length / f64::from(parts), x);
        self.inputs = inputs;
    }

    /// A part of a step.
    fn part(&mut self, inputs: [&[f64]; 3], h: f64, x: &mut [f64]) {
        let Self { sets, k, .. } = self;
        if self.knows_slope {
            k.swap(0, 4);
        } else {
            sets.derivative(x, inputs[0], &mut k[0]);
        }
        let derivative = |part: f64, x: &[f64], k: &mut [f64]| {
            sets.derivative(x, inputs[(2.0 * part) as usize], k);
        };
        rk4::step(derivative, h, x, k, &mut self.x);
        x.copy_from_slice(&self.x);
        self.knows_slope = true;
    }

    /// The error of the last part, of length `h` to `x`, over what is allowed.
    fn error(&self, h: f64, x: &[f64]) -> f64 {
        let error = |i: usize| {
            let size = self.largest[i].max(x[i].abs());
            let error = (h / 6.0 * (self.k[3][i] - self.k[4][i])).abs();
            if error == 0.0 { 0.0 } else { error / (TOLERANCE * size) }
        };
        (0..x.len())
            .map(error)
            .fold(0.0, |a, b| if b.is_nan() { b } else { a.max(b) })
    }
}
