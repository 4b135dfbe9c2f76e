//! Many linear systems with one matrix, each under forces that are linear between points: a first-order hold.
//!
//! With `dx/dt = A x + u`, and `u` linear in time from `u₀` to `u₁`, the next state is `Φ x + Γ₀ u₀ + Γ₁ u₁` without error,
//! however fast the system is (M. Hochbruck, A. Ostermann, "Exponential integrators", Acta Numerica 19, 2010, section 2).

use nalgebra::DMatrix;

use super::matrix::Matrix;
use crate::vectors::{Loops, widest};

/// What a step does to states and forces.
pub struct Hold {
    /// Of each state.
    flow: DMatrix<f64>,
    /// Of each force at the beginning of a step, and at its end.
    forces: [DMatrix<f64>; 2],
}

impl Hold {
    /// For the matrix `a` and forces on the states `forced`, in steps of `step` (s). None where the system is not finite, or
    /// moves a million times too much in a step.
    pub fn new(a: &DMatrix<f64>, forced: &[usize], step: f64) -> Option<Self> {
        let (n, m) = (a.nrows(), forced.len());
        // In time of a step: the states, the forces at its beginning, and what these change by until its end.
        let mut whole = Matrix::zero(n + 2 * m);
        for row in 0..n {
            for column in 0..n {
                *whole.entry_mut(row, column) = a[(row, column)] * step;
            }
        }
        for (place, &state) in forced.iter().enumerate() {
            *whole.entry_mut(state, n + place) = step;
            *whole.entry_mut(n + place, n + m + place) = 1.0;
        }
        let flow = whole.exponential()?;
        let at_end = DMatrix::from_fn(n, m, |row, place| flow.entry(row, n + m + place));
        let of_both = DMatrix::from_fn(n, m, |row, place| flow.entry(row, n + place));
        Some(Self {
            flow: DMatrix::from_fn(n, n, |row, column| flow.entry(row, column)),
            forces: [of_both - &at_end, at_end],
        })
    }

    /// What forces at the end of a step add to the states there: `Γ₁`.
    pub fn of_end(&self) -> &DMatrix<f64> {
        &self.forces[1]
    }

    /// Writes the next states of some systems: of each state, and of each force at both ends of the step, there is a value
    /// for every system, one after the other.
    pub fn step(&self, systems: usize, states: &[f64], forces: [&[f64]; 2], next: &mut [f64]) {
        next.fill(0.0);
        let products = [
            (&self.flow, states),
            (&self.forces[0], forces[0]),
            (&self.forces[1], forces[1]),
        ];
        for (matrix, by) in products {
            widest(Added {
                matrix,
                by,
                systems,
                sum: next,
            });
        }
    }
}

/// The product of a matrix with a row of numbers for each of its columns, added to a row for each of its rows.
struct Added<'a> {
    matrix: &'a DMatrix<f64>,
    by: &'a [f64],
    systems: usize,
    sum: &'a mut [f64],
}

impl Loops for Added<'_> {
    type Result = ();

    #[inline(always)]
    fn run(self) {
        let columns = self.matrix.as_slice().chunks_exact(self.matrix.nrows());
        for (column, by) in columns.zip(self.by.chunks_exact(self.systems)) {
            for (factor, sum) in column.iter().zip(self.sum.chunks_exact_mut(self.systems)) {
                for (sum, by) in sum.iter_mut().zip(by) {
                    *sum += factor * by;
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::DMatrix;

    use super::Hold;

    /// A mass on a spring and a damper under a force that grows with time, in closed form.
    #[test]
    fn an_oscillator_under_a_growing_force_is_stepped_without_error() {
        let (frequency, decay, step): (f64, f64, f64) = (90.0, 4.0, 0.02);
        let stiffness = frequency * frequency + decay * decay;
        let a = DMatrix::from_row_slice(2, 2, &[0.0, 1.0, -stiffness, -2.0 * decay]);
        let hold = Hold::new(&a, &[1], step).expect("it is finite");
        // Under the force `stiffness (t + 2 decay / stiffness)` the mass moves as `t`, and around that on its own.
        let force = |t: f64| stiffness * t + 2.0 * decay;
        let own = |t: f64| {
            let (sin, cos) = (frequency * t).sin_cos();
            let fades = 0.3 * (-decay * t).exp();
            [fades * cos, -fades * (decay * cos + frequency * sin)]
        };
        let exact = |t: f64| [t + own(t)[0], 1.0 + own(t)[1]];
        // The second system has the same force without any motion at the beginning.
        let mut states = [exact(0.0)[0], 0.0, exact(0.0)[1], 1.0];
        for k in 0..50 {
            let forces = [force(f64::from(k) * step), force(f64::from(k + 1) * step)].map(|force| [force; 2]);
            let mut next = [0.0; 4];
            hold.step(2, &states, [&forces[0], &forces[1]], &mut next);
            states = next;
        }
        let end = exact(1.0);
        let expected = [end[0], 1.0, end[1], 1.0];
        for (found, expected) in states.iter().zip(expected) {
            assert!((found - expected).abs() < 1e-10, "{states:?} {expected:?}");
        }
    }
}
