//! States that decay within a step, such as the force of a stiff friction that slides.
//!
//! The classical Runge-Kutta method diverges where a state decays much faster than a step lasts. The exponential method
//! of the same order integrates the decay of each state by its own value exactly, and takes the rest at the same stages.
//! For a state whose own decay is not separated, the rate 0, it is the classical method.
//!
//! Source: Cox, S. M., Matthews, P. C.: Exponential time differencing for stiff systems, J. Computational Physics 176,
//! 2002, equations 26 to 29.

use crate::model::{Matrix, Model};
use crate::solver::rk4;

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
    pub own: Vec<(usize, usize)>,
    matrices: Vec<f64>,
    weights: Vec<Weights>,
    /// The remaining slope at the start, and the first stage in the middle.
    first: Vec<f64>,
    middle: Vec<f64>,
}

impl<'a> Decay<'a> {
    /// For a model with these parameter values.
    pub fn new(model: &'a dyn Model, p: &'a [f64]) -> Self {
        let about = model.about();
        let row = || vec![0.0; about.states.len()];
        Self {
            model,
            p,
            own: own(model),
            matrices: vec![0.0; about.matrices.len()],
            weights: Vec::new(),
            first: row(),
            middle: row(),
        }
    }

    /// Finds the states that decay within a step of length `h` (s) from `x`. False if there is none.
    pub fn find(&mut self, x: &[f64], u: &[f64], h: f64) -> bool {
        self.weights.clear();
        self.weights.resize(x.len(), Weights::new(0.0, h));
        self.has_faster(x, u, h)
    }

    /// Takes the rates at a point that are more than twice as fast as the separated ones. The method lets the rest of a
    /// decay decay only if that is slower than the separated one. False if there is no such rate.
    fn has_faster(&mut self, x: &[f64], u: &[f64], h: f64) -> bool {
        if self.own.is_empty() {
            return false;
        }
        self.model.matrices(self.p, x, u, &mut self.matrices);
        let mut is_faster = false;
        for &(nonzero, state) in &self.own {
            let (there, known) = (self.matrices[nonzero], self.weights[state].rate);
            let own = Weights::new(there, h);
            if own.decays() && there < 2.0 * known {
                self.weights[state] = own;
                is_faster = true;
            }
        }
        is_faster
    }

    /// One step of length `h` (s) from `x`, where the slope is `k[0]`, to `x_end`, where it is `k[4]`. Decays are separated
    /// at their rates at the start, or at those in the middle or at the end if these are much faster. `inputs` are those at
    /// the three. `derivative` gets the part of the step as an argument. Returns true if some decay was separated.
    pub fn step(
        &mut self,
        mut derivative: impl FnMut(f64, &[f64], &mut [f64]),
        (inputs, h): ([&[f64]; 3], f64),
        x: &[f64],
        k: &mut [Vec<f64>; 5],
        x_end: &mut [f64],
    ) -> bool {
        let decays = self.find(x, inputs[0], h);
        if decays {
            self.separated(&mut derivative, x, k, x_end);
        } else {
            rk4::step(&mut derivative, h, x, k, x_end);
        }
        let middle = std::mem::take(&mut self.middle);
        let is_faster_there = decays && self.has_faster(&middle, inputs[1], h);
        self.middle = middle;
        let is_repeated = self.has_faster(x_end, inputs[2], h) || is_faster_there;
        if is_repeated {
            self.separated(&mut derivative, x, k, x_end);
        }
        decays || is_repeated
    }

    /// A step with the present weights.
    fn separated(
        &mut self,
        derivative: &mut impl FnMut(f64, &[f64], &mut [f64]),
        x: &[f64],
        k: &mut [Vec<f64>; 5],
        x_end: &mut [f64],
    ) {
        let Self {
            weights, first, middle, ..
        } = self;
        let remaining = |k: &mut [f64], x: &[f64]| {
            for ((k, x), own) in k.iter_mut().zip(x).zip(&*weights) {
                *k -= own.rate * x;
            }
        };
        first.copy_from_slice(&k[0][..x.len()]);
        remaining(first, x);
        for stage in 1..4 {
            for (i, own) in weights.iter().enumerate() {
                x_end[i] = match stage {
                    1 => own.middle(x[i], first[i]),
                    2 => own.middle(x[i], k[1][i]),
                    _ => own.last(middle[i], first[i], k[2][i]),
                };
            }
            if stage == 1 {
                middle.copy_from_slice(x_end);
            }
            derivative(if stage == 3 { 1.0 } else { 0.5 }, x_end, &mut k[stage]);
            remaining(&mut k[stage], x_end);
        }
        for (i, own) in weights.iter().enumerate() {
            x_end[i] = own.end(x[i], [first[i], k[1][i], k[2][i], k[3][i]]);
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
fn own(model: &dyn Model) -> Vec<(usize, usize)> {
    let about = model.about();
    let entries = about.matrices.iter().enumerate();
    let own = entries.filter(|(_, entry)| entry.matrix == Matrix::A && entry.row == entry.column && !about.linear);
    own.map(|(nonzero, entry)| (nonzero, usize::from(entry.row))).collect()
}

#[cfg(test)]
mod tests {
    use super::Weights;

    /// The state x of x' = r x + b + c t + d t² after a step of 1 s from 1, with the stages of the method.
    fn after(rate: f64, separated: f64, [b, c, d]: [f64; 3]) -> f64 {
        let own = Weights::new(separated, 1.0);
        let slope = |t: f64, x: f64| rate * x + b + c * t + d * t * t - own.rate * x;
        let first = slope(0.0, 1.0);
        let one = own.middle(1.0, first);
        let slope_at_one = slope(0.5, one);
        let other = own.middle(1.0, slope_at_one);
        let slope_at_other = slope(0.5, other);
        let last = own.last(one, first, slope_at_other);
        own.end(1.0, [first, slope_at_one, slope_at_other, slope(1.0, last)])
    }

    /// The exact solution: a polynomial of second degree and the decaying rest.
    fn exact(rate: f64, [b, c, d]: [f64; 3]) -> f64 {
        let quadratic = -d / rate;
        let linear = (2.0 * quadratic - c) / rate;
        let constant = (linear - b) / rate;
        constant + linear + quadratic + (1.0 - constant) * rate.exp()
    }

    /// However fast the decay is, the method is exact if the rest is a polynomial of second degree over time.
    #[test]
    fn a_separated_decay_is_exact() {
        for rate in [-2.5, -30.0, -4e3] {
            let rest = [3.0, -5.0, 2.0];
            let (found, expected) = (after(rate, rate, rest), exact(rate, rest));
            assert!(
                (found / expected - 1.0).abs() < 1e-9,
                "{found}, not {expected} at {rate}/s"
            );
        }
    }

    /// The classical method multiplies a decaying state by 1 + z + z²/2 + z³/6 + z⁴/24.
    #[test]
    fn a_slow_decay_is_that_of_the_classical_method() {
        let z: f64 = -1.3;
        let expected = 1.0 + z + z.powi(2) / 2.0 + z.powi(3) / 6.0 + z.powi(4) / 24.0;
        assert!((after(z, z, [0.0; 3]) - expected).abs() < 1e-15);
    }

    /// A decay that is twice as fast as the separated one still decays.
    #[test]
    fn a_decay_of_twice_the_separated_rate_does_not_grow() {
        for rate in [-2.5, -30.0, -4e3, -1e7] {
            let found = after(2.0 * rate, rate, [0.0; 3]);
            assert!(found.abs() < 1.0, "{found} at {rate}/s");
        }
    }
}
