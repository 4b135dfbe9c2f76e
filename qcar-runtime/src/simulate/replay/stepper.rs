//! Steps of the classical Runge-Kutta method, halved where a law is too sharp. Where a law is too stiff, the exponential
//! method of [`decay`](super::decay) takes its place.
//!
//! Together with the derivative at the end of a step, which the next step needs anyway, the same stages form a
//! third-order method. The difference of both methods is the controlled error (Hairer, Norsett, Wanner: Solving
//! ordinary differential equations I, section II.4). How each step was taken is stored: derivatives are those of the
//! same steps.
//!
//! It cannot see a law that jumps between two stages of a step, since all stages are then on one side of the jump or the
//! other. In the fourth difference of the derivatives at the start, middle and end of two parts of a step the jump is
//! fully visible, while for a smooth motion it is as small as the difference of both methods.

use super::accuracy::Accuracy;
use super::decay::Decay;
use crate::model::Model;
use crate::solver::rk4;

/// Most halvings of a step that would otherwise diverge, as with a stiff friction at high speed. A choice: each further
/// one admits twice the stiffness, for up to twice the work in fits that try it.
const MOST_OF_DIVERGING: u8 = 6;
/// Relative error below which the step length doubles: the error grows about 16 times.
const ROOM: f64 = 1.0 / 32.0;

/// How a step was taken.
#[derive(Clone, Copy, Debug, Default)]
pub struct Taken {
    /// How often it was halved.
    pub halvings: u8,
    /// True if states may have decayed within a part of it: their decay was separated wherever they did.
    pub decays: bool,
}

/// Integrates step by step.
pub struct Stepper<'a> {
    model: &'a dyn Model,
    constants: Vec<f64>,
    decay: Decay<'a>,
    /// True if states may decay within a step, and if one did in a part of the last one.
    may_decay: bool,
    decays: bool,
    accuracy: Accuracy,
    /// Length of a whole step, s.
    length: f64,
    k: [Vec<f64>; 5],
    /// Derivatives at the start and in the middle of the part before the last.
    before: [Vec<f64>; 2],
    x: Vec<f64>,
    /// Inputs at the start, the middle and the end of a part of a step.
    inputs: [Vec<f64>; 3],
    /// Inputs at the end of the previous step.
    last: Vec<f64>,
    /// True if the last derivative is that of the present state with the inputs `last`.
    knows_slope: bool,
    /// State and derivative at the start of a step, in case it must be repeated.
    start: [Vec<f64>; 2],
    largest: Vec<f64>,
    halvings: u8,
}

impl<'a> Stepper<'a> {
    /// A stepper for a model with these parameter values, with steps of `length` (s).
    pub fn new(model: &'a dyn Model, p: &'a [f64], length: f64, accuracy: Accuracy) -> Self {
        let about = model.about();
        let (states, inputs) = (about.states.len(), about.inputs.len());
        let mut constants = vec![0.0; about.constants];
        model.prepare(p, &mut constants);
        Self {
            model,
            constants,
            decay: Decay::new(model, p),
            may_decay: false,
            decays: false,
            accuracy,
            length,
            k: std::array::from_fn(|_| vec![0.0; states]),
            before: std::array::from_fn(|_| vec![0.0; states]),
            x: vec![0.0; states],
            inputs: std::array::from_fn(|_| vec![0.0; inputs]),
            last: vec![0.0; inputs],
            knows_slope: false,
            start: std::array::from_fn(|_| vec![0.0; states]),
            largest: vec![0.0; states],
            halvings: accuracy.fewest(),
        }
    }

    /// The outputs of the model.
    pub fn outputs(&self, x: &[f64], u: &[f64], y: &mut [f64]) {
        self.model.outputs(&self.constants, x, u, y);
    }

    /// Discards the stored derivative after the state was changed from outside.
    pub fn forget(&mut self) {
        self.knows_slope = false;
    }

    /// Takes a step with the inputs at its start, middle and end. Separates the decay of states if the error is large
    /// and they decay within a part of the step; then halves it as often as needed. A motion that has diverged all the
    /// same is NaN from then on.
    pub fn find(&mut self, inputs: [&[f64]; 3], x: &mut [f64]) -> Taken {
        if x.iter().any(|x| !x.is_finite()) {
            x.fill(f64::NAN);
            return Taken::default();
        }
        let knew_slope = self.knows_slope && self.last == inputs[0];
        self.start[0].copy_from_slice(x);
        self.start[1].copy_from_slice(&self.k[4]);
        loop {
            let halvings = self.halvings;
            let error = self.parts(inputs, halvings, x);
            // A step that has diverged has an error as large as the largest value of a state.
            let is_bounded = error * self.accuracy.tolerance < 1.0;
            let most = self.accuracy.halvings;
            let is_halved_enough = halvings >= most && is_bounded || halvings == MOST_OF_DIVERGING;
            if error <= 1.0 || is_halved_enough {
                let sizes = self.largest.iter_mut().zip(&*x);
                sizes.for_each(|(largest, x)| *largest = largest.max(x.abs()));
                if error < ROOM {
                    self.halvings = halvings.saturating_sub(1).max(self.accuracy.fewest());
                }
                let decays = self.may_decay;
                self.may_decay = self.decays;
                return Taken { halvings, decays };
            }
            x.copy_from_slice(&self.start[0]);
            let length = self.length / f64::from(1_u32 << halvings);
            // A state that does not decay at the start of the step may decay later in it.
            let mut is_stiff = || self.decay.find(x, inputs[0], length) || halvings == most;
            if !self.may_decay && is_stiff() {
                self.may_decay = true;
            } else {
                self.halvings += 1;
            }
            self.k[4].copy_from_slice(&self.start[1]);
            self.knows_slope = knew_slope;
            self.last.copy_from_slice(inputs[0]);
        }
    }

    /// Takes all parts of a step. Returns the largest error of a part.
    fn parts(&mut self, inputs: [&[f64]; 3], halvings: u8, x: &mut [f64]) -> f64 {
        // A held input jumps from one sample to the next.
        self.knows_slope &= self.last == inputs[0];
        self.decays = false;
        let error = if halvings == 0 {
            self.part(inputs, self.length, x);
            self.error(self.length, x, false)
        } else {
            let parts = 1_u32 << halvings;
            let length = self.length / f64::from(parts);
            let errors = (0..parts).map(|part| {
                for (before, stage) in self.before.iter_mut().zip([0, 2]) {
                    before.copy_from_slice(&self.k[stage]);
                }
                self.short_part(inputs, (part, parts), x);
                self.error(length, x, part > 0 && self.accuracy.sees_jumps)
            });
            // NaN must not count as a small error.
            errors.fold(0.0, |a, b| if b.is_nan() { f64::INFINITY } else { a.max(b) })
        };
        self.last.copy_from_slice(inputs[2]);
        if error.is_nan() { f64::INFINITY } else { error }
    }

    /// Takes one part of a step.
    fn short_part(&mut self, nodes: [&[f64]; 3], (part, parts): (u32, u32), x: &mut [f64]) {
        let mut inputs = std::mem::take(&mut self.inputs);
        within(nodes, (part, parts), &mut inputs);
        self.part([&inputs[0], &inputs[1], &inputs[2]], self.length / f64::from(parts), x);
        self.inputs = inputs;
    }

    /// Takes a Runge-Kutta step of length `h` (s).
    fn part(&mut self, inputs: [&[f64]; 3], h: f64, x: &mut [f64]) {
        let Self {
            model, constants, k, ..
        } = self;
        if self.knows_slope {
            k.swap(0, 4);
        } else {
            model.derivative(constants, x, inputs[0], &mut k[0]);
        }
        let derivative = |part: f64, x: &[f64], k: &mut [f64]| {
            model.derivative(constants, x, inputs[(2.0 * part) as usize], k);
        };
        if self.may_decay {
            self.decays |= self.decay.step(derivative, (inputs, h), x, k, &mut self.x);
        } else {
            rk4::step(derivative, h, x, k, &mut self.x);
        }
        x.copy_from_slice(&self.x);
        self.knows_slope = true;
    }

    /// Error of the last part, of length `h` (s) to state `x`, relative to the tolerance, or that of a jump in this part or
    /// the one before.
    fn error(&self, h: f64, x: &[f64], sees_jumps: bool) -> f64 {
        let error = |i: usize| {
            let size = self.largest[i].max(x[i].abs());
            let [start, _, middle, last, end] = self.k.each_ref().map(|k| k[i]);
            let error = if self.may_decay {
                self.decay.error(i, last, end, x[i]).abs()
            } else if sees_jumps {
                let before = self.before[0][i] - 4.0 * self.before[1][i];
                let jump = before + 6.0 * start - 4.0 * middle + end;
                h / 6.0 * (last - end).abs().max(jump.abs())
            } else {
                (h / 6.0 * (last - end)).abs()
            };
            if error == 0.0 {
                0.0
            } else {
                error / (self.accuracy.tolerance * size)
            }
        };
        (0..x.len())
            .map(error)
            .fold(0.0, |a, b| if b.is_nan() { b } else { a.max(b) })
    }
}

/// The inputs at the start, the middle and the end of a part of a step: on a parabola through those of the step.
pub fn within([a, b, c]: [&[f64]; 3], (part, parts): (u32, u32), inputs: &mut [Vec<f64>; 3]) {
    for (half, into) in inputs.iter_mut().enumerate() {
        let t = (f64::from(2 * part) + half as f64) / f64::from(2 * parts);
        let weights = [(2.0 * t - 1.0) * (t - 1.0), 4.0 * t * (1.0 - t), t * (2.0 * t - 1.0)];
        for (k, value) in into.iter_mut().enumerate() {
            *value = weights[0] * a[k] + weights[1] * b[k] + weights[2] * c[k];
        }
    }
}
