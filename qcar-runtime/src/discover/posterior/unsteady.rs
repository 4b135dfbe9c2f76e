//! Last stage of a refit: with the non-steady part of the sweeps.

use super::problem::Posterior;
use super::refit::Refit;
use super::search::DECREMENT;
use crate::campaign::Role;
use crate::discover::observe::{Evidence, PredictError, Series, Stimulus, unsteady};
use crate::model::Model;

/// Rounds of a refit with the non-steady part of the sweeps; the second recomputes it at the result of the first.
const ROUNDS: usize = 2;
/// Most evaluations of a round. It starts near its optimum; a model that needs more explains the data badly.
const EVALUATIONS: usize = 20;

/// Refits with the non-steady part of the sweeps, which a search leaves out: see [`unsteady`]. Without fitted sweeps
/// the refit is unchanged.
///
/// # Errors
/// Fails if the model lacks a measured quantity.
pub fn add_unsteady(model: &dyn Model, refit: Refit, evidence: &Evidence) -> Result<Refit, PredictError> {
    let swept = |(_, series): (usize, &Series)| matches!(evidence.runs[series.run].stimulus, Stimulus::Sweep { .. });
    if !evidence.of_role(Role::Fit).any(swept) {
        return Ok(refit);
    }
    let mut posterior = Posterior::of(&refit, model, evidence);
    posterior.decrement = DECREMENT;
    let mut refit = refit;
    for _ in 0..ROUNDS {
        let conditions = refit.nuisance.conditions(evidence, &refit.coefficients);
        posterior.change_unsteady(unsteady(model, &refit.values, &conditions, evidence, Role::Fit)?);
        let place = posterior.place(&refit);
        refit = posterior.short_fit(place)?;
    }
    Ok(refit)
}

impl Posterior<'_> {
    /// A short search, with an update of the discrepancy if there is one.
    fn short_fit(&mut self, place: Vec<f64>) -> Result<Refit, PredictError> {
        if self.discrepancy.is_some() {
            return self.fit(place, 1, EVALUATIONS);
        }
        let outcome = self.search(&place, EVALUATIONS)?;
        Ok(self.refit(outcome))
    }
}
