//! Fits of a model, with a discrepancy or against noise alone.

use super::initial_states::estimate_initial_states;
use super::offset;
use super::problem::Posterior;
use super::refit::Refit;
use crate::campaign::Role;
use crate::discover::noise::{Discrepancy, InitialState, Nuisance};
use crate::discover::observe::{Evidence, Free, PredictError, Run};
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
    let initial_states = initial_states(model, &start, &nuisance, &place[free.len()..], evidence)?;
    place.extend(initial_states);
    place.extend(factors);
    let mut posterior = Posterior::new(model, start.values.clone(), free, evidence, nuisance);
    posterior.discrepancy = Some(start.discrepancy);
    posterior.has_discrepancy = true;
    posterior.decrement = decrement;
    posterior.centre = start.centre.clone();
    place.resize(posterior.variables(), 0.0);
    posterior.fit(place, rounds, evaluations)
}

/// Initial states at the start of a fit. Those of a free decay of which the start knows none, and no sensor shows any, are
/// estimated if the model is nonlinear: from rest, nothing moves, and a fit would hardly see a law that acts at large
/// travels only.
fn initial_states(
    model: &dyn Model,
    start: &Start<'_>,
    nuisance: &Nuisance,
    errors: &[f64],
    evidence: &Evidence,
) -> Result<Vec<f64>, PredictError> {
    let mut coefficients = errors.to_vec();
    coefficients.resize(nuisance.count(), 0.0);
    let mut conditions = nuisance.conditions(evidence, &coefficients);
    if !model.about().linear {
        let is_known = |run: &Run| start.initial_states.iter().any(|(known, _)| known.run == run.name);
        let is_wanted = |run: &Run| run.role == Role::Fit && run.stimulus.is_unmeasured_decay() && !is_known(run);
        let sensors = (nuisance, coefficients.as_slice());
        estimate_initial_states(model, start.values, sensors, evidence, is_wanted, &mut conditions)?;
    }
    let value = |own: &InitialState| {
        let is_it = |(known, _): &&(InitialState, f64)| known.run == own.run && known.state == own.state;
        let known = start.initial_states.iter().find(is_it).map(|(_, value)| *value);
        let estimated = || {
            let run = evidence.runs.iter().position(|run| run.name == own.run)?;
            let states = conditions.initial_states[run].iter();
            let mut at_start = states.filter(|of| of.sample == 0 && of.state == own.state);
            at_start.next().map(|of| of.by)
        };
        known.or_else(estimated).unwrap_or(0.0)
    };
    Ok(nuisance.initial_states.iter().map(value).collect())
}
