//! How sure a metric is, from how sure the parameters are: first-order propagation of their covariance.

use nalgebra::{DMatrix, DVector};

/// What is not known of parameters.
#[derive(Clone, Debug, PartialEq)]
pub struct Doubt {
    covariance: DMatrix<f64>,
}

/// How sure a metric is.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct Interval {
    /// Standard deviation.
    pub deviation: f64,
    /// The part of the variance that each parameter contributes, `g_k (C g)_k / gᵀ C g`; negative where its error is
    /// balanced by that of another. Their sum is 1, or 0 where nothing is in doubt.
    pub shares: Vec<f64>,
}

impl Doubt {
    /// None at all about `count` parameters.
    pub fn none(count: usize) -> Self {
        Self {
            covariance: DMatrix::zeros(count, count),
        }
    }

    /// Adds standard errors with their correlations.
    pub fn add_errors(&mut self, errors: &[f64], correlation: impl Fn(usize, usize) -> f64) {
        let count = errors.len();
        let added = DMatrix::from_fn(count, count, |i, j| {
            let shared = if i == j { 1.0 } else { correlation(i, j) };
            errors[i] * errors[j] * shared
        });
        self.covariance += added;
    }

    /// Adds tolerances: each part lies anywhere within so much of its value, as likely as not, whatever the others do.
    pub fn add_tolerances(&mut self, tolerances: &[f64]) {
        for (k, tolerance) in tolerances.iter().enumerate() {
            self.covariance[(k, k)] += tolerance * tolerance / 3.0;
        }
    }

    /// What that means for a metric with these derivatives.
    pub fn of(&self, slopes: &[f64]) -> Interval {
        let slopes = DVector::from_row_slice(slopes);
        let moved = &self.covariance * &slopes;
        let variance = slopes.dot(&moved);
        let share = |(slope, moved): (&f64, &f64)| if variance > 0.0 { slope * moved / variance } else { 0.0 };
        Interval {
            deviation: variance.max(0.0).sqrt(),
            shares: slopes.iter().zip(moved.iter()).map(share).collect(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::Doubt;

    #[test]
    fn errors_that_go_together_cancel_in_what_depends_on_their_difference() {
        let mut doubt = Doubt::none(2);
        doubt.add_errors(&[2.0, 2.0], |_, _| 1.0);
        assert!(doubt.of(&[1.0, -1.0]).deviation < 1e-12);
        assert!((doubt.of(&[1.0, 1.0]).deviation - 4.0).abs() < 1e-12);
        doubt.add_tolerances(&[3.0, 0.0]);
        let sum = doubt.of(&[1.0, 1.0]);
        assert!((sum.deviation - 19.0_f64.sqrt()).abs() < 1e-12);
        assert!((sum.shares[0] - 11.0 / 19.0).abs() < 1e-12);
    }
}
