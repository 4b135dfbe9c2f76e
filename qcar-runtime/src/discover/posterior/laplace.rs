//! Laplace approximation of the posterior at its maximum: covariance and evidence.

use std::ops::Range;

use nalgebra::{DMatrix, DVector};

use super::prior::SIDE;
use super::problem::Posterior;
use super::refit::Refit;
use crate::least_squares::information::{Information, Unseen};
use crate::least_squares::{Outcome, Problem, Stop, gram};

impl Posterior<'_> {
    /// Result of a search.
    pub fn refit(&mut self, outcome: Outcome) -> Refit {
        let count = self.free.len();
        let inside: Vec<bool> = outcome.at_bound.iter().map(|&side| side == 0).collect();
        // The priors of free parameters are left out: standard errors come from the data alone.
        let informative = outcome
            .jacobian
            .rows(0, self.residuals + self.sigmas.len())
            .into_owned();
        let information = Information::new(&informative, &inside);
        self.move_to(&outcome.x);
        Refit {
            values: self.values.clone(),
            side: self.side.clone(),
            estimate: outcome.x[..count].to_vec(),
            covariance: spread(&information, 0..count),
            coefficient_stderr: self.coefficient_stderr(&information),
            unseen: (0..count).map(|k| unseen(&information, k, count)).collect(),
            at_bound: outcome.at_bound[..count].to_vec(),
            free: self.free.clone(),
            coefficients: outcome.x[count..][..self.nuisance.count()].to_vec(),
            chi2: 2.0 * outcome.cost,
            gained: outcome.start_cost - outcome.cost,
            log_evidence: self.log_evidence(&outcome),
            discrepancy: self.discrepancy.clone(),
            centre: self.centre.clone(),
            residuals: self.residuals,
            side_sd: if self.evidence.two_sided {
                SIDE / f64::sqrt(2.0)
            } else {
                0.0
            },
            unsteady: self.unsteady.clone(),
            nuisance: self.nuisance.clone(),
            evaluations: outcome.evaluations,
            // Errors of the sensors alone are no fit of the model.
            stop: match outcome.stop {
                stop if self.free.is_empty() && stop.converged() => Stop::NothingToFit,
                stop => stop,
            },
        }
    }

    fn coefficient_stderr(&self, information: &Information) -> Vec<f64> {
        let coefficients = self.free.len()..self.variables();
        let errors = spread(information, coefficients).diagonal().map(f64::sqrt);
        errors.as_slice().to_vec()
    }

    /// Laplace approximation of the log evidence, in units in which every prior has standard deviation 1. The
    /// normalisations of priors and posterior then cancel, except for the determinant (MacKay, D. J. C.: Information
    /// theory, inference, and learning algorithms, 2003, chapter 28). NaN without a discrepancy.
    fn log_evidence(&self, outcome: &Outcome) -> f64 {
        let Some(discrepancy) = &self.discrepancy else {
            return f64::NAN;
        };
        let scale = |k: usize| match k.checked_sub(self.free.len()) {
            Some(k) => self.sigmas[k],
            None => 1.0 / self.prior_of(k, outcome.x[k]).1,
        };
        let scale = DVector::from_fn(self.variables(), |k, _| scale(k));
        let hessian = gram(&outcome.jacobian).component_mul(&(&scale * scale.transpose()));
        let determinant = hessian
            .cholesky()
            .map_or(f64::NAN, |own| own.l_dirty().diagonal().map(f64::ln).sum());
        -outcome.cost - discrepancy.cost() - self.nuisance.accuracy.cost() - determinant
    }
}

/// Why one of the first `count` variables cannot be estimated, with positions among these variables; `None` if it can.
fn unseen(information: &Information, variable: usize, count: usize) -> Option<Unseen> {
    match information.unseen(variable)? {
        Unseen::Nowhere => Some(Unseen::Nowhere),
        Unseen::Combination { with } => Some(Unseen::Combination {
            with: with.iter().copied().filter(|&other| other < count).collect(),
        }),
    }
}

/// Covariance of a range of variables; NaN where a variable cannot be estimated.
fn spread(information: &Information, variables: Range<usize>) -> DMatrix<f64> {
    let place = |k: usize| information.seen().iter().position(|&seen| seen == variables.start + k);
    DMatrix::from_fn(variables.len(), variables.len(), |i, j| match (place(i), place(j)) {
        (Some(i), Some(j)) => information.inverse()[(i, j)],
        _ => f64::NAN,
    })
}
