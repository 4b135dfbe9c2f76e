//! Fits of a model, with a discrepancy or against noise alone.

use super::offset;
use super::problem::Posterior;
use super::refit::Refit;
use crate::discover::noise::{Discrepancy, InitialState, Nuisance};
use crate::discover::observe::{Evidence, Free, PredictError};
use crate::least_squares::Problem;
use crate::model::Model;
use crate::response::parameters::Values;

/// Fits the free parameters, starting from `values`, and the sensor errors to the fitted runs, against noise alone.
///
/// # Errors
/// Fails if the model lacks a measured quantity.
pub fn refit(model: &dyn Model, values: &Values, free: &[Free], evidence: &Evidence) -> Result<Refit, PredictError> {
    refit_with(model, values, free, evidence, Nuisance::of(evidence), MOST_EVALUATIONS)
}

/// Default limit on model evaluations.
const MOST_EVALUATIONS: usize = 60;

/// Like [`refit`], with the sensor errors of `nuisance` and at most this number of evaluations.
///
/// # Errors
/// Fails if the model lacks a measured quantity.
pub fn refit_with(
    model: &dyn Model,
    values: &Values,
    free: &[Free],
    evidence: &Evidence,
    nuisance: Nuisance,
    evaluations: usize,
) -> Result<Refit, PredictError> {
    let nuisance = nuisance.with_initial_states(model, values.as_slice(), evidence);
    let nuisance = offset::remove_confounded(nuisance, model, values, free, evidence)?;
    let mut start: Vec<f64> = free.iter().map(|free| values.as_slice()[free.parameter]).collect();
    let mut posterior = Posterior::new(model, values.clone(), free, evidence, nuisance);
    start.resize(posterior.variables(), 0.0);
    let outcome = posterior.search(&start, evaluations)?;
    Ok(posterior.refit(outcome))
}

/// Start point of a fit with a discrepancy.
pub struct Start<'a> {
    /// All parameters.
    pub values: &'a Values,
    /// Coefficients of the sensor errors, followed by the log factors of the recorded side; missing ones are zero.
    pub errors: &'a [f64],
    /// Initial states of the records; missing ones start at the sensor readings, or at rest.
    pub initial_states: &'a [(InitialState, f64)],
    /// Centres of the parameter priors.
    pub centre: &'a Values,
    /// Discrepancy at the start.
    pub discrepancy: Discrepancy,
}

/// Maximum a posteriori fit of the free and nuisance parameters together with the discrepancy. It runs `rounds`
/// searches of at most `evaluations` each, which end at a predicted gain of `decrement`, and learns the discrepancy
/// from the residuals after each search.
///
/// # Errors
/// Fails if the model lacks a measured quantity.
pub fn fit(
    model: &dyn Model,
    start: Start<'_>,
    free: &[Free],
    evidence: &Evidence,
    nuisance: Nuisance,
    (rounds, evaluations): (usize, usize),
    decrement: f64,
) -> Result<Refit, PredictError> {
    let (errors, factors) = start.errors.split_at(start.errors.len().min(nuisance.of_sensors()));
    let nuisance = nuisance.with_initial_states(model, start.centre.as_slice(), evidence);
    let nuisance = offset::remove_confounded(nuisance, model, start.values, free, evidence)?;
    let mut place: Vec<f64> = free
        .iter()
        .map(|free| start.values.as_slice()[free.parameter])
        .collect();
    place.extend(errors);
    place.resize(free.len() + nuisance.of_sensors(), 0.0);
    let initial = |own: &InitialState| {
        let known = start
            .initial_states
            .iter()
            .find(|(known, _)| known.run == own.run && known.state == own.state);
        known.map_or(0.0, |(_, value)| *value)
    };
    place.extend(nuisance.initial_states.iter().map(initial));
    place.extend(factors);
    let mut posterior = Posterior::new(model, start.values.clone(), free, evidence, nuisance);
    posterior.discrepancy = Some(start.discrepancy);
    posterior.has_discrepancy = true;
    posterior.decrement = decrement;
    posterior.centre = start.centre.clone();
    place.resize(posterior.variables(), 0.0);
    posterior.fit(place, rounds, evaluations)
}
