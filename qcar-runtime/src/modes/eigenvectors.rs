//! Eigenvectors of a matrix whose eigenvalues are known, by inverse iteration on its narrow band.

use nalgebra::{Complex, DMatrix, DVector};

use crate::banded::Ordered;

/// A matrix in band form, for its eigenvectors.
pub(crate) struct Eigenvectors(Ordered);

impl Eigenvectors {
    /// Orders the states of a square matrix.
    pub fn of(a: &DMatrix<f64>) -> Self {
        let entry = |(at, &value): (usize, &f64)| (value != 0.0).then(|| (at % a.nrows(), at / a.nrows(), value));
        let nonzeros: Vec<_> = a.iter().enumerate().filter_map(entry).collect();
        Self(Ordered::of(a.nrows(), &nonzeros))
    }

    /// The eigenvector of the eigenvalue that is nearest to `root`; its norm is 1.
    pub fn nearest(&self, root: Complex<f64>) -> DVector<Complex<f64>> {
        const SHIFT: f64 = 1e-9;
        const STEPS: usize = 3;
        let order = self.0.order();
        let factors = self.0.less(root * (1.0 + SHIFT));
        let start = |state: &usize| Complex::new(1.0, *state as f64 / order.len() as f64);
        let mut vector = DVector::from_iterator(order.len(), order.iter().map(start));
        for _ in 0..STEPS {
            factors.solve(vector.as_mut_slice());
            vector.unscale_mut(vector.norm());
        }
        self.0.by_state(vector.as_slice())
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::DMatrix;

    use super::Eigenvectors;

    /// A matrix without structure, and one with two parts that do not act on each other.
    #[test]
    fn a_matrix_scales_its_eigenvectors() {
        let entry = |row: usize, column: usize| ((7 * row + 3 * column * column + 1) as f64).sin();
        let full = DMatrix::from_fn(24, 24, entry);
        let parts = DMatrix::from_fn(
            24,
            24,
            |row, column| {
                if row % 2 == column % 2 { entry(row, column) } else { 0.0 }
            },
        );
        for matrix in [full, parts] {
            let eigenvectors = Eigenvectors::of(&matrix);
            for root in matrix.complex_eigenvalues().iter() {
                let vector = eigenvectors.nearest(*root);
                let left = matrix.map(nalgebra::Complex::from) * &vector - &vector * *root;
                assert!((vector.norm() - 1.0).abs() < 1e-12);
                assert!(left.norm() < 1e-7 * matrix.norm(), "{root} {}", left.norm());
            }
        }
    }
}
