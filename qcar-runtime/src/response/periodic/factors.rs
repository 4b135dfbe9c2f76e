//! The Jacobian of a balance, factorised.
//!
//! A state whose law is linear ties each harmonic to itself alone. Such states are taken out beforehand, harmonic by
//! harmonic, and leave a small matrix of the few states whose law bends.

use std::rc::Rc;

use nalgebra::{Complex, DMatrix, DVector, Dyn, LU};

use super::product::product;

/// A factorised Jacobian.
pub struct Factors {
    straight: Rc<Straight>,
    /// The places among the rows of the straight states of those that the bent ones see.
    seen: Vec<usize>,
    /// What they do to the bent ones.
    pull: DMatrix<f64>,
    /// Of what is left: the bent states, and what they do to themselves by way of the straight ones.
    lu: LU<f64, Dyn, Dyn>,
}

/// The states whose law is linear. They are the same wherever the same states are bent.
pub struct Straight {
    /// Their rows of A, and the states that are bent.
    of: (DMatrix<f64>, Vec<usize>),
    /// Their rows of the Jacobian.
    rows: Vec<usize>,
    /// The rows of the bent states.
    bent: Vec<usize>,
    /// How pushes on them move them.
    moves: DMatrix<f64>,
    /// How they move with the bent states.
    follow: DMatrix<f64>,
}

impl Factors {
    /// Of a Jacobian in which the bent states have these `rows`.
    pub fn new(straight: Rc<Straight>, rows: &DMatrix<f64>) -> Self {
        let pull = rows.select_columns(&straight.rows);
        let is_seen = |&place: &usize| pull.column(place).iter().any(|&by| by != 0.0);
        let seen: Vec<usize> = (0..pull.ncols()).filter(is_seen).collect();
        let pull = pull.select_columns(&seen);
        let by_way = product(&pull, &straight.follow.select_rows(&seen));
        Self {
            lu: (rows.select_columns(&straight.bent) + by_way).lu(),
            straight,
            seen,
            pull,
        }
    }

    /// The solution for a right-hand side; `None` where the Jacobian is singular.
    pub fn solve(&self, push: &DVector<f64>) -> Option<DVector<f64>> {
        let solved = self.solve_all(&DMatrix::from_column_slice(push.len(), 1, push.as_slice()))?;
        Some(solved.column(0).into_owned())
    }

    /// The same for many, a column each.
    pub fn solve_all(&self, pushes: &DMatrix<f64>) -> Option<DMatrix<f64>> {
        let mut straight = product(&self.straight.moves, &pushes.select_rows(&self.straight.rows));
        let mut bent = pushes.select_rows(&self.straight.bent);
        bent -= product(&self.pull, &straight.select_rows(&self.seen));
        let is_solved = bent.is_empty() || self.lu.solve_mut(&mut bent);
        is_solved.then_some(())?;
        straight += product(&self.straight.follow, &bent);
        let mut x = DMatrix::zeros(pushes.nrows(), pushes.ncols());
        for (mut x, (straight, bent)) in x.column_iter_mut().zip(straight.column_iter().zip(bent.column_iter())) {
            let rows = self.straight.rows.iter().chain(&self.straight.bent);
            for (&row, &value) in rows.zip(straight.iter().chain(&bent)) {
                x[row] = value;
            }
        }
        Some(x)
    }
}

impl Straight {
    /// Of states whose rows of the Jacobian are `jnω - A`, of which `a` has the rows; `turns` are `jnω` for each harmonic
    /// from 0, and `bent` are all other states. `None` where a harmonic is singular.
    pub fn new(a: DMatrix<f64>, turns: &[Complex<f64>], bent: Vec<usize>) -> Option<Self> {
        let terms = 2 * turns.len() - 1;
        let own: Vec<usize> = (0..a.ncols()).filter(|state| !bent.contains(state)).collect();
        let (among, pushes) = (a.select_columns(&own), a.select_columns(&bent));
        let inverse = |&turn: &Complex<f64>| {
            let stiffness = DMatrix::from_diagonal_element(own.len(), own.len(), turn) - among.map(Complex::from);
            stiffness.lu().try_inverse()
        };
        let compliance: Vec<_> = turns.iter().map(inverse).collect::<Option<_>>()?;
        let pushes = pushes.map(Complex::from);
        let following: Vec<_> = compliance.iter().map(|compliance| compliance * &pushes).collect();
        Some(Straight {
            rows: rows_of(&own, terms),
            bent: rows_of(&bent, terms),
            moves: on_terms(&compliance),
            follow: on_terms(&following),
            of: (a, bent),
        })
    }

    /// True where these are the states of such rows.
    pub fn is_of(&self, a: &DMatrix<f64>, bent: &[usize]) -> bool {
        (&self.of.0, &self.of.1[..]) == (a, bent)
    }
}

/// A matrix for the amplitudes of each harmonic from 0, as one for the terms of all.
fn on_terms(harmonics: &[DMatrix<Complex<f64>>]) -> DMatrix<f64> {
    let terms = 2 * harmonics.len() - 1;
    let (rows, columns) = harmonics[0].shape();
    let mut all = DMatrix::zeros(rows * terms, columns * terms);
    for (harmonic, matrix) in harmonics.iter().enumerate() {
        for (row, column) in (0..rows).flat_map(|row| (0..columns).map(move |column| (row, column))) {
            let value = matrix[(row, column)];
            if harmonic == 0 {
                all[(row * terms, column * terms)] = value.re;
                continue;
            }
            // The amplitude of a cos + b sin is a - jb.
            let first = 2 * harmonic - 1;
            let mut pair = all.view_mut((row * terms + first, column * terms + first), (2, 2));
            pair.copy_from_slice(&[value.re, -value.im, value.im, value.re]);
        }
    }
    all
}

/// The rows of some states.
fn rows_of(states: &[usize], terms: usize) -> Vec<usize> {
    let rows = states.iter().flat_map(|state| state * terms..(state + 1) * terms);
    rows.collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_solution_is_that_of_the_whole_jacobian() {
        // Three states of five terms each, the middle one bent.
        let (omega, constant) = (3.0, 1e-3);
        let a = DMatrix::from_row_slice(3, 3, &[-0.5, 2.0, 1.0, 9.0, 9.0, 9.0, -4.0, 0.7, 0.3]);
        let bent = DMatrix::from_fn(5, 15, |i, j| ((7 * i + 3 * j) % 11) as f64 - 4.5);
        let mut whole = DMatrix::zeros(15, 15);
        for (row, column) in [(0, 0), (0, 1), (0, 2), (2, 0), (2, 1), (2, 2)] {
            let block = DMatrix::from_diagonal_element(5, 5, -a[(row, column)]);
            whole.view_mut((5 * row, 5 * column), (5, 5)).copy_from(&block);
        }
        for first in [0, 10] {
            whole[(first, first)] += constant;
            for (harmonic, cosine) in [(1.0, first + 1), (2.0, first + 3)] {
                whole[(cosine, cosine + 1)] += omega * harmonic;
                whole[(cosine + 1, cosine)] -= omega * harmonic;
            }
        }
        whole.rows_mut(5, 5).copy_from(&bent);
        let push = DVector::from_fn(15, |i, _| (i * i % 5) as f64 - 1.5);
        let expected = whole.lu().solve(&push).unwrap();
        let turns = [
            Complex::from(constant),
            Complex::new(0.0, omega),
            Complex::new(0.0, 2.0 * omega),
        ];
        let straight = Straight::new(a.select_rows(&[0, 2]), &turns, vec![1]).unwrap();
        let solved = Factors::new(Rc::new(straight), &bent).solve(&push).unwrap();
        assert!(
            (&solved - &expected).amax() < 1e-9 * expected.amax(),
            "{solved} {expected}"
        );
    }
}
