//! An implicit step for stiff systems, and the derivatives of its result.
//!
//! Radau IIA with two stages: order 3, and L-stable, so a fast decay needs no short steps (Hairer and Wanner, "Solving
//! Ordinary Differential Equations II", 2nd ed., section IV.5). The derivatives are those of the step itself.

use nalgebra::{DMatrix, DVector};

/// A system `dx/dt = f(t, x, p)` with its derivatives.
pub trait Linearised {
    /// Computes `f` and `∂f/∂x` at an instant.
    fn linearise(&mut self, t: f64, x: &DVector<f64>) -> Tangent;

    /// `∂f/∂p` at an instant, a column for each parameter.
    fn by_parameter(&mut self, t: f64, x: &DVector<f64>) -> DMatrix<f64>;
}

/// A right-hand side with its derivative.
pub struct Tangent {
    /// `f`.
    pub rate: DVector<f64>,
    /// `∂f/∂x`.
    pub by_state: DMatrix<f64>,
}

/// Times of the stages, as shares of the step.
const NODES: [f64; 2] = [1.0 / 3.0, 1.0];
/// Weights of the rates of both stages in each stage.
const WEIGHTS: [[f64; 2]; 2] = [[5.0 / 12.0, -1.0 / 12.0], [3.0 / 4.0, 1.0 / 4.0]];
/// Most iterations of Newton's method.
const ITERATIONS: usize = 12;
/// Change of the states, relative to their size, at which the iteration has converged. It is quadratic, so the next
/// change would be below rounding.
const CONVERGED: f64 = 1e-8;
/// Most halvings of a step for which the iteration does not converge.
const HALVINGS: usize = 12;

/// States, and their derivatives by the parameters.
#[derive(Clone, Debug)]
pub struct States {
    /// The states.
    pub x: DVector<f64>,
    /// Their derivatives, a column for each parameter.
    pub by_parameter: DMatrix<f64>,
}

/// Advances the states from one time to another, in several steps if Newton's method needs them. `scale` is the size
/// that counts as small for each state. False, with states of no meaning, if it does not converge.
pub fn advance(system: &mut impl Linearised, (from, to): (f64, f64), scale: &[f64], states: &mut States) -> bool {
    let (mut at, mut h, mut halvings) = (from, to - from, 0);
    loop {
        if step(system, (at, h), scale, states) {
            at += h;
            if to - at <= f64::EPSILON * to.abs().max(from.abs()) {
                return true;
            }
            h = h.min(to - at);
        } else {
            halvings += 1;
            if halvings > HALVINGS {
                return false;
            }
            h /= 2.0;
        }
    }
}

/// A single step; leaves the states unchanged and returns false if Newton's method does not converge.
fn step(system: &mut impl Linearised, (t, h): (f64, f64), scale: &[f64], states: &mut States) -> bool {
    let size = states.x.len();
    let mut stages = [states.x.clone(), states.x.clone()];
    for _ in 0..ITERATIONS {
        let tangents = [0, 1].map(|stage| system.linearise(t + NODES[stage] * h, &stages[stage]));
        let equations = coupled(&tangents, h).lu();
        let residual = stacked(|stage| {
            let increments = (0..2).map(|other| h * WEIGHTS[stage][other] * &tangents[other].rate);
            let residual = increments.fold(&states.x - &stages[stage], |sum, own| sum + own);
            DMatrix::from_column_slice(size, 1, residual.as_slice())
        });
        let Some(change) = equations.solve(&residual) else {
            return false;
        };
        let mut is_small = true;
        for (stage, x) in stages.iter_mut().enumerate() {
            for (row, value) in x.iter_mut().enumerate() {
                let own = change[(stage * size + row, 0)];
                *value += own;
                is_small &= own.abs() <= CONVERGED * (value.abs() + scale[row]);
            }
        }
        if !change.iter().all(|own| own.is_finite()) {
            return false;
        }
        if is_small {
            let pushes = [0, 1].map(|stage| system.by_parameter(t + NODES[stage] * h, &stages[stage]));
            let known = stacked(|stage| {
                let increments = (0..2).map(|other| h * WEIGHTS[stage][other] * &pushes[other]);
                increments.fold(states.by_parameter.clone(), |sum, own| sum + own)
            });
            let Some(slopes) = equations.solve(&known) else {
                return false;
            };
            states.by_parameter = slopes.rows(size, size).into_owned();
            [_, states.x] = stages;
            return true;
        }
    }
    false
}

/// The derivative of the equations of both stages by both.
fn coupled(tangents: &[Tangent; 2], h: f64) -> DMatrix<f64> {
    let size = tangents[0].rate.len();
    let mut all = DMatrix::identity(2 * size, 2 * size);
    for (row, weights) in WEIGHTS.iter().enumerate() {
        for (column, weight) in weights.iter().enumerate() {
            let mut block = all.view_mut((row * size, column * size), (size, size));
            block -= h * *weight * &tangents[column].by_state;
        }
    }
    all
}

/// Both stages on top of each other.
fn stacked(stage: impl Fn(usize) -> DMatrix<f64>) -> DMatrix<f64> {
    let [upper, lower] = [stage(0), stage(1)];
    let (size, columns) = upper.shape();
    let mut all = DMatrix::zeros(2 * size, columns);
    all.rows_mut(0, size).copy_from(&upper);
    all.rows_mut(size, size).copy_from(&lower);
    all
}

#[cfg(test)]
mod tests {
    use nalgebra::{DMatrix, DVector};

    use super::{Linearised, States, Tangent, advance};

    /// `dx/dt = -p (x - cos t)`, whose solution and its derivative by `p` have closed forms.
    struct Follower(f64);

    impl Linearised for Follower {
        fn linearise(&mut self, t: f64, x: &DVector<f64>) -> Tangent {
            let apart = x[0] - t.cos();
            Tangent {
                rate: DVector::from_element(1, -self.0 * apart),
                by_state: DMatrix::from_element(1, 1, -self.0),
            }
        }

        fn by_parameter(&mut self, t: f64, x: &DVector<f64>) -> DMatrix<f64> {
            DMatrix::from_element(1, 1, t.cos() - x[0])
        }
    }

    /// The settled solution, which starts at a time of zero.
    fn settled(p: f64, t: f64) -> f64 {
        p * (p * t.cos() + t.sin()) / (p * p + 1.0)
    }

    fn error(p: f64, steps: usize) -> (f64, f64) {
        let slope = |t: f64| (settled(p * 1.0001, t) - settled(p * 0.9999, t)) / (2e-4 * p);
        let mut states = States {
            x: DVector::from_element(1, settled(p, 0.0)),
            by_parameter: DMatrix::from_element(1, 1, slope(0.0)),
        };
        let h = 1.0 / steps as f64;
        for k in 0..steps {
            assert!(advance(
                &mut Follower(p),
                (k as f64 * h, (k + 1) as f64 * h),
                &[1e-6],
                &mut states
            ));
        }
        (
            (states.x[0] - settled(p, 1.0)).abs(),
            (states.by_parameter[(0, 0)] - slope(1.0)).abs(),
        )
    }

    #[test]
    fn the_error_falls_with_the_third_power_of_the_step() {
        let [coarse, fine] = [20, 40].map(|steps| error(2.0, steps));
        for (coarse, fine) in [(coarse.0, fine.0), (coarse.1, fine.1)] {
            assert!((6.5..9.5).contains(&(coarse / fine)), "{coarse} {fine}");
        }
    }

    #[test]
    fn a_fast_decay_needs_no_short_steps() {
        let (of_state, of_slope) = error(1e9, 20);
        assert!(of_state < 1e-12 && of_slope < 1e-15, "{of_state} {of_slope}");
    }
}
