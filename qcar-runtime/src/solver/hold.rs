//! Many linear systems with one matrix, each under forces that are linear between points: a first-order hold.
//!
//! With `dx/dt = A x + u`, and `u` linear in time from `u₀` to `u₁`, the next state is `Φ x + Γ₀ u₀ + Γ₁ u₁` without
//! error, however fast the system is (M. Hochbruck, A. Ostermann, "Exponential integrators", Acta Numerica 19, 2010,
//! section 2).

use std::array;

use nalgebra::DMatrix;

use super::matrix::Matrix;
use crate::vectors::{Loops, over_lanes};

/// Effect of a step on states and forces.
pub struct Hold {
    /// Row by row, the factors of each state, of each force at the beginning of a step, and of each force at its end.
    factors: Vec<f64>,
    /// The factors of the forces at the end.
    of_end: DMatrix<f64>,
}

impl Hold {
    /// For the matrix `a` and forces on the states `forced`, in steps of `step` (s). `None` if the system is not
    /// finite, or if its norm times the step exceeds a million.
    pub fn new(a: &DMatrix<f64>, forced: &[usize], step: f64) -> Option<Self> {
        let (n, m) = (a.nrows(), forced.len());
        // With the step as the unit of time: the states, the forces at its beginning, and their changes until its end.
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
        let of_end = DMatrix::from_fn(n, m, |row, place| flow.entry(row, n + m + place));
        let row = |row: usize| {
            let flow = &flow;
            let of_state = (0..n).map(move |column| flow.entry(row, column));
            let of_begin = (0..m).map(move |place| flow.entry(row, n + place) - flow.entry(row, n + m + place));
            let of_end = (0..m).map(move |place| flow.entry(row, n + m + place));
            of_state.chain(of_begin).chain(of_end)
        };
        Some(Self {
            factors: (0..n).flat_map(row).collect(),
            of_end,
        })
    }

    /// Contribution of the forces at the end of a step to the states there: `Γ₁`.
    pub fn of_end(&self) -> &DMatrix<f64> {
        &self.of_end
    }

    /// Writes the next states of several systems: each state, and each force at both ends of the step, has a value for
    /// every system, one after the other.
    pub fn step(&self, systems: usize, states: &[f64], forces: [&[f64]; 2], next: &mut [f64]) {
        over_lanes(Step {
            factors: &self.factors,
            systems,
            acting: [states, forces[0], forces[1]],
            next,
        });
    }
}

/// The product of the factors with a row of numbers for each state and force: a row for each next state.
struct Step<'a> {
    factors: &'a [f64],
    systems: usize,
    acting: [&'a [f64]; 3],
    next: &'a mut [f64],
}

/// Next states that are computed together: each number that acts on them is loaded once, and their sums do not wait for
/// each other.
const STATES: usize = 4;

impl Step<'_> {
    /// The sums of `R` next states, whose rows of factors are `factors`, for `N` neighbouring systems.
    #[inline(always)]
    fn sums<const R: usize, const N: usize>(&self, factors: [&[f64]; R], from: usize) -> [[f64; N]; R] {
        let mut sums = [[0.0; N]; R];
        let mut place = 0;
        for acting in self.acting {
            for by in acting.chunks_exact(self.systems) {
                let by = &by[from..][..N];
                for (sums, factors) in sums.iter_mut().zip(factors) {
                    let factor = factors[place];
                    (0..N).for_each(|lane| sums[lane] += factor * by[lane]);
                }
                place += 1;
            }
        }
        sums
    }

    /// Computes `R` next states from the one in `row` on.
    #[inline(always)]
    fn rows<const R: usize>(&mut self, row: usize, width: usize) {
        let factors: [&[f64]; R] = array::from_fn(|own| &self.factors[(row + own) * width..][..width]);
        let mut from = 0;
        while from < self.systems {
            from += match self.systems - from {
                8.. => self.write::<R, 8>(factors, (row, from)),
                4.. => self.write::<R, 4>(factors, (row, from)),
                _ => self.write::<R, 1>(factors, (row, from)),
            };
        }
    }

    #[inline(always)]
    fn write<const R: usize, const N: usize>(&mut self, factors: [&[f64]; R], (row, from): (usize, usize)) -> usize {
        let sums = self.sums::<R, N>(factors, from);
        for (own, sums) in sums.iter().enumerate() {
            self.next[(row + own) * self.systems + from..][..N].copy_from_slice(sums);
        }
        N
    }
}

impl Loops for Step<'_> {
    type Result = ();

    #[inline(always)]
    fn run(mut self) {
        let states = self.next.len() / self.systems;
        let width = self.factors.len() / states;
        let mut row = 0;
        while row < states {
            row += if row + STATES <= states {
                self.rows::<STATES>(row, width);
                STATES
            } else {
                self.rows::<1>(row, width);
                1
            };
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
        // Under the force `stiffness (t + 2 decay / stiffness)` the particular solution is `t`; the free vibration is
        // added to it.
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
