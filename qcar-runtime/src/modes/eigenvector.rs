//! Eigenvectors of a matrix whose eigenvalues are known, by inverse iteration on its narrow band.

use nalgebra::{Complex, DVector};

use crate::banded::{Factors, Ordered};
use crate::random::SplitMix;

/// Relative difference up to which eigenvalues count as equal: rounding separates those that are.
const EQUAL: f64 = 1e-8;

/// Largest residual `|A v - λ v|` of an eigenvector `v` with the norm 1, relative to `|λ|`. That of a vector which is no
/// eigenvector, of an eigenvalue that the matrix has more often than eigenvectors, is near 1.
const LEFT: f64 = 1e-6;

/// An eigenvector of each of these eigenvalues. Those of equal eigenvalues are linearly independent, and each of them
/// is zero where it can be, so that parts which do not act on each other move one at a time.
pub(crate) fn eigenvectors(a: &Ordered, roots: &[Complex<f64>]) -> Vec<DVector<Complex<f64>>> {
    let mut vectors: Vec<Option<DVector<Complex<f64>>>> = vec![None; roots.len()];
    for (place, root) in roots.iter().enumerate() {
        if vectors[place].is_some() {
            continue;
        }
        let is_equal = |other: &usize| vectors[*other].is_none() && are_equal(roots[*other], *root);
        let equal: Vec<usize> = (place..roots.len()).filter(is_equal).collect();
        let alone = || equal.iter().map(|&other| eigenvector(a, roots[other])).collect();
        let own = if equal.len() > 1 {
            independent(a, *root, equal.len()).unwrap_or_else(alone)
        } else {
            alone()
        };
        equal
            .iter()
            .zip(own)
            .for_each(|(&other, vector)| vectors[other] = Some(vector));
    }
    vectors.into_iter().flatten().collect()
}

/// True if two eigenvalues differ by no more than rounding.
pub(crate) fn are_equal(one: Complex<f64>, other: Complex<f64>) -> bool {
    (one - other).norm() <= EQUAL * one.norm()
}

/// Linearly independent eigenvectors of an eigenvalue that the matrix has `count` times, in the order of the states that
/// move most in them; `None` if there are fewer, as for a mode with critical damping.
fn independent(a: &Ordered, root: Complex<f64>, count: usize) -> Option<Vec<DVector<Complex<f64>>>> {
    let factors = shifted(a, root);
    let mut basis: Vec<DVector<Complex<f64>>> = Vec::new();
    for number in 0..count {
        let mut random = SplitMix::new(number as u64);
        // A random start has a share of every eigenvector.
        let start = DVector::from_fn(a.order().len(), |_, _| (random.uniform() - 0.5).into());
        basis.push(converged(&factors, start, &basis));
    }
    let is_eigenvector = |vector: &DVector<Complex<f64>>| {
        let left = a.times(vector) - vector * root;
        left.norm() <= LEFT * root.norm()
    };
    if !basis.iter().all(is_eigenvector) {
        return None;
    }
    let basis = basis.iter().map(|vector| a.by_state(vector.as_slice())).collect();
    Some(one_at_a_time(basis))
}

/// Vectors that span the same space, each of which is zero in the states that lead the others (Gauss and Jordan's
/// elimination), in the order of these states.
fn one_at_a_time(mut basis: Vec<DVector<Complex<f64>>>) -> Vec<DVector<Complex<f64>>> {
    let mut leading = Vec::new();
    for own in 0..basis.len() {
        let lead = basis[own].icamax();
        leading.push(lead);
        let pivot = &basis[own] / basis[own][lead];
        for (_, other) in basis.iter_mut().enumerate().filter(|(other, _)| *other != own) {
            let share = other[lead];
            other.axpy(-share, &pivot, Complex::ONE);
            other[lead] = Complex::ZERO;
        }
        basis[own] = pivot;
    }
    let mut ordered: Vec<_> = leading.into_iter().zip(basis).collect();
    ordered.sort_by_key(|(lead, _)| *lead);
    ordered
        .into_iter()
        .map(|(_, vector)| vector.unscale(vector.norm()))
        .collect()
}

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
    let order = a.order();
    let start = |state: &usize| Complex::new(1.0, *state as f64 / order.len() as f64);
    let start = DVector::from_iterator(order.len(), order.iter().map(start));
    converged(&shifted(a, root), start, &[])
}

/// The factors of the matrix less a number next to the eigenvalue, at which it is singular.
fn shifted(a: &Ordered, root: Complex<f64>) -> Factors {
    const SHIFT: f64 = 1e-9;
    a.less(root * (1.0 + SHIFT))
}

/// The eigenvector to which the inverse iteration leads from `start`, orthogonal to the vectors of `known`.
fn converged(
    factors: &Factors,
    start: DVector<Complex<f64>>,
    known: &[DVector<Complex<f64>>],
) -> DVector<Complex<f64>> {
    const STEPS: usize = 3;
    let mut vector = start;
    for _ in 0..STEPS {
        factors.solve(vector.as_mut_slice());
        for other in known {
            let share = other.dotc(&vector);
            vector.axpy(-share, other, Complex::ONE);
        }
        vector.unscale_mut(vector.norm());
    }
    vector
}

#[cfg(test)]
mod tests {
    use nalgebra::{Complex, DMatrix};

    use super::{eigenvalue, eigenvector, eigenvectors};
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

    /// Two equal oscillators beside a third one that is coupled to neither, with the states of each apart.
    #[test]
    fn equal_eigenvalues_have_independent_eigenvectors() {
        let rate: f64 = 63.0;
        let mut matrix = DMatrix::zeros(6, 6);
        for (oscillator, square) in [rate * rate, rate * rate, 100.0].into_iter().enumerate() {
            matrix[(oscillator, 3 + oscillator)] = 1.0;
            matrix[(3 + oscillator, oscillator)] = -square;
        }
        let roots = [10.0, rate, rate].map(|rate| Complex::new(0.0, rate));
        let vectors = eigenvectors(&Ordered::of_dense(&matrix), &roots);
        for (vector, moving) in vectors.iter().zip([2, 0, 1]) {
            let expected = |state: usize| if state % 3 == moving { vector[state].norm() } else { 0.0 };
            let moved = vector.iter().enumerate();
            assert!(
                moved
                    .clone()
                    .all(|(state, own)| (own.norm() - expected(state)).abs() < 1e-9)
            );
            assert!(
                (vector[moving + 3] / vector[moving] - Complex::new(0.0, if moving == 2 { 10.0 } else { rate })).norm()
                    < 1e-6
            );
        }
    }

    /// A mode with critical damping has its eigenvalue twice, and one eigenvector.
    #[test]
    fn a_defective_eigenvalue_has_one_eigenvector() {
        let matrix = DMatrix::from_row_slice(2, 2, &[0.0, 1.0, -100.0, -20.0]);
        let vectors = eigenvectors(&Ordered::of_dense(&matrix), &[Complex::from(-10.0); 2]);
        let ratio = |of: usize| vectors[of][1] / vectors[of][0];
        assert!(
            (0..2).all(|of| (ratio(of) + 10.0).norm() < 1e-4),
            "{} {}",
            ratio(0),
            ratio(1)
        );
    }
}
