//! Parameters and sensor errors that explain the evidence best: maximum a posteriori by least squares.
//!
//! The residuals are those of all fitted runs over their noise, and the coefficients of the sensors' errors over their
//! prior. Held-out runs are never seen.
//!
//! A rig shakes both sides of a car and its sensors are averaged over them, while a cleat run records one side. The two
//! corners of an axle differ by a percent or two, which shifts the modes of the after-shake by more than its noise: so
//! each free parameter has a factor of its own on the recorded side, held by a prior. A ratio is of the design, and both
//! sides share it: were one that stands at 1 for no effect free to differ, an effect could act on one side alone.

// The least-squares problem.
mod posterior;
// No offset twice.
mod offset;
// With what sweeps show beyond their steady harmonics.
mod settle;

use nalgebra::{Complex, DMatrix, DVector};

use super::noise::{Beginning, Discrepancy, Nuisance};
use super::observe::{Evidence, Free, PredictError, Prediction};
use crate::campaign::Role;
use crate::least_squares::{Problem, Stop};
use crate::model::Model;
use crate::response::parameters::Values;
use crate::transmissibility::Point;
use posterior::Posterior;
pub(super) use posterior::scaled;
pub use settle::settle;

/// The explanation that was found.
#[derive(Clone, Debug)]
pub struct Refit {
    /// All parameters.
    pub values: Values,
    /// The same on the side that cleat runs record.
    pub side: Values,
    /// Those that moved.
    pub free: Vec<Free>,
    /// What they came to.
    pub estimate: Vec<f64>,
    /// Covariance of the free parameters, sensor errors allowed for; NaN for one at a bound or not seen.
    pub covariance: DMatrix<f64>,
    /// For each free parameter: -1 on its lower bound, 1 on its upper bound, 0 between.
    pub at_bound: Vec<i8>,
    /// The sensors.
    pub nuisance: Nuisance,
    /// Their errors.
    pub coefficients: Vec<f64>,
    /// Standard errors of these; NaN for one that nothing tells of.
    pub coefficient_stderr: Vec<f64>,
    /// Sum of squares of all residuals, priors included.
    pub chi2: f64,
    /// By how much the last search lowered half the sum of squares.
    pub gained: f64,
    /// Logarithm of the evidence, by Laplace's method, but for a constant of the data; NaN without a discrepancy.
    pub log_evidence: f64,
    /// What the model misses; `None` where residuals are held against noise alone.
    pub discrepancy: Option<Discrepancy>,
    /// The values at which the priors of the parameters are centred.
    pub centre: Values,
    /// Number of residuals of the data.
    pub residuals: usize,
    /// Relative standard deviation of what the mean of the measured sides has by chance: of the parts that were made for one
    /// drawing, two are measured.
    pub made: f64,
    /// What the model was taken to show of each series beyond what a search predicts: nothing before it has settled.
    pub unsteady: Vec<Vec<Complex<f64>>>,
    /// Evaluations of residual and Jacobian.
    pub evaluations: usize,
    /// Why the search stopped.
    pub stop: Stop,
}

impl Refit {
    /// Standard errors of the free parameters, as those of the drawing: by what the residuals scatter, and by what the
    /// parts of two sides differ from it.
    pub fn stderr(&self) -> Vec<f64> {
        let variances = self.covariance.diagonal();
        let of = variances.iter().zip(&self.estimate);
        of.map(|(variance, value)| (self.scatter() * variance + (self.made * value).powi(2)).sqrt())
            .collect()
    }

    /// The logarithm of a parameter's factor on the side that cleat runs record.
    pub fn factor(&self, parameter: usize) -> f64 {
        let factor = (self.side.as_slice()[parameter] / self.values.as_slice()[parameter]).ln();
        if factor.is_finite() { factor } else { 0.0 }
    }

    /// What the fitted residuals scatter by, squared; 1 where only noise is left.
    pub fn scatter(&self) -> f64 {
        (self.chi2 / self.residuals as f64).max(1.0)
    }

    /// The residuals of the `model` that was fitted, in units of their noise, those of the data before those of what is held
    /// by a prior, and their Jacobian along all unknowns.
    pub fn linearised(&self, model: &dyn Model, evidence: &Evidence) -> (DVector<f64>, DMatrix<f64>) {
        Posterior::of(self, model, evidence).linearised(self)
    }

    /// The residuals of the data where another model with these `values` stands in the place of the `fitted` one, and
    /// sensors with these errors; `None` where that gives no number.
    pub fn residuals_of(
        &self,
        other: &dyn Model,
        values: &Values,
        (nuisance, coefficients): (Nuisance, &[f64]),
        fitted: &dyn Model,
        evidence: &Evidence,
    ) -> Option<DVector<f64>> {
        let name = |free: &Free| &fitted.about().parameters[free.parameter].name;
        let place = |free: &Free| other.about().parameters.iter().position(|p| p.name == *name(free));
        let mut side = values.clone();
        for free in &self.free {
            if let Some(parameter) = place(free) {
                side.set(parameter, self.side.as_slice()[free.parameter]);
            }
        }
        let mut posterior = Posterior::new(other, values.clone(), &[], evidence, nuisance);
        posterior.side = side;
        posterior.by_evidence = self.discrepancy.is_some();
        let mut residual = vec![0.0; posterior.residuals()];
        posterior.look(coefficients, &mut residual, false);
        residual.truncate(posterior.residuals);
        residual
            .iter()
            .all(|r| r.is_finite())
            .then(|| DVector::from_vec(residual))
    }

    /// The discrepancy that was found, for another part of the evidence.
    pub fn discrepancy_of(&self, evidence: &Evidence) -> Option<Discrepancy> {
        self.discrepancy
            .as_ref()
            .map(|known| known.carried_to(evidence, Role::Fit))
    }

    /// What the sensors of records read at zero, with standard errors; SI.
    pub fn offsets(&self) -> Vec<(Point, f64, f64)> {
        let scatter = self.scatter().sqrt();
        let errors: Vec<f64> = self.coefficient_stderr.iter().map(|error| scatter * error).collect();
        self.nuisance.offsets(&self.coefficients, &errors)
    }

    /// With which states records were found to begin.
    pub fn begun(&self) -> Vec<(Beginning, f64)> {
        let coefficients = &self.coefficients[self.nuisance.of_sensors()..];
        let beginnings = self.nuisance.beginnings.iter().cloned();
        beginnings.zip(coefficients.iter().copied()).collect()
    }

    /// What the sensors would have shown of a prediction.
    pub fn measured(&self, evidence: &Evidence, prediction: &Prediction) -> Vec<Complex<f64>> {
        let series = &evidence.series[prediction.series];
        self.nuisance
            .show(evidence, series, &prediction.value, &self.coefficients)
            .value
    }
}

/// Fits the free parameters of a model, from their `values`, and the errors of the sensors to the runs that may be
/// fitted.
///
/// # Errors
/// Where the model lacks what was measured.
pub fn refit(model: &dyn Model, values: &Values, free: &[Free], evidence: &Evidence) -> Result<Refit, PredictError> {
    refit_with(model, values, free, evidence, Nuisance::of(evidence), MOST_EVALUATIONS)
}

/// How often a refit may evaluate the model unless told otherwise.
const MOST_EVALUATIONS: usize = 60;

/// The same with sensors that may be wrong as `nuisance` says, and at most so many evaluations.
///
/// # Errors
/// Where the model lacks what was measured.
pub fn refit_with(
    model: &dyn Model,
    values: &Values,
    free: &[Free],
    evidence: &Evidence,
    nuisance: Nuisance,
    evaluations: usize,
) -> Result<Refit, PredictError> {
    let nuisance = nuisance.beginning(model.about(), evidence);
    let nuisance = offset::once(nuisance, model, values, free, evidence)?;
    let mut start: Vec<f64> = free.iter().map(|free| values.as_slice()[free.parameter]).collect();
    let mut posterior = Posterior::new(model, values.clone(), free, evidence, nuisance);
    start.resize(posterior.variables(), 0.0);
    let outcome = posterior.search(&start, evaluations)?;
    Ok(posterior.refit(outcome))
}

/// Where a fit by evidence begins.
pub struct Start<'a> {
    /// All parameters.
    pub values: &'a Values,
    /// The errors of sensors with the logarithms of the recorded side's factors behind them, zero beyond those that are known.
    pub errors: &'a [f64],
    /// With which states records were found to begin; others begin as they are seen.
    pub begun: &'a [(Beginning, f64)],
    /// Where the priors of the parameters are centred.
    pub centre: &'a Values,
    /// What the model is taken to miss at first.
    pub discrepancy: Discrepancy,
}

/// Fits the free parameters and nuisance parameters at their maximum a posteriori, and the discrepancy with them: in so many
/// `rounds` of at most so many evaluations each, after each of which the discrepancy is learnt from what is left.
///
/// # Errors
/// Where the model lacks what was measured.
pub fn fit(
    model: &dyn Model,
    start: Start<'_>,
    free: &[Free],
    evidence: &Evidence,
    nuisance: Nuisance,
    (rounds, evaluations): (usize, usize),
) -> Result<Refit, PredictError> {
    let (errors, factors) = start.errors.split_at(start.errors.len().min(nuisance.of_sensors()));
    let nuisance = nuisance.beginning(model.about(), evidence);
    let nuisance = offset::once(nuisance, model, start.values, free, evidence)?;
    let mut place: Vec<f64> = free
        .iter()
        .map(|free| start.values.as_slice()[free.parameter])
        .collect();
    place.extend(errors);
    place.resize(free.len() + nuisance.of_sensors(), 0.0);
    let begun = |own: &Beginning| {
        let known = start
            .begun
            .iter()
            .find(|(known, _)| known.run == own.run && known.state == own.state);
        known.map_or(0.0, |(_, value)| *value)
    };
    place.extend(nuisance.beginnings.iter().map(begun));
    place.extend(factors);
    let mut posterior = Posterior::new(model, start.values.clone(), free, evidence, nuisance);
    posterior.discrepancy = Some(start.discrepancy);
    posterior.by_evidence = true;
    posterior.centre = start.centre.clone();
    place.resize(posterior.variables(), 0.0);
    posterior.fit(place, rounds, evaluations)
}
