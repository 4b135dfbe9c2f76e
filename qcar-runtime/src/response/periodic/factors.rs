//! The Jacobian of a balance, factorised.
//!
//! A state whose law is linear ties each harmonic to itself alone. Such states are taken out beforehand, harmonic by
//! harmonic, and leave a small matrix of the few states whose law bends.

use nalgebra::{Complex, DMatrix, DVector, Dyn, LU};

/// A factorised Jacobian.
pub struct Factors {
    straight: Straight,
    /// Rows of the states whose law bends.
    bent: Vec<usize>,
    /// How the straight states move with the bent ones.
    follow: DMatrix<f64>,
    /// The places among the rows of the straight states of those that the bent ones see.
    seen: Vec<usize>,
    /// What they do to the bent ones.
    pull: DMatrix<f64>,
    /// Of what is left: the bent states, and what they do to themselves by way of the straight ones.
    lu: LU<f64, Dyn, Dyn>,
}

/// The states whose law is linear.
struct Straight {
    /// Their rows.
    rows: Vec<usize>,
    /// For each harmonic how a push on each moves them all: the inverse of `jnω - A`.
    compliance: Vec<DMatrix<Complex<f64>>>,
}

impl Factors {
    /// Of a Jacobian whose states have `jnω - A` on their rows, `turns` being `jnω` for each harmonic from 0, but for
    /// the states `bent`, whose rows are given. `None` where a harmonic of the others is singular.
    pub fn new(a: &DMatrix<f64>, turns: &[Complex<f64>], bent: &[usize], rows: &DMatrix<f64>) -> Option<Self> {
        let terms = 2 * turns.len() - 1;
        let others: Vec<usize> = (0..a.nrows()).filter(|state| !bent.contains(state)).collect();
        let straight = Straight {
            rows: rows_of(&others, terms),
            compliance: compliance(a.select_rows(&others).select_columns(&others), turns)?,
        };
        let follow = straight.follow(a.select_rows(&others).select_columns(bent));
        let bent = rows_of(bent, terms);
        let pull = rows.select_columns(&straight.rows);
        let seen: Vec<usize> = (0..pull.ncols())
            .filter(|&k| pull.column(k).iter().any(|&by| by != 0.0))
            .collect();
        let pull = pull.select_columns(&seen);
        Some(Self {
            lu: (rows.select_columns(&bent) + &pull * follow.select_rows(&seen)).lu(),
            straight,
            bent,
            follow,
            seen,
            pull,
        })
    }

    /// The solution for a right-hand side; `None` where the Jacobian is singular.
    pub fn solve(&self, push: &DVector<f64>) -> Option<DVector<f64>> {
        let solved = self.solve_all(&DMatrix::from_column_slice(push.len(), 1, push.as_slice()))?;
        Some(solved.column(0).into_owned())
    }

    /// The same for many, a column each.
    pub fn solve_all(&self, pushes: &DMatrix<f64>) -> Option<DMatrix<f64>> {
        let mut straight = self.straight.moved_by(&pushes.select_rows(&self.straight.rows));
        let mut bent = pushes.select_rows(&self.bent) - &self.pull * straight.select_rows(&self.seen);
        let is_solved = bent.is_empty() || self.lu.solve_mut(&mut bent);
        is_solved.then_some(())?;
        straight += &self.follow * &bent;
        let mut x = DMatrix::zeros(pushes.nrows(), pushes.ncols());
        for (mut x, (straight, bent)) in x.column_iter_mut().zip(straight.column_iter().zip(bent.column_iter())) {
            let rows = self.straight.rows.iter().chain(&self.bent);
            for (&row, &value) in rows.zip(straight.iter().chain(&bent)) {
                x[row] = value;
            }
        }
        Some(x)
    }
}

impl Straight {
    /// For each harmonic the places of its cosine and its sine, which the constant has not, and its compliance.
    fn harmonics(&self) -> impl Iterator<Item = (usize, Option<usize>, &DMatrix<Complex<f64>>)> {
        let harmonics = self.compliance.iter().enumerate();
        harmonics.map(|(harmonic, compliance)| match harmonic {
            0 => (0, None, compliance),
            _ => (2 * harmonic - 1, Some(2 * harmonic), compliance),
        })
    }

    /// How pushes on them move them, a column for each.
    fn moved_by(&self, pushes: &DMatrix<f64>) -> DMatrix<f64> {
        let terms = 2 * self.compliance.len() - 1;
        let states = pushes.nrows() / terms;
        let mut all = DMatrix::zeros(pushes.nrows(), pushes.ncols());
        for (cosine, sine, compliance) in self.harmonics() {
            let amplitude = |state: usize, column: usize| {
                let at = |term| pushes[(state * terms + term, column)];
                Complex::new(at(cosine), sine.map_or(0.0, |sine| -at(sine)))
            };
            let moved = compliance * DMatrix::from_fn(states, pushes.ncols(), amplitude);
            for (mut all, moved) in all.column_iter_mut().zip(moved.column_iter()) {
                for (state, moved) in moved.iter().enumerate() {
                    all[state * terms + cosine] = moved.re;
                    if let Some(sine) = sine {
                        all[state * terms + sine] = -moved.im;
                    }
                }
            }
        }
        all
    }

    /// How they move with each term of the bent states, which push them by a column each.
    fn follow(&self, pushes: DMatrix<f64>) -> DMatrix<f64> {
        let terms = 2 * self.compliance.len() - 1;
        let pushes = pushes.map(Complex::from);
        let mut follow = DMatrix::zeros(self.rows.len(), pushes.ncols() * terms);
        for (cosine, sine, compliance) in self.harmonics() {
            let moved = compliance * &pushes;
            for (place, moved) in moved.iter().enumerate() {
                let (row, column) = (place % pushes.nrows() * terms, place / pushes.nrows() * terms);
                follow[(row + cosine, column + cosine)] = moved.re;
                if let Some(sine) = sine {
                    follow[(row + sine, column + cosine)] = -moved.im;
                    follow[(row + cosine, column + sine)] = moved.im;
                    follow[(row + sine, column + sine)] = moved.re;
                }
            }
        }
        follow
    }
}

/// The inverse of `turn - A` for each turn, if there is one.
fn compliance(a: DMatrix<f64>, turns: &[Complex<f64>]) -> Option<Vec<DMatrix<Complex<f64>>>> {
    let a = a.map(Complex::from);
    let inverse = |&turn| {
        (DMatrix::from_diagonal_element(a.nrows(), a.nrows(), turn) - &a)
            .lu()
            .try_inverse()
    };
    turns.iter().map(inverse).collect()
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
        let solved = Factors::new(&a, &turns, &[1], &bent).unwrap().solve(&push).unwrap();
        assert!(
            (&solved - &expected).amax() < 1e-9 * expected.amax(),
            "{solved} {expected}"
        );
    }
}
