//! Linear least squares over the lines of a spectrum.

use nalgebra::linalg::SVD;
use nalgebra::{Complex, DMatrix, DVector};

/// Columns of a matrix, with an orthonormal basis of what they span that grows with them: responses to the same
/// excitation share their first columns.
pub(super) struct Regressors {
    columns: Vec<DVector<Complex<f64>>>,
    /// Lengths of the columns.
    lengths: Vec<f64>,
    /// Orthonormal; each is a combination of the columns so far.
    basis: Vec<DVector<Complex<f64>>>,
    /// For each vector of the basis its combination of columns of unit length: the inverse of the factor R.
    combinations: Vec<DVector<Complex<f64>>>,
}

impl Regressors {
    /// Singular values of the columns of unit length below which these count as dependent.
    const SAME: f64 = 1e-10;

    /// With these columns, of one length.
    pub fn new(columns: impl IntoIterator<Item = DVector<Complex<f64>>>) -> Self {
        let mut empty = Self {
            columns: Vec::new(),
            lengths: Vec::new(),
            basis: Vec::new(),
            combinations: Vec::new(),
        };
        columns.into_iter().for_each(|column| empty.push(column));
        empty
    }

    /// Adds a column.
    pub fn push(&mut self, column: DVector<Complex<f64>>) {
        let length = column.norm().max(f64::MIN_POSITIVE);
        let mut rest = column.unscale(length);
        let mut combination = DVector::zeros(self.columns.len() + 1);
        combination[self.columns.len()] = Complex::ONE;
        // What rounding leaves of the other vectors after the first pass is removed by a second one (L. Giraud et al.,
        // Numer. Math. 101, 2005).
        for _ in 0..2 {
            for (other, own) in self.basis.iter().zip(&self.combinations) {
                let share = other.dotc(&rest);
                rest.axpy(-share, other, Complex::ONE);
                combination.rows_mut(0, own.len()).axpy(-share, own, Complex::ONE);
            }
        }
        let left = rest.norm().max(f64::MIN_POSITIVE);
        self.columns.push(column);
        self.lengths.push(length);
        self.basis.push(rest.unscale(left));
        self.combinations.push(combination.unscale(left));
    }

    /// Removes the last column.
    pub fn pop(&mut self) {
        self.columns.pop();
        self.lengths.pop();
        self.basis.pop();
        self.combinations.pop();
    }

    /// The weights of a response's lines in its coefficient of each column: the rows of the pseudo-inverse, conjugate.
    ///
    /// Uses columns of unit length. Dependent columns share the part that they explain. NaN if the columns are not
    /// finite, as in a diverged simulation.
    pub fn weights(&self) -> Vec<DVector<Complex<f64>>> {
        // The inverse of this norm is at most the smallest singular value.
        let norm = self.combinations.iter().map(DVector::norm_squared).sum::<f64>().sqrt();
        let independent = norm * Self::SAME < 1.0;
        let unit = if independent {
            self.inverse()
        } else {
            self.pseudo_inverse()
        };
        let scaled = unit.into_iter().zip(&self.lengths);
        scaled.map(|(weights, length)| weights.unscale(*length)).collect()
    }

    fn inverse(&self) -> Vec<DVector<Complex<f64>>> {
        let row = |unknown: usize| {
            let mut row = DVector::zeros(self.columns[0].len());
            for (vector, combination) in self.basis.iter().zip(&self.combinations).skip(unknown) {
                row.axpy(combination[unknown].conj(), vector, Complex::ONE);
            }
            row
        };
        (0..self.columns.len()).map(row).collect()
    }

    fn pseudo_inverse(&self) -> Vec<DVector<Complex<f64>>> {
        const MOST_ITERATIONS: usize = 10_000;
        let unit = self
            .columns
            .iter()
            .zip(&self.lengths)
            .map(|(column, length)| column.unscale(*length));
        let unit = DMatrix::from_columns(&unit.collect::<Vec<_>>());
        // The search for the singular values of a matrix that is not finite would not end.
        let inverse = unit.iter().all(|entry| entry.is_finite()).then(|| {
            let parts = SVD::try_new_unordered(unit.clone(), true, true, 5.0 * f64::EPSILON, MOST_ITERATIONS)?;
            parts.pseudo_inverse(Self::SAME).ok()
        });
        let inverse = inverse
            .flatten()
            .unwrap_or_else(|| unit.map(|_| Complex::from(f64::NAN)).transpose());
        inverse.row_iter().map(|row| row.adjoint()).collect()
    }

    /// The coefficients of the columns in a response, given their weights, and what they leave of it.
    pub fn solve(
        &self,
        weights: &[DVector<Complex<f64>>],
        response: &DVector<Complex<f64>>,
    ) -> (Vec<Complex<f64>>, DVector<Complex<f64>>) {
        let solution: Vec<_> = weights.iter().map(|weights| weights.dotc(response)).collect();
        let mut residual = response.clone();
        for (column, coefficient) in self.columns.iter().zip(&solution) {
            residual.axpy(-coefficient, column, Complex::ONE);
        }
        (solution, residual)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_not_a_number_has_no_inverse_and_the_search_for_it_ends() {
        for wrong in [f64::NAN, f64::INFINITY] {
            let entry = |row: usize, column: usize| Complex::from(if row == column { wrong } else { 1.0 });
            let column = |column: usize| DVector::from_fn(6, |row, _| entry(row, column));
            let weights = Regressors::new((0..3).map(column)).weights();
            assert!(weights.iter().flatten().all(|entry| entry.re.is_nan()));
        }
    }

    /// The conditions of Penrose. The last column depends on the first two but for a part of the size `apart`.
    #[test]
    fn the_weights_are_the_rows_of_the_pseudo_inverse() {
        let entry = |row: usize, column: usize| {
            Complex::new((1.0 + (row * 7 + column * 3) as f64).sin(), (row * column) as f64)
        };
        for apart in [1.0, 1e-3, 1e-6, 0.0] {
            let matrix = DMatrix::from_fn(9, 3, |row, column| match column {
                0 | 1 => entry(row, column),
                _ => entry(row, 0) - entry(row, 1) * 2.0 + entry(row, 5) * apart,
            });
            let columns: Vec<_> = matrix.column_iter().map(|column| column.into_owned()).collect();
            // Of columns of unit length.
            let unit = DMatrix::from_columns(&columns.iter().map(DVector::normalize).collect::<Vec<_>>());
            let weights = Regressors::new(columns.clone()).weights().into_iter().zip(&columns);
            let rows: Vec<_> = weights
                .map(|(own, column)| own.adjoint().scale(column.norm()))
                .collect();
            let inverse = DMatrix::from_rows(&rows);
            let (across, along) = (&unit * &inverse, &inverse * &unit);
            // Each entry rounds, and the condition magnifies that.
            let allowed = unit.len() as f64 * f64::EPSILON * unit.norm() * inverse.norm();
            for (name, left, right) in [
                ("A W A", &across * &unit, unit.clone()),
                ("W A W", &along * &inverse, inverse.clone()),
                ("A W", across.adjoint(), across.clone()),
                ("W A", along.adjoint(), along.clone()),
            ] {
                let error = (left - &right).norm() / right.norm();
                assert!(error < allowed, "{name}, {apart}: {error}, more than {allowed}");
            }
        }
    }
}
