//! States that decay within a step, such as the force of a stiff friction that slides.
//!
//! The classical Runge-Kutta method diverges where a state decays much faster than a step lasts. The exponential method
//! of the same order integrates the decay of each state by its own value exactly, and takes the rest at the same stages.
//! For a state whose own decay is not separated, the rate 0, it is the classical method.
//!
//! Source: Cox, S. M., Matthews, P. C.: Exponential time differencing for stiff systems, J. Computational Physics 176,
//! 2002, equations 26 to 29.

use crate::model::{Matrix, Model};

/// Longest step times rate of decay for which the classical method lets a state decay; its limit is 2.785 (Hairer,
/// Wanner, Solving ordinary differential equations II, section IV.2).
const LONGEST: f64 = 2.5;

/// Weights of a step for a state.
#[derive(Clone, Copy, Debug)]
pub struct Weights {
    /// Rate of the separated decay, 1/s: negative, or 0.
    pub rate: f64,
    /// What is left of the state after half a step, and after the whole one.
    kept: [f64; 2],
    /// Weight of the remaining slope over half a step, s.
    half: f64,
    /// Weights of the remaining slopes over the step, s: at its start, at both stages in the middle, and at its end.
    over: [f64; 3],
}

impl Weights {
    /// Weights for steps of length `h` (s). A decay that the classical method follows is not separated.
    pub fn new(rate: f64, h: f64) -> Self {
        let z = rate * h;
        if z > -LONGEST {
            return Self {
                rate: 0.0,
                kept: [1.0, 1.0],
                half: h / 2.0,
                over: [h / 6.0, h / 3.0, h / 6.0],
            };
        }
        let first = |z: f64| z.exp_m1() / z;
        let second = (first(z) - 1.0) / z;
        let third = (second - 0.5) / z;
        Self {
            rate,
            kept: [(z / 2.0).exp(), z.exp()],
            half: h / 2.0 * first(z / 2.0),
            over: [
                h * (first(z) - 3.0 * second + 4.0 * third),
                h * (2.0 * second - 4.0 * third),
                h * (4.0 * third - second),
            ],
        }
    }

    /// True if the decay is separated.
    pub fn decays(&self) -> bool {
        self.rate < 0.0
    }

    /// A value in the middle of the step from that at its start and a slope.
    #[inline(always)]
    pub fn middle(&self, x: f64, slope: f64) -> f64 {
        self.kept[0] * x + self.half * slope
    }

    /// The value at the last stage, from the first one in the middle and the slopes at the start and at the second one in
    /// the middle.
    #[inline(always)]
    pub fn last(&self, middle: f64, first: f64, second: f64) -> f64 {
        self.kept[0] * middle + self.half * (2.0 * second - first)
    }

    /// The value at the end of the step from that at its start and the slopes at the stages.
    #[inline(always)]
    pub fn end(&self, x: f64, [start, one, other, last]: [f64; 4]) -> f64 {
        self.kept[1] * x + self.over[0] * start + self.over[1] * (one + other) + self.over[2] * last
    }

    /// Difference to a method of the third order, from the slopes at the last stage and at the end of the step.
    pub fn error(&self, last: f64, end: f64) -> f64 {
        self.over[2] * (last - end)
    }
}

/// Finds the states that decay within a step, and takes such steps.
pub struct Decay<'a> {
    model: &'a dyn Model,
    p: &'a [f64],
    /// Nonzeros of A by which states depend on their own values, with these states.
    own: Vec<(usize, usize)>,
    matrices: Vec<f64>,
    weights: Vec<Weights>,
    /// The first stage in the middle.
    middle: Vec<f64>,
}

impl<'a> Decay<'a> {
    /// For a model with these parameter values.
    pub fn new(model: &'a dyn Model, p: &'a [f64]) -> Self {
        Self {
            model,
            p,
            own: own(model),
            matrices: vec![0.0; model.about().matrices.len()],
            weights: Vec::new(),
            middle: vec![0.0; model.about().states.len()],
        }
    }

    /// Finds the states that decay within a step of length `h` (s) from `x`. False if there is none.
    pub fn find(&mut self, x: &[f64], u: &[f64], h: f64) -> bool {
        if self.own.is_empty() {
            return false;
        }
        self.model.matrices(self.p, x, u, &mut self.matrices);
        self.weights.clear();
        self.weights.resize(x.len(), Weights::new(0.0, h));
        for &(nonzero, state) in &self.own {
            self.weights[state] = Weights::new(self.matrices[nonzero], h);
        }
        self.weights.iter().any(Weights::decays)
    }

    /// One step from `x`, where the slope is `k[0]`, to `x_end`, where it is `k[4]`, with the weights that were found.
    /// `derivative` gets the part of the step as an argument.
    pub fn step(
        &mut self,
        mut derivative: impl FnMut(f64, &[f64], &mut [f64]),
        x: &[f64],
        k: &mut [Vec<f64>; 5],
        x_end: &mut [f64],
    ) {
        let weights = &self.weights;
        let remaining = |k: &mut [f64], x: &[f64]| {
            for ((k, x), own) in k.iter_mut().zip(x).zip(weights) {
                *k -= own.rate * x;
            }
        };
        remaining(&mut k[0], x);
        for stage in 1..4 {
            for (i, own) in weights.iter().enumerate() {
                x_end[i] = match stage {
                    3 => own.last(self.middle[i], k[0][i], k[2][i]),
                    _ => own.middle(x[i], k[stage - 1][i]),
                };
            }
            if stage == 1 {
                self.middle.copy_from_slice(x_end);
            }
            derivative(if stage == 3 { 1.0 } else { 0.5 }, x_end, &mut k[stage]);
            remaining(&mut k[stage], x_end);
        }
        for (i, own) in weights.iter().enumerate() {
            x_end[i] = own.end(x[i], [k[0][i], k[1][i], k[2][i], k[3][i]]);
        }
        derivative(1.0, x_end, &mut k[4]);
    }

    /// Error of the last step in a state, from its slope at the last stage, without the separated decay, and its slope
    /// and value at the end.
    pub fn error(&self, state: usize, last: f64, end: f64, x_end: f64) -> f64 {
        let own = &self.weights[state];
        own.error(last, end - own.rate * x_end)
    }
}

/// Nonzeros of A by which states depend on their own values, with these states. None of a linear model: its free
/// responses are those of the classical method.
pub fn own(model: &dyn Model) -> Vec<(usize, usize)> {
    let about = model.about();
    let entries = about.matrices.iter().enumerate();
    let own = entries.filter(|(_, entry)| entry.matrix == Matrix::A && entry.row == entry.column && !about.linear);
    own.map(|(nonzero, entry)| (nonzero, usize::from(entry.row))).collect()
}
