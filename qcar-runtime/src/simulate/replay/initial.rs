//! Dependence of the readings of a linear model on its initial states.
//!
//! A reading is a row times the states, `c x`. After `k` steps of the transition matrix `Φ` it depends on the initial
//! states by `c Φᵏ`. This row is advanced instead of one state vector for each initial state, so the work grows with
//! the number of nonzeros of A, whatever the number of states.

use super::Reading;
use super::stepper::Taken;
use crate::matrices::at_rest;
use crate::model::{About, Entry, Matrix, Model};

/// A linear model without excitation, in the steps of a replay.
pub struct FreeResponse<'a> {
    about: &'a About,
    /// The nonzeros of A.
    a: Vec<(&'a Entry, f64)>,
    /// The nonzeros of C.
    c: Vec<(&'a Entry, f64)>,
    /// Length of a whole step, s.
    length: f64,
}

impl<'a> FreeResponse<'a> {
    /// Prepares for steps of `length` (s).
    pub fn new(model: &'a dyn Model, p: &[f64], length: f64) -> Self {
        let about = model.about();
        let nonzeros: Vec<_> = about.matrices.iter().zip(at_rest(model, p)).collect();
        let of = |matrix| {
            nonzeros
                .iter()
                .copied()
                .filter(move |(entry, _)| entry.matrix == matrix)
        };
        Self {
            about,
            a: of(Matrix::A).collect(),
            c: of(Matrix::C).collect(),
            length,
        }
    }

    /// For each of `states`, the samples of a reading if this state begins at one and all others at zero. `taken`
    /// are the steps of each sample.
    pub fn of<'s>(
        &self,
        reading: Reading,
        taken: impl Iterator<Item = &'s [Taken]>,
        states: &[usize],
    ) -> Vec<Vec<f64>> {
        let mut row = self.row(reading);
        let mut responses = vec![Vec::new(); states.len()];
        for steps in taken {
            for (response, &state) in responses.iter_mut().zip(states) {
                response.push(row[state]);
            }
            steps.iter().for_each(|step| self.step(&mut row, step.halvings));
        }
        responses
    }

    /// Coefficient of each state in a reading.
    fn row(&self, reading: Reading) -> Vec<f64> {
        let mut row = vec![0.0; self.about.states.len()];
        match reading {
            Reading::State(state) => row[state] = 1.0,
            Reading::Output(output) => {
                for &(entry, value) in &self.c {
                    if usize::from(entry.row) == output {
                        row[usize::from(entry.column)] = value;
                    }
                }
            }
        }
        row
    }

    /// The row times the transition matrix of the Runge-Kutta method, `1 + hA + (hA)²/2 + (hA)³/6 + (hA)⁴/24`, for each
    /// part of a step.
    fn step(&self, row: &mut [f64], halvings: u8) {
        let parts = 1_u32 << halvings;
        let h = self.length / f64::from(parts);
        let (mut term, mut next) = (vec![0.0; row.len()], vec![0.0; row.len()]);
        for _ in 0..parts {
            term.copy_from_slice(row);
            for power in 1..=4 {
                let factor = h / f64::from(power);
                next.fill(0.0);
                for (entry, value) in &self.a {
                    next[usize::from(entry.column)] += factor * value * term[usize::from(entry.row)];
                }
                row.iter_mut().zip(&next).for_each(|(row, next)| *row += next);
                std::mem::swap(&mut term, &mut next);
            }
        }
    }
}
