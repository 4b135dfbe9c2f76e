//! Whether all eigenvalues of a matrix within a circle are known, by the argument principle.

use std::f64::consts::{PI, TAU};

use nalgebra::Complex;

use crate::banded::Ordered;

/// Intervals into which half of the circle is divided at first, and most points on it.
const INTERVALS: usize = 8;
const POINTS: usize = 120;

/// Largest change of the logarithm over an interval. Near an eigenvalue that is not known, it changes by `ln 3 = 1.1`
/// from half an interval away to one and a half, in its real part too. So none stays hidden between two points.
const CHANGE: f64 = 0.5;

/// True if a matrix has as many eigenvalues within the circle of this radius around zero as are known there. False if
/// there are more or fewer, or if this stays in doubt. Complex ones must be known in conjugate pairs; those that are
/// known outside only make the function below smoother.
///
/// On the way around the circle, the argument of `det(A - s) / Π(s - λ)`, with the known eigenvalues λ, grows by a turn
/// for each eigenvalue within it that is not known (Ahlfors, "Complex Analysis", 3rd ed., section 4.5.2). Both halves of
/// the circle contribute the same.
pub(super) fn are_known_within(a: &Ordered, radius: f64, known: &[Complex<f64>]) -> bool {
    let logarithm = |angle: f64| {
        let s = Complex::from_polar(radius, angle);
        let known: Complex<f64> = known.iter().map(|root| (s - root).ln()).sum();
        a.less(s).log_determinant() - known
    };
    let point = |angle: f64| (angle, logarithm(angle));
    let first: Vec<_> = (0..=INTERVALS)
        .map(|place| point(PI * place as f64 / INTERVALS as f64))
        .collect();
    let mut open: Vec<_> = first.windows(2).map(|ends| [ends[0], ends[1]]).collect();
    let (mut points, mut turned) = (first.len(), 0.0);
    while let Some([from, to]) = open.pop() {
        let change = to.1 - from.1;
        let turn = change.im - TAU * (change.im / TAU).round();
        if change.re.hypot(turn) < CHANGE {
            turned += turn;
        } else if points == POINTS {
            return false;
        } else {
            let middle = point(0.5 * (from.0 + to.0));
            open.extend([[from, middle], [middle, to]]);
            points += 1;
        }
    }
    // It is a multiple of half a turn.
    turned.abs() < 1.0
}

#[cfg(test)]
mod tests {
    use nalgebra::{Complex, DMatrix};

    use super::are_known_within;
    use crate::banded::Ordered;

    /// Blocks of which each has a pair of eigenvalues, then real eigenvalues.
    fn matrix(pairs: &[Complex<f64>], real: &[f64]) -> Ordered {
        let mut matrix = DMatrix::zeros(2 * pairs.len() + real.len(), 2 * pairs.len() + real.len());
        for (place, root) in pairs.iter().enumerate() {
            let own = [[root.re, root.im], [-root.im, root.re]];
            (0..4).for_each(|at| matrix[(2 * place + at / 2, 2 * place + at % 2)] = own[at / 2][at % 2]);
        }
        for (place, root) in real.iter().enumerate() {
            matrix[(2 * pairs.len() + place, 2 * pairs.len() + place)] = *root;
        }
        Ordered::of_dense(&matrix)
    }

    /// Near the circle on either side, also twice, and far from it.
    #[test]
    fn an_eigenvalue_that_is_not_known_is_noticed() {
        let pair = |size: f64, angle: f64| Complex::from_polar(size, angle);
        let known = [pair(0.5, 1.7), pair(0.5, -1.7), pair(1.5, 2.0), pair(1.5, -2.0)];
        let near = |hidden: &[Complex<f64>], real: &[f64]| {
            let pairs: Vec<_> = [known[0], known[2]].into_iter().chain(hidden.iter().copied()).collect();
            are_known_within(&matrix(&pairs, real), 1.0, &known)
        };
        assert!(near(&[], &[]));
        assert!(near(&[pair(3.0, 1.6), pair(10.0, 2.0)], &[-5.0]));
        assert!(near(&[pair(1.1, 1.6)], &[]));
        for size in [0.01, 0.3, 0.9, 0.999, 1.0 - 1e-6, 1.0] {
            for angle in [1.57, 1.6, 1.7671, 2.5] {
                let hidden = pair(size, angle);
                assert!(!near(&[hidden], &[]), "{hidden}");
                assert!(!near(&[hidden, hidden], &[]), "{hidden} twice");
                assert!(!near(&[hidden, hidden * 1.001], &[]), "{hidden} and another");
            }
            assert!(!near(&[], &[-size]), "-{size}");
            assert!(!near(&[], &[-size, -size]), "-{size} twice");
        }
        // One of the known ones is none.
        assert!(!are_known_within(&matrix(&[known[2]], &[]), 1.0, &known));
    }
}
