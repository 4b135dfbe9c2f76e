//! The matrix of a step: from the states and forces at its beginning to the states at its end.
//!
//! In a short step, a part of a long chain moves only its neighbours. Negligible entries are left out, so that the work
//! of a step grows linearly with the number of states.

use std::array;

use crate::solver::matrix::{Lanes, Matrix};
use crate::vectors::{Loops, widest};

/// Entries below this value are left out, if the states are scaled so that an entry and its transpose are equal. Over
/// 10⁹ steps their sum stays below the rounding of the states, 10⁻¹⁶.
const NEGLIGIBLE: f64 = 1e-25;

/// A matrix in tiles of four rows and four columns; tiles of zeros are left out.
#[derive(Clone)]
pub(super) struct Propagator {
    /// The tiles, from left to right and then down; each is stored column by column.
    tiles: Vec<[Lanes; 4]>,
    /// Position of each tile in its group of rows.
    places: Vec<usize>,
    /// For each group of four rows, the position after its last tile.
    ends: Vec<usize>,
}

impl Propagator {
    /// The first `states` rows of a matrix, whose first columns belong to the same states.
    pub fn new(matrix: &Matrix, states: usize) -> Self {
        let entry = |row: usize, column: usize| {
            let entry = matrix.entry(row, column);
            let back = if row < states && column < states {
                matrix.entry(column, row)
            } else {
                0.0
            };
            // Both are scaled inversely by the units of their states, their product is not.
            let size = (entry * back).abs();
            if back != 0.0 && size < NEGLIGIBLE * NEGLIGIBLE {
                0.0
            } else {
                entry
            }
        };
        let mut propagator = Self {
            tiles: Vec::new(),
            places: Vec::new(),
            ends: Vec::new(),
        };
        for first in (0..states).step_by(4) {
            for place in 0..matrix.size() / 4 {
                let tile: [Lanes; 4] = array::from_fn(|k| array::from_fn(|lane| entry(first + lane, 4 * place + k)));
                if tile.as_flattened().iter().any(|entry| *entry != 0.0) {
                    propagator.tiles.push(tile);
                    propagator.places.push(place);
                }
            }
            propagator.ends.push(propagator.tiles.len());
        }
        propagator
    }

    /// Writes the product with a vector, whose length is a multiple of four.
    #[inline(always)]
    pub fn apply(&self, by: &[f64], result: &mut [f64]) {
        widest(Product {
            matrix: self,
            by,
            result,
        });
    }

    /// Row, column and value of each entry that is not left out.
    pub fn entries(&self) -> impl Iterator<Item = (usize, usize, f64)> {
        let begins = std::iter::once(&0).chain(&self.ends);
        let rows = begins.zip(&self.ends).enumerate();
        rows.flat_map(move |(block, (&begin, &end))| {
            (begin..end).flat_map(move |tile| {
                let entry = move |at: usize| {
                    let (k, lane) = (at / 4, at % 4);
                    (4 * block + lane, 4 * self.places[tile] + k, self.tiles[tile][k][lane])
                };
                (0..16).map(entry)
            })
        })
    }
}

struct Product<'a> {
    matrix: &'a Propagator,
    by: &'a [f64],
    result: &'a mut [f64],
}

impl Loops for Product<'_> {
    type Result = ();

    #[inline(always)]
    fn run(self) {
        let factors = self.by.as_chunks::<4>().0;
        let mut begin = 0;
        for (result, &end) in self.result.as_chunks_mut::<4>().0.iter_mut().zip(&self.matrix.ends) {
            // Four independent sums.
            let mut sums = [[0.0; 4]; 4];
            for (columns, &place) in self.matrix.tiles[begin..end]
                .iter()
                .zip(&self.matrix.places[begin..end])
            {
                let factors = &factors[place];
                for k in 0..4 {
                    for lane in 0..4 {
                        sums[k][lane] += columns[k][lane] * factors[k];
                    }
                }
            }
            *result = array::from_fn(|lane| (sums[0][lane] + sums[1][lane]) + (sums[2][lane] + sums[3][lane]));
            begin = end;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::Propagator;
    use crate::solver::matrix::Matrix;

    /// A step of 1 ms of a chain of masses, each on the one before it by a spring (8 kN/m for 2 kg) and a damper.
    fn flow(masses: usize) -> Matrix {
        let (step, stiffness, damping) = (1e-3, 4e3, 15.0);
        let mut rates = Matrix::zero(2 * masses);
        for mass in 0..masses {
            let velocity = masses + mass;
            *rates.entry_mut(mass, velocity) = step;
            let neighbours = [mass.checked_sub(1), Some(mass + 1).filter(|next| *next < masses)];
            for neighbour in neighbours.into_iter().flatten() {
                for (to, sign) in [(neighbour, 1.0), (mass, -1.0)] {
                    *rates.entry_mut(velocity, to) += sign * step * stiffness;
                    *rates.entry_mut(velocity, masses + to) += sign * step * damping;
                }
            }
        }
        rates.exponential().expect("it is finite")
    }

    #[test]
    fn work_grows_with_the_length_of_a_chain() {
        let [short, long] = [60, 120].map(|masses| Propagator::new(&flow(masses), 2 * masses).tiles.len());
        assert!(long <= 2 * short + short / 5, "{short} {long}");
    }

    #[test]
    fn what_is_left_out_changes_no_state() {
        let masses = 60;
        let flow = flow(masses);
        let propagator = Propagator::new(&flow, 2 * masses);
        assert!(propagator.tiles.len() < 30 * 30, "something is left out");
        let state: Vec<f64> = (0..2 * masses).map(|i| (1.7 * i as f64).sin()).collect();
        let mut next = vec![0.0; 2 * masses];
        propagator.apply(&state, &mut next);
        for (row, next) in next.iter().enumerate() {
            let terms: Vec<f64> = (0..2 * masses)
                .map(|column| flow.entry(row, column) * state[column])
                .collect();
            let size: f64 = terms.iter().map(|term| term.abs()).sum();
            assert!((terms.iter().sum::<f64>() - next).abs() <= 1e-14 * size, "{row}");
        }
    }
}
