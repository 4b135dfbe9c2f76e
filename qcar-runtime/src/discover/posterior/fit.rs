//! Fits of a model: with its discrepancy, or against noise alone.

use super::offset;
use super::problem::Posterior;
use super::refit::Refit;
use crate::discover::noise::{Beginning, Discrepancy, Nuisance};
use crate::discover::observe::{Evidence, Free, PredictError};
use crate::least_squares::Problem;
use crate::model::Model;
use crate::response::parameters::Values;

/// Fits the free parameters of a model, from their `values`, and the errors of the sensors to the runs that may be
/// fitted.
///
/// # Errors
/// Where the model lacks what was measured.
pub fn refit(model: &dyn Model, values: &Values, free: &[Free], evidence: &Evidence) -> Result<Refit, PredictError> {
    refit_with(model, values, free, evidence, Nuisance::of(evidence), MOST_EVALUATIONS)
}

/// How often a refit may evaluate the model by default.
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
    /// The errors of sensors with the logarithms of the recorded side's factors after them, zero beyond those that are known.
    pub errors: &'a [f64],
    /// With which states records were found to begin; others begin as they are seen.
    pub begun: &'a [(Beginning, f64)],
    /// Where the priors of the parameters are centred.
    pub centre: &'a Values,
    /// The discrepancy to begin with.
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
