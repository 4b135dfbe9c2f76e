//! Eigenvectors of a matrix whose eigenvalues are known, by inverse iteration on its narrow band.

use nalgebra::{Complex, DVector};

use crate::banded::Ordered;

/// The eigenvector of the eigenvalue that is nearest to `root`; its norm is 1.
pub(crate) fn eigenvector(a: &Ordered, root: Complex<f64>) -> DVector<Complex<f64>> {
    a.by_state(iterated(a, root).as_slice())
}

/// The eigenvalue that is nearest to `root`, and the norm of the residual `A v - λ v` of its eigenvector, whose norm is
/// 1.
pub(super) fn eigenvalue(a: &Ordered, root: Complex<f64>) -> (Complex<f64>, f64) {
    let vector = iterated(a, root);
    let moved = a.times(&vector);
    let quotient = vector.dotc(&moved);
    (quotient, (moved - vector * quotient).norm())
}

/// The eigenvector in the order of the positions.
fn iterated(a: &Ordered, root: Complex<f64>) -> DVector<Complex<f64>> {
    const SHIFT: f64 = 1e-9;
    const STEPS: usize = 3;
    let order = a.order();
    let factors = a.less(root * (1.0 + SHIFT));
    let start = |state: &usize| Complex::new(1.0, *state as f64 / order.len() as f64);
    let mut vector = DVector::from_iterator(order.len(), order.iter().map(start));
    for _ in 0..STEPS {
        factors.solve(vector.as_mut_slice());
        vector.unscale_mut(vector.norm());
    }
    vector
}

#[cfg(test)]
mod tests {
    use nalgebra::{Complex, DMatrix};

    use super::{eigenvalue, eigenvector};
    use crate::banded::Ordered;

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
            let ordered = Ordered::of_dense(&matrix);
            for root in matrix.complex_eigenvalues().iter() {
                let vector = eigenvector(&ordered, *root);
                let left = matrix.map(Complex::from) * &vector - &vector * *root;
                assert!((vector.norm() - 1.0).abs() < 1e-12);
                assert!(left.norm() < 1e-7 * matrix.norm(), "{root} {}", left.norm());
                let (value, residual) = eigenvalue(&ordered, *root * (1.0 + 1e-5));
                assert!(
                    (value - root).norm() < 1e-9 && residual < 1e-9,
                    "{value} {root} {residual}"
                );
            }
        }
    }
}
