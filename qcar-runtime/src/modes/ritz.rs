//! Eigenvalues of a large matrix that are near a number, by Arnoldi's method on an inverse.

use nalgebra::{Complex, DMatrix, DVector};

use crate::banded::Ordered;
use crate::random::SplitMix;

/// Approximate eigenvalues of a matrix: those nearest to `shift` are accurate, others may be none. Complex ones come in
/// conjugate pairs.
///
/// They are the Ritz values of the inverse of the matrix less `shift` on its diagonal, after `steps` steps of Arnoldi's
/// method (Saad, "Numerical Methods for Large Eigenvalue Problems", 2nd ed., sections 6.2 and 8.1).
pub(super) fn ritz_values(a: &Ordered, shift: f64, steps: usize) -> Vec<Complex<f64>> {
    let projected = projected_inverse(a, shift, steps);
    // The Schur form of a matrix with NaN would not converge.
    if projected.iter().any(|value| !value.is_finite()) {
        return Vec::new();
    }
    let inverse = projected.complex_eigenvalues();
    inverse.iter().map(|value| value.inv() + shift).collect()
}

/// The inverse in an orthonormal basis of the Krylov space; smaller than `steps` if the space is.
fn projected_inverse(a: &Ordered, shift: f64, steps: usize) -> DMatrix<f64> {
    let factors = a.less(shift.into());
    let mut random = SplitMix::new(0);
    // A random start has a share of every eigenvector.
    let start = DVector::from_fn(a.order().len(), |_, _| random.uniform() - 0.5);
    let mut basis = vec![start.normalize()];
    let mut projected = DMatrix::zeros(steps, steps);
    for step in 0..steps {
        let mut next = basis[step].map(Complex::from);
        factors.solve(next.as_mut_slice());
        let mut next = next.map(|value| value.re);
        let whole = next.norm();
        // The second pass removes what rounding left.
        for _ in 0..2 {
            for (row, own) in basis.iter().enumerate() {
                let share = own.dot(&next);
                next.axpy(-share, own, 1.0);
                projected[(row, step)] += share;
            }
        }
        let left = next.norm();
        if left <= f64::EPSILON * whole {
            return projected.view((0, 0), (step + 1, step + 1)).into_owned();
        }
        if step + 1 < steps {
            projected[(step + 1, step)] = left;
            basis.push(next / left);
        }
    }
    projected
}
