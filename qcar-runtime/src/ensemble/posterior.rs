//! Parameter sets drawn from the normal distribution of the estimates of a fit, within their ranges.

use nalgebra::{DMatrix, DVector, SymmetricEigen};
use thiserror::Error;

use crate::random::SplitMix;

/// Estimate of a parameter.
#[derive(Clone, Debug, PartialEq)]
pub struct Estimate {
    /// Name, for messages.
    pub name: String,
    /// Value, SI.
    pub value: f64,
    /// Standard error, SI.
    pub stderr: f64,
    /// Bounds of the fit, SI.
    pub range: (f64, f64),
}

/// The distribution of several estimates.
#[derive(Clone, Debug, PartialEq)]
pub struct Posterior {
    estimates: Vec<Estimate>,
    /// A square root of their covariance.
    root: DMatrix<f64>,
}

/// Reason why estimates have no distribution.
#[derive(Clone, Debug, Error, PartialEq)]
#[expect(missing_docs, reason = "the message says it")]
pub enum PosteriorError {
    #[error("the correlations contradict each other: the least eigenvalue of their matrix is {0:.3}")]
    Indefinite(f64),
    #[error("the estimate of `{name}`, {value}, is outside of its range, {low} to {high}")]
    OutOfRange {
        name: String,
        value: f64,
        low: f64,
        high: f64,
    },
}

/// Smallest eigenvalue of a correlation matrix that rounding explains.
const ROUNDING: f64 = 1e-9;

/// Number of attempts to draw a set within the ranges.
const MOST_DRAWS: usize = 10_000;

impl Posterior {
    /// The distribution of estimates with these `correlations`, each a pair of positions with its value.
    ///
    /// # Errors
    /// Fails if the correlations belong to no distribution, or if an estimate is outside its range.
    pub fn new(estimates: Vec<Estimate>, correlations: &[(usize, usize, f64)]) -> Result<Self, PosteriorError> {
        for own in &estimates {
            let (low, high) = own.range;
            if !(low..=high).contains(&own.value) {
                let (name, value) = (own.name.clone(), own.value);
                return Err(PosteriorError::OutOfRange { name, value, low, high });
            }
        }
        let mut matrix = DMatrix::identity(estimates.len(), estimates.len());
        for &(a, b, value) in correlations {
            matrix[(a, b)] = value;
            matrix[(b, a)] = value;
        }
        let eigen = SymmetricEigen::new(matrix);
        let least = eigen.eigenvalues.iter().copied().fold(f64::INFINITY, f64::min);
        if least < -ROUNDING {
            return Err(PosteriorError::Indefinite(least));
        }
        let lengths = eigen.eigenvalues.map(|value| value.max(0.0).sqrt());
        let errors = DVector::from_iterator(estimates.len(), estimates.iter().map(|own| own.stderr));
        let root = DMatrix::from_diagonal(&errors) * &eigen.eigenvectors * DMatrix::from_diagonal(&lengths);
        Ok(Self { estimates, root })
    }

    /// The estimates.
    pub fn estimates(&self) -> &[Estimate] {
        &self.estimates
    }

    /// The draw with this number, within all ranges; NaN if ten thousand attempts fail.
    pub fn draw(&self, number: u64, seed: u64, into: &mut [f64]) {
        let mut random = SplitMix::stream(seed, number);
        for _ in 0..MOST_DRAWS {
            let normal = DVector::from_fn(self.estimates.len(), |_, _| random.normal());
            let moved = &self.root * normal;
            let all = into.iter_mut().zip(&self.estimates).zip(moved.iter());
            all.for_each(|((value, own), moved)| *value = own.value + moved);
            let mut drawn = into.iter().zip(&self.estimates);
            if drawn.all(|(value, own)| (own.range.0..=own.range.1).contains(value)) {
                return;
            }
        }
        into.fill(f64::NAN);
    }
}

#[cfg(test)]
mod tests {
    use super::{Estimate, Posterior, PosteriorError};

    fn estimates() -> Vec<Estimate> {
        let own = |name: &str, value, stderr| Estimate {
            name: name.into(),
            value,
            stderr,
            range: (-100.0, 100.0),
        };
        vec![own("a", 10.0, 1.0), own("b", -5.0, 2.0), own("c", 0.0, 0.5)]
    }

    /// Within 5 standard errors of a mean, a variance and a correlation of so many draws.
    #[test]
    fn draws_have_the_moments_of_the_fit() {
        const COUNT: usize = 40_000;
        let posterior = Posterior::new(estimates(), &[(0, 1, 0.9), (2, 1, -0.3)]).unwrap();
        let mut drawn = vec![[0.0; 3]; COUNT];
        for (number, into) in drawn.iter_mut().enumerate() {
            posterior.draw(number as u64, 3, into);
        }
        let scaled = |own: &[f64; 3]| [own[0] - 10.0, (own[1] + 5.0) / 2.0, own[2] / 0.5];
        let mean = |of: &dyn Fn([f64; 3]) -> f64| drawn.iter().map(|own| of(scaled(own))).sum::<f64>() / COUNT as f64;
        let within = 5.0 * (2.0 / COUNT as f64).sqrt();
        for place in 0..3 {
            assert!(mean(&|own| own[place]).abs() < within);
            assert!((mean(&|own| own[place].powi(2)) - 1.0).abs() < within);
        }
        for (a, b, expected) in [(0, 1, 0.9), (1, 2, -0.3), (0, 2, 0.0)] {
            assert!((mean(&|own| own[a] * own[b]) - expected).abs() < within);
        }
    }

    #[test]
    fn draws_stay_within_their_ranges() {
        let mut own = estimates();
        own[0].range = (9.9, 10.5);
        let posterior = Posterior::new(own, &[(0, 1, 0.9)]).unwrap();
        for number in 0..1000 {
            let mut into = [0.0; 3];
            posterior.draw(number, 0, &mut into);
            assert!((9.9..=10.5).contains(&into[0]));
        }
    }

    #[test]
    fn what_no_distribution_has_is_refused() {
        let contradicting = [(0, 1, 0.9), (1, 2, 0.9), (0, 2, -0.9)];
        let refused = Posterior::new(estimates(), &contradicting);
        assert!(matches!(refused, Err(PosteriorError::Indefinite(_))));
        let mut outside = estimates();
        outside[1].range = (0.0, 1.0);
        assert!(matches!(
            Posterior::new(outside, &[]),
            Err(PosteriorError::OutOfRange { .. })
        ));
    }
}
