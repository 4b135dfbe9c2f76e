//! Result of a fit: the maximum a posteriori with its errors.

use nalgebra::{Complex, DMatrix};

use crate::campaign::Role;
use crate::discover::noise::{Discrepancy, InitialState, Nuisance};
use crate::discover::observe::{Evidence, Free, Prediction};
use crate::least_squares::Stop;
use crate::least_squares::information::Unseen;
use crate::response::parameters::Values;
use crate::transmissibility::Point;

/// Result of a fit.
#[derive(Clone, Debug)]
pub struct Refit {
    /// All parameter values, SI.
    pub values: Values,
    /// Parameter values of the side that cleat runs record, SI.
    pub side: Values,
    /// The free parameters.
    pub free: Vec<Free>,
    /// Their estimates, SI.
    pub estimate: Vec<f64>,
    /// Covariance of the free parameters with sensor errors allowed for; NaN for one that is at its bound or cannot be
    /// estimated. Not scaled by [`Self::scatter`].
    pub covariance: DMatrix<f64>,
    /// Why a free parameter inside its bounds cannot be estimated alone, by positions in `free`; `None` if it can.
    pub unseen: Vec<Option<Unseen>>,
    /// For each free parameter: -1 at its lower bound, 1 at its upper bound, 0 between.
    pub at_bound: Vec<i8>,
    /// The nuisance parameters.
    pub nuisance: Nuisance,
    /// Their coefficients.
    pub coefficients: Vec<f64>,
    /// Standard errors of the coefficients, followed by those of the log factors of the recorded side. Not scaled by
    /// [`Self::scatter`]; NaN for one that nothing determines.
    pub coefficient_stderr: Vec<f64>,
    /// Sum of squares of all residuals, priors included.
    pub chi2: f64,
    /// Decrease of half the sum of squares by the last search.
    pub gained: f64,
    /// Log evidence by the Laplace approximation, up to a constant of the data; NaN without a discrepancy.
    pub log_evidence: f64,
    /// Discrepancy of the model; `None` for a fit against noise alone.
    pub discrepancy: Option<Discrepancy>,
    /// Centres of the parameter priors.
    pub centre: Values,
    /// Number of data residuals.
    pub residuals: usize,
    /// Relative standard deviation of the mean of both sides from the value of the design, since parts of one design
    /// differ. 0 if only one side is measured.
    pub side_sd: f64,
    /// Non-steady part of each series, which a search does not predict; empty before
    /// [`add_unsteady`](super::add_unsteady).
    pub unsteady: Vec<Vec<Complex<f64>>>,
    /// Evaluations of residual and Jacobian.
    pub evaluations: usize,
    /// Why the search stopped.
    pub stop: Stop,
}

impl Refit {
    /// Standard errors of the free parameters as values of the design, SI: from the scatter of the residuals and the
    /// difference of the two sides.
    pub fn stderr(&self) -> Vec<f64> {
        let variances = self.covariance.diagonal();
        let of = variances.iter().zip(&self.estimate);
        of.map(|(variance, value)| (self.scatter() * variance + (self.side_sd * value).powi(2)).sqrt())
            .collect()
    }

    /// Log factor of a parameter on the side that cleat runs record.
    pub fn factor(&self, parameter: usize) -> f64 {
        let factor = (self.side.as_slice()[parameter] / self.values.as_slice()[parameter]).ln();
        if factor.is_finite() { factor } else { 0.0 }
    }

    /// Sum of squares of all residuals, priors included, over the number of data residuals; at least 1.
    pub fn scatter(&self) -> f64 {
        (self.chi2 / self.residuals as f64).max(1.0)
    }

    /// The discrepancy of the fit for another part of the evidence.
    pub fn discrepancy_of(&self, evidence: &Evidence) -> Option<Discrepancy> {
        self.discrepancy
            .as_ref()
            .map(|known| known.carried_to(evidence, Role::Fit))
    }

    /// Zero offset of each sensor with records, and its standard error, SI.
    pub fn offsets(&self) -> Vec<(Point, f64, f64)> {
        let scatter = self.scatter().sqrt();
        let errors: Vec<f64> = self.coefficient_stderr.iter().map(|error| scatter * error).collect();
        self.nuisance.offsets(&self.coefficients, &errors)
    }

    /// Estimated initial states of the records.
    pub fn initial_states(&self) -> Vec<(InitialState, f64)> {
        let coefficients = &self.coefficients[self.nuisance.of_sensors()..];
        let states = self.nuisance.initial_states.iter().cloned();
        states.zip(coefficients.iter().copied()).collect()
    }

    /// Readings of a sensor with its fitted errors for a prediction.
    pub fn sensor_output(&self, evidence: &Evidence, prediction: &Prediction) -> Vec<Complex<f64>> {
        let series = &evidence.series[prediction.series];
        self.nuisance
            .sensor_output(evidence, series, &prediction.value, &self.coefficients)
            .value
    }
}
