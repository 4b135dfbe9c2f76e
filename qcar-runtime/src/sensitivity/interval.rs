//! Uncertainty of a metric: first-order propagation of the covariance of the parameters.
//!
//! All uncertainties are relative to the values of the parameters, so that they hold for any design.

use nalgebra::{DMatrix, DVector};

/// Uncertainty of parameters, relative to their values.
#[derive(Clone, Debug, PartialEq)]
pub struct ParameterUncertainty {
    /// Covariance of each source, in the order of [`Source::ALL`].
    covariances: [DMatrix<f64>; 3],
    /// Difference of the mean of each parameter from its value.
    shift: DVector<f64>,
}

/// Source of the uncertainty of a parameter.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Source {
    /// The errors of a fit.
    Fit,
    /// Tolerances of parts.
    Tolerance,
    /// The temperature.
    Temperature,
}

/// Uncertainty of a metric.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct Interval {
    /// Difference of its mean from its value.
    pub shift: f64,
    /// Standard deviation.
    pub deviation: f64,
    /// Share of each parameter in the variance, `g_k (C g)_k / gᵀ C g`; negative if its error partly cancels that of
    /// another. The sum is 1, or 0 if nothing is uncertain.
    pub shares: Vec<f64>,
    /// Share of each source in the variance, in the order of [`Source::ALL`].
    pub sources: [f64; 3],
}

impl Source {
    /// All of them.
    pub const ALL: [Source; 3] = [Source::Fit, Source::Tolerance, Source::Temperature];

    /// Its name in results.
    pub const fn name(self) -> &'static str {
        match self {
            Source::Fit => "fit",
            Source::Tolerance => "tolerance",
            Source::Temperature => "temperature",
        }
    }
}

impl ParameterUncertainty {
    /// No uncertainty of `count` parameters.
    pub fn none(count: usize) -> Self {
        Self {
            covariances: Source::ALL.map(|_| DMatrix::zeros(count, count)),
            shift: DVector::zeros(count),
        }
    }

    /// Adds relative standard errors of a fit with their correlations.
    pub fn add_errors(&mut self, errors: &[f64], correlation: impl Fn(usize, usize) -> f64) {
        let count = errors.len();
        let added = DMatrix::from_fn(count, count, |i, j| {
            let shared = if i == j { 1.0 } else { correlation(i, j) };
            errors[i] * errors[j] * shared
        });
        self.covariances[Source::Fit as usize] += added;
    }

    /// Adds tolerances, relative to the values: independent uniform distributions of the parameters.
    pub fn add_tolerances(&mut self, tolerances: &[f64]) {
        for (k, tolerance) in tolerances.iter().enumerate() {
            self.covariances[Source::Tolerance as usize][(k, k)] += tolerance * tolerance / 3.0;
        }
    }

    /// Adds a temperature that is the same for all parameters, uniform from `low` to `high` kelvin above that for which
    /// the values hold. `per_kelvin` is the relative change of each parameter per kelvin.
    pub fn add_temperature(&mut self, per_kelvin: &[f64], [low, high]: [f64; 2]) {
        let drift = DVector::from_row_slice(per_kelvin);
        let variance = (high - low).powi(2) / 12.0;
        self.covariances[Source::Temperature as usize] += variance * &drift * drift.transpose();
        self.shift += 0.5 * (low + high) * drift;
    }

    /// The resulting interval of a metric. `slopes` are its derivatives by relative changes of the parameters.
    pub fn of(&self, slopes: &[f64]) -> Interval {
        let slopes = DVector::from_row_slice(slopes);
        let moved = self.covariances.each_ref().map(|own| own * &slopes);
        let variances = moved.each_ref().map(|own| slopes.dot(own));
        let variance: f64 = variances.iter().sum();
        let of_all = |part: f64| if variance > 0.0 { part / variance } else { 0.0 };
        let share = |k: usize| of_all(slopes[k] * moved.iter().map(|own| own[k]).sum::<f64>());
        Interval {
            shift: self.shift.dot(&slopes),
            deviation: variance.max(0.0).sqrt(),
            shares: (0..slopes.len()).map(share).collect(),
            sources: variances.map(of_all),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::ParameterUncertainty;

    #[test]
    fn errors_that_go_together_cancel_in_what_depends_on_their_difference() {
        let mut uncertainty = ParameterUncertainty::none(2);
        uncertainty.add_errors(&[2.0, 2.0], |_, _| 1.0);
        assert!(uncertainty.of(&[1.0, -1.0]).deviation < 1e-12);
        assert!((uncertainty.of(&[1.0, 1.0]).deviation - 4.0).abs() < 1e-12);
        uncertainty.add_tolerances(&[3.0, 0.0]);
        let sum = uncertainty.of(&[1.0, 1.0]);
        assert!((sum.deviation - 19.0_f64.sqrt()).abs() < 1e-12);
        assert!((sum.shares[0] - 11.0 / 19.0).abs() < 1e-12);
        assert!((sum.sources[0] - 16.0 / 19.0).abs() < 1e-12);
    }

    /// One temperature for all parameters: its effects on two parameters with opposite drift cancel.
    #[test]
    fn a_temperature_moves_all_parts_together() {
        let mut uncertainty = ParameterUncertainty::none(2);
        uncertainty.add_temperature(&[0.01, -0.02], [-30.0, 50.0]);
        assert!(uncertainty.of(&[2.0, 1.0]).deviation < 1e-12);
        let own = uncertainty.of(&[1.0, 0.0]);
        // Uniform over 80 K about a mean of 10 K.
        assert!((own.deviation - 0.01 * 80.0 / 12.0_f64.sqrt()).abs() < 1e-12);
        assert!((own.shift - 0.1).abs() < 1e-12);
        assert_eq!(own.sources, [0.0, 0.0, 1.0]);
    }
}
