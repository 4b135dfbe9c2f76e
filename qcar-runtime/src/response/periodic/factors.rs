//! The Jacobian of a balance, factorised.
//!
//! The equation of a linear state couples each harmonic with itself only. Linear states are eliminated first, harmonic
//! by harmonic, which leaves a small matrix of the few nonlinear states.

use std::rc::Rc;

use nalgebra::{Complex, DMatrix, DVector, Dyn, LU};

use super::product::{add, product};

/// A factorised Jacobian.
pub struct Factors {
    linear_states: Rc<LinearStates>,
    /// Effect of the linear states on the nonlinear ones.
    pull: DMatrix<f64>,
    /// Factors of the reduced matrix of the nonlinear states, which includes their effect on themselves through the
    /// linear states.
    lu: LU<f64, Dyn, Dyn>,
}

/// The linear states. They stay the same as long as the same states are nonlinear.
pub struct LinearStates {
    /// Their rows of A, and the nonlinear states.
    of: (DMatrix<f64>, Vec<usize>),
    /// Their rows of the Jacobian, harmonic by harmonic.
    rows: Vec<usize>,
    /// The rows of the nonlinear states, in the same order.
    nonlinear: Vec<usize>,
    /// Motion of the linear states under given right-hand sides.
    moves: Harmonics,
    /// Motion of the linear states with the nonlinear ones.
    follow: Harmonics,
}

/// A matrix that couples each harmonic with itself only: its blocks from harmonic 0, for rows in the order of
/// harmonics.
struct Harmonics(Vec<DMatrix<f64>>);

impl Factors {
    /// Factorises a Jacobian; `rows` are those of the nonlinear states, state by state.
    pub fn new(linear_states: Rc<LinearStates>, rows: &DMatrix<f64>) -> Self {
        let nonlinear: Vec<usize> = (0..linear_states.of.1.len()).collect();
        let rows = rows.select_rows(&rows_of(&nonlinear, linear_states.follow.0.len()));
        let pull = rows.select_columns(&linear_states.rows);
        let by_way = linear_states.follow.after(&pull);
        Self {
            lu: (rows.select_columns(&linear_states.nonlinear) + by_way).lu(),
            linear_states,
            pull,
        }
    }

    /// The solution for a right-hand side; `None` if the Jacobian is singular.
    pub fn solve(&self, push: &DVector<f64>) -> Option<DVector<f64>> {
        let solved = self.solve_all(&DMatrix::from_column_slice(push.len(), 1, push.as_slice()))?;
        Some(solved.column(0).into_owned())
    }

    /// The same for several right-hand sides, one in each column.
    pub fn solve_all(&self, pushes: &DMatrix<f64>) -> Option<DMatrix<f64>> {
        let mut linear_states = self
            .linear_states
            .moves
            .of(&pushes.select_rows(&self.linear_states.rows));
        let mut nonlinear = pushes.select_rows(&self.linear_states.nonlinear);
        nonlinear -= product(&self.pull, &linear_states);
        let is_solved = nonlinear.is_empty() || self.lu.solve_mut(&mut nonlinear);
        is_solved.then_some(())?;
        linear_states += self.linear_states.follow.of(&nonlinear);
        let mut x = DMatrix::zeros(pushes.nrows(), pushes.ncols());
        for (rows, found) in [
            (&self.linear_states.rows, linear_states),
            (&self.linear_states.nonlinear, nonlinear),
        ] {
            for (mut x, found) in x.column_iter_mut().zip(found.column_iter()) {
                for (&row, &value) in rows.iter().zip(found.as_slice()) {
                    x[row] = value;
                }
            }
        }
        Some(x)
    }
}

impl LinearStates {
    /// The linear states, whose rows of the Jacobian are `jnω - A`. `a` has their rows of A, `turns` are `jnω` for each
    /// harmonic from 0, and `nonlinear` are the other, nonlinear states. `None` if the matrix of a harmonic is
    /// singular.
    pub fn new(a: DMatrix<f64>, turns: &[Complex<f64>], nonlinear: Vec<usize>) -> Option<Self> {
        let own: Vec<usize> = (0..a.ncols()).filter(|state| !nonlinear.contains(state)).collect();
        let resolvent = Resolvent::new(&a.select_columns(&own));
        let compliance: Vec<_> = turns.iter().map(|&turn| resolvent.at(turn)).collect::<Option<_>>()?;
        let pushes = a.select_columns(&nonlinear).map(Complex::from);
        let following: Vec<_> = compliance.iter().map(|compliance| compliance * &pushes).collect();
        Some(LinearStates {
            rows: rows_of(&own, turns.len()),
            nonlinear: rows_of(&nonlinear, turns.len()),
            moves: Harmonics::new(&compliance),
            follow: Harmonics::new(&following),
            of: (a, nonlinear),
        })
    }

    /// True if these rows and nonlinear states are its own.
    pub fn is_of(&self, a: &DMatrix<f64>, nonlinear: &[usize]) -> bool {
        (&self.of.0, &self.of.1[..]) == (a, nonlinear)
    }
}

/// The inverses of `s - A` for one matrix A. About half of the states are positions, whose rows have a single nonzero.
/// They are eliminated first, which leaves a matrix of half the size.
struct Resolvent {
    positions: Vec<usize>,
    others: Vec<usize>,
    /// Part of A with the rows of the positions and the columns of the other states.
    follow: DMatrix<Complex<f64>>,
    /// Part with the rows of the other states and the columns of the positions.
    by_positions: DMatrix<Complex<f64>>,
    /// Part with the rows and columns of the other states.
    by_others: DMatrix<Complex<f64>>,
    /// Product of `by_positions` and `follow`.
    through: DMatrix<Complex<f64>>,
}

impl Resolvent {
    fn new(a: &DMatrix<f64>) -> Self {
        let nonzeros = |row: usize| (0..a.ncols()).filter(move |&column| a[(row, column)] != 0.0);
        let is_single = |row: usize| nonzeros(row).nth(1).is_none();
        let is_position = |&row: &usize| is_single(row) && nonzeros(row).all(|column| !is_single(column));
        let (positions, others): (Vec<usize>, Vec<usize>) = (0..a.nrows()).partition(is_position);
        let part = |rows: &[usize], columns: &[usize]| {
            DMatrix::from_fn(rows.len(), columns.len(), |row, column| {
                Complex::from(a[(rows[row], columns[column])])
            })
        };
        let (follow, by_positions) = (part(&positions, &others), part(&others, &positions));
        Self {
            by_others: part(&others, &others),
            through: &by_positions * &follow,
            follow,
            by_positions,
            positions,
            others,
        }
    }

    /// The inverse at `s`, which is not zero; `None` if the matrix is singular.
    fn at(&self, s: Complex<f64>) -> Option<DMatrix<Complex<f64>>> {
        let (m, n) = (self.positions.len(), self.others.len());
        let over_s = s.inv();
        let reduced = DMatrix::from_diagonal_element(n, n, s) - &self.by_others - &self.through * over_s;
        let of_others = reduced.lu().try_inverse()?;
        let by_positions = &of_others * &self.by_positions * over_s;
        let follow = &self.follow * &of_others * over_s;
        let of_positions = (DMatrix::identity(m, m) + &self.follow * &by_positions) * over_s;
        let mut inverse = DMatrix::zeros(m + n, m + n);
        for (rows, columns, part) in [
            (&self.others, &self.others, of_others),
            (&self.others, &self.positions, by_positions),
            (&self.positions, &self.others, follow),
            (&self.positions, &self.positions, of_positions),
        ] {
            for (place, &column) in columns.iter().enumerate() {
                for (own, &row) in rows.iter().enumerate() {
                    inverse[(row, column)] = part[(own, place)];
                }
            }
        }
        Some(inverse)
    }
}

impl Harmonics {
    /// From the matrix of the complex amplitudes of each harmonic from 0.
    fn new(amplitudes: &[DMatrix<Complex<f64>>]) -> Self {
        // The amplitude of a cos + b sin is a - jb.
        let block = |matrix: &DMatrix<Complex<f64>>| {
            DMatrix::from_fn(2 * matrix.nrows(), 2 * matrix.ncols(), |row, column| {
                let value = matrix[(row / 2, column / 2)];
                match (row % 2, column % 2) {
                    (1, 0) => -value.im,
                    (0, 1) => value.im,
                    _ => value.re,
                }
            })
        };
        let constant = std::iter::once(amplitudes[0].map(|value| value.re));
        Self(constant.chain(amplitudes[1..].iter().map(block)).collect())
    }

    /// Its product with a matrix on its right.
    fn of(&self, other: &DMatrix<f64>) -> DMatrix<f64> {
        let mut product = DMatrix::zeros(self.0.iter().map(DMatrix::nrows).sum(), other.ncols());
        for (mut into, factors) in product.column_iter_mut().zip(other.column_iter()) {
            let (mut into, mut factors) = (into.as_mut_slice(), factors.as_slice());
            for block in &self.0 {
                add(
                    block.as_slice(),
                    factors.split_off(..block.ncols()).unwrap_or_default(),
                    into.split_off_mut(..block.nrows()).unwrap_or_default(),
                );
            }
        }
        product
    }

    /// Its product with a matrix on its left.
    fn after(&self, other: &DMatrix<f64>) -> DMatrix<f64> {
        let rows = other.nrows();
        let mut product = DMatrix::zeros(rows, self.0.iter().map(DMatrix::ncols).sum());
        let mut others = other.as_slice();
        let mut into = product.column_iter_mut();
        for block in &self.0 {
            let columns = others.split_off(..rows * block.nrows()).unwrap_or_default();
            for (factors, mut into) in block.column_iter().zip(&mut into) {
                add(columns, factors.as_slice(), into.as_mut_slice());
            }
        }
        product
    }
}

/// The rows of some states, harmonic by harmonic.
fn rows_of(states: &[usize], harmonics: usize) -> Vec<usize> {
    let terms = 2 * harmonics - 1;
    let of = |harmonic: usize| {
        let terms_of = (2 * harmonic).saturating_sub(1)..=2 * harmonic;
        states
            .iter()
            .flat_map(move |state| terms_of.clone().map(move |term| state * terms + term))
    };
    (0..harmonics).flat_map(of).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_solution_is_that_of_the_whole_jacobian() {
        // Three states of five terms each, some of them linear.
        for own in [vec![0, 2], vec![1], vec![0], vec![0, 1]] {
            let (omega, constant) = (3.0, 1e-3);
            let nonlinear_states: Vec<usize> = (0..3).filter(|state| !own.contains(state)).collect();
            let a = DMatrix::from_row_slice(3, 3, &[-0.5, 2.0, 1.0, 0.9, -1.1, 0.4, -4.0, 0.7, 0.3]);
            let nonlinear = DMatrix::from_fn(5 * nonlinear_states.len(), 15, |i, j| {
                ((7 * i + 3 * j) % 11) as f64 - 4.5
            });
            let mut whole = DMatrix::zeros(15, 15);
            for (&row, column) in own.iter().flat_map(|row| (0..3).map(move |column| (row, column))) {
                let block = DMatrix::from_diagonal_element(5, 5, -a[(row, column)]);
                whole.view_mut((5 * row, 5 * column), (5, 5)).copy_from(&block);
            }
            for state in own.iter().map(|state| 5 * state) {
                whole[(state, state)] += constant;
                for (harmonic, cosine) in [(1.0, state + 1), (2.0, state + 3)] {
                    whole[(cosine, cosine + 1)] += omega * harmonic;
                    whole[(cosine + 1, cosine)] -= omega * harmonic;
                }
            }
            for (place, state) in nonlinear_states.iter().enumerate() {
                whole.rows_mut(5 * state, 5).copy_from(&nonlinear.rows(5 * place, 5));
            }
            let push = DVector::from_fn(15, |i, _| (i * i % 5) as f64 - 1.5);
            let expected = whole.lu().solve(&push).unwrap();
            let turns = [
                Complex::from(constant),
                Complex::new(0.0, omega),
                Complex::new(0.0, 2.0 * omega),
            ];
            let linear_states = LinearStates::new(a.select_rows(&own), &turns, nonlinear_states).unwrap();
            let solved = Factors::new(Rc::new(linear_states), &nonlinear).solve(&push).unwrap();
            assert!(
                (&solved - &expected).amax() < 1e-9 * expected.amax(),
                "{solved} {expected}"
            );
        }
    }

    #[test]
    fn a_resolvent_is_the_inverse_of_the_whole_matrix() {
        // Two oscillators that are coupled, a position without a velocity among the states, and an inner state.
        let a = DMatrix::from_row_slice(
            6,
            6,
            &[
                0.0, 1.0, 0.0, 0.0, 0.0, 0.0, //
                -9.0, -0.4, 3.0, 0.1, 0.0, 2.0, //
                0.0, 0.0, 0.0, 1.0, 0.0, 0.0, //
                2.0, 0.3, -7.0, -0.2, 1.5, 0.0, //
                0.0, 0.0, 0.0, 0.0, 0.0, 0.0, //
                0.0, 4.0, 0.0, 0.0, 0.0, -5.0,
            ],
        );
        let resolvent = Resolvent::new(&a);
        assert_eq!(resolvent.positions, [0, 2, 4]);
        for s in [Complex::from(1e-3), Complex::new(0.0, 2.7)] {
            let whole = DMatrix::from_diagonal_element(6, 6, s) - a.map(Complex::from);
            let error = resolvent.at(s).unwrap() * whole - DMatrix::<Complex<f64>>::identity(6, 6);
            assert!(error.iter().all(|entry| entry.norm() < 1e-11), "{error}");
        }
    }
}
