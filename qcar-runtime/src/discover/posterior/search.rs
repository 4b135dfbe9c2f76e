//! Search for the maximum of a posterior together with its discrepancy.

use nalgebra::{DMatrix, DVector};

use super::problem::Posterior;
use super::refit::Refit;
use crate::discover::noise::{CALIBRATION_BOUND, Factors, Known};
use crate::discover::observe::PredictError;
use crate::least_squares::{Bounds, Options, Outcome, Problem, minimize, minimize_holding};

/// Largest log factor of a side in prior standard deviations, so that a fit cannot explain a missing effect by an
/// unrealistic difference of the sides.
const SIDE_BOUND: f64 = 3.0;

/// Largest sensor error in prior standard deviations if a discrepancy is fitted. Larger errors do not occur in
/// practice; the prior limits them, and this bound is only a safeguard.
const ERROR_BOUND: f64 = 6.0;

/// Predicted gain in log posterior density that ends a search among candidates. The unknowns are then within a tenth of
/// their standard errors from the maximum. The log evidence is too low by a hundredth of what one unknown gains by
/// chance.
pub const DECREMENT: f64 = 0.005;

/// Options of a search that ends at a predicted gain of `decrement` or at this number of evaluations.
pub const fn options(decrement: f64, evaluations: usize) -> Options {
    Options {
        gradient: 1e-5,
        cost: 1e-6,
        step: 1e-6,
        decrement,
        evaluations,
    }
}

impl Posterior<'_> {
    /// Least-squares minimum from `start`.
    pub fn search(&mut self, start: &[f64], evaluations: usize) -> Result<Outcome, PredictError> {
        let options = options(self.decrement, evaluations);
        self.start = start.to_vec();
        let bounds = self.bounds();
        let outcome = match self.nuisance.known {
            Known::Errors => minimize_holding(self, start, &self.held(), &bounds, &options),
            Known::Nothing | Known::Class | Known::Variances => minimize(self, start, &bounds, &options),
        };
        self.failure.take().map_or(Ok(outcome), Err)
    }

    /// Bounds of the parameters, the sensor errors and the side factors.
    pub fn bounds(&self) -> Bounds {
        let (sensors, sides) = self.sigmas.split_at(self.nuisance.count());
        let sides = sides.iter().map(|sigma| SIDE_BOUND * sigma);
        let most = if self.discrepancy.is_some() {
            ERROR_BOUND
        } else {
            CALIBRATION_BOUND
        };
        let priors: Vec<f64> = sensors.iter().map(|sigma| most * sigma).chain(sides).collect();
        let lower = self
            .free
            .iter()
            .map(|f| f.lower)
            .chain(priors.iter().map(|bound| -bound));
        let upper = self.free.iter().map(|f| f.upper).chain(priors.iter().copied());
        Bounds {
            lower: lower.collect(),
            upper: upper.collect(),
        }
    }

    /// True for each variable that a fit with known errors holds: those of the sensors, but not a suspected error.
    fn held(&self) -> Vec<bool> {
        let first = self.free.len();
        let of_sensors = first..first + self.nuisance.of_calibration();
        (0..self.variables()).map(|k| of_sensors.contains(&k)).collect()
    }

    /// Alternates between searches and updates of the discrepancy and of the accuracy class.
    pub fn fit(&mut self, mut place: Vec<f64>, rounds: usize, evaluations: usize) -> Result<Refit, PredictError> {
        let mut outcome = self.search(&place, evaluations)?;
        for round in 0..rounds {
            if round > 0 {
                outcome = self.search(&place, evaluations)?;
            }
            place.clone_from(&outcome.x);
            self.estimate_accuracy(&outcome);
            self.estimate_discrepancy(&place);
        }
        let mut residual = DVector::zeros(self.residuals());
        let mut jacobian = DMatrix::zeros(self.residuals(), self.variables());
        self.evaluate(&place, residual.as_mut_slice(), jacobian.as_mut_slice());
        // A change of the cost by the new discrepancy does not count as gain of the search.
        outcome.start_cost += residual.norm_squared() / 2.0 - outcome.cost;
        outcome.cost = residual.norm_squared() / 2.0;
        outcome.jacobian = jacobian;
        Ok(self.refit(outcome))
    }

    /// Estimates the discrepancy from the residuals at a point, unless it is known.
    pub fn estimate_discrepancy(&mut self, place: &[f64]) {
        if self.nuisance.known == Known::Variances {
            return;
        }
        let Some(mut discrepancy) = self.discrepancy.take() else {
            return;
        };
        let mut residual = vec![0.0; self.residuals()];
        self.residual_and_slopes(place, &mut residual, false);
        residual.truncate(self.residuals);
        if residual.iter().all(|r| r.is_finite()) {
            discrepancy.estimate(&residual, &Factors::default());
        }
        self.discrepancy = Some(discrepancy);
    }
}
