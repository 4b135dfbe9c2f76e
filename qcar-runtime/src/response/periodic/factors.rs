//! The Jacobian of a balance, factorised.
//!
//! Positions are integrals of velocities, harmonic by harmonic. Taken out beforehand, they leave a matrix of little more
//! than half the size, whose factors cost a fifth.

use nalgebra::{DMatrix, DVector, Dyn, LU};

/// A position and its velocity, by their places among the states.
pub struct Integral {
    pub position: usize,
    pub velocity: usize,
}

/// A factorised Jacobian.
pub struct Factors {
    integrals: Vec<Integral>,
    /// For each term of a velocity the term of the position that it moves, and by how much.
    moves: Vec<(usize, f64)>,
    /// Rows and columns of all other states.
    kept: Vec<usize>,
    /// What each term of the velocities does to the kept rows by way of the positions.
    pull: DMatrix<f64>,
    lu: LU<f64, Dyn, Dyn>,
}

impl Factors {
    /// Of a Jacobian in which the row of each integral's position says no more than that it is one; `moves` is its inverse.
    pub fn new(mut jacobian: DMatrix<f64>, integrals: Vec<Integral>, moves: Vec<(usize, f64)>) -> Self {
        let terms = moves.len();
        let is_kept = |row: &usize| integrals.iter().all(|own| own.position != row / terms);
        let kept: Vec<usize> = (0..jacobian.nrows()).filter(is_kept).collect();
        let mut pull = DMatrix::zeros(kept.len(), integrals.len() * terms);
        for (place, integral) in integrals.iter().enumerate() {
            for (term, (moved, by)) in moves.iter().enumerate() {
                let (from, to) = (integral.position * terms + moved, integral.velocity * terms + term);
                for (k, &row) in kept.iter().enumerate() {
                    let pulled = by * jacobian[(row, from)];
                    pull[(k, place * terms + term)] = pulled;
                    jacobian[(row, to)] += pulled;
                }
            }
        }
        Self {
            lu: jacobian.select_columns(&kept).select_rows(&kept).lu(),
            integrals,
            moves,
            kept,
            pull,
        }
    }

    /// The solution for a right-hand side; `None` where the Jacobian is singular.
    pub fn solve(&self, push: &DVector<f64>) -> Option<DVector<f64>> {
        let terms = self.moves.len();
        let rows = |own: &Integral| own.position * terms..(own.position + 1) * terms;
        let of_positions: Vec<f64> = self.integrals.iter().flat_map(rows).map(|row| push[row]).collect();
        let of_positions = DVector::from_vec(of_positions);
        let solved = self
            .lu
            .solve(&(push.select_rows(&self.kept) - &self.pull * of_positions))?;
        let mut x = DVector::zeros(push.len());
        for (&row, &value) in self.kept.iter().zip(&solved) {
            x[row] = value;
        }
        for own in &self.integrals {
            for (term, (moved, by)) in self.moves.iter().enumerate() {
                let rate = push[own.position * terms + term] + x[own.velocity * terms + term];
                x[own.position * terms + moved] = by * rate;
            }
        }
        Some(x)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_solution_is_that_of_the_whole_jacobian() {
        // Two states of three terms each, the second the velocity of the first, and an inner one.
        let (omega, constant) = (3.0, 1e-3);
        let mut jacobian = DMatrix::from_fn(9, 9, |i, j| {
            ((7 * i + 3 * j) % 11) as f64 - 4.0 + f64::from(u8::from(i == j))
        });
        jacobian.rows_mut(0, 3).fill(0.0);
        jacobian[(0, 0)] = constant;
        jacobian[(1, 2)] = omega;
        jacobian[(2, 1)] = -omega;
        (0..3).for_each(|term| jacobian[(term, 3 + term)] = -1.0);
        let push = DVector::from_fn(9, |i, _| (i * i % 5) as f64 - 1.5);
        let whole = jacobian.clone().lu().solve(&push).unwrap();
        let integral = Integral {
            position: 0,
            velocity: 1,
        };
        let moves = vec![(0, 1.0 / constant), (2, 1.0 / omega), (1, -1.0 / omega)];
        let solved = Factors::new(jacobian, vec![integral], moves).solve(&push).unwrap();
        assert!((&solved - &whole).amax() < 1e-9 * whole.amax(), "{solved} {whole}");
    }
}
