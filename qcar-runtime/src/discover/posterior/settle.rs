//! Final stage of a refit: adds the non-steady part of the sweeps.

use super::problem::Posterior;
use super::refit::Refit;
use crate::campaign::Role;
use crate::discover::observe::{Evidence, PredictError, Series, Stimulus, unsteady};
use crate::model::Model;

/// Rounds of a refit with the non-steady part of the sweeps; the second recomputes it at the result of the first.
const ROUNDS: usize = 2;
/// Evaluations of a round. It starts near its optimum, so a fit that is still far away then is no explanation.
const TO_SETTLE: usize = 20;

/// Refits with the non-steady part of the sweeps, which a search leaves out: see [`unsteady`]. Without fitted sweeps
/// the refit stays as it is.
///
/// # Errors
/// Fails if the model lacks a measured quantity.
pub fn settle(model: &dyn Model, refit: Refit, evidence: &Evidence) -> Result<Refit, PredictError> {
    let swept = |(_, series): (usize, &Series)| matches!(evidence.runs[series.run].stimulus, Stimulus::Sweep { .. });
    if !evidence.of_role(Role::Fit).any(swept) {
        return Ok(refit);
    }
    let mut posterior = Posterior::of(&refit, model, evidence);
    let mut settled = refit;
    for _ in 0..ROUNDS {
        let misread = settled.nuisance.misread(evidence, &settled.coefficients);
        posterior.known.clear();
        posterior.unsteady = unsteady(model, &settled.values, &misread, evidence, Role::Fit)?;
        let place = posterior.place(&settled);
        settled = posterior.settle(place)?;
    }
    Ok(settled)
}

impl Posterior<'_> {
    /// A short search, with an update of the discrepancy if there is one.
    fn settle(&mut self, place: Vec<f64>) -> Result<Refit, PredictError> {
        if self.discrepancy.is_some() {
            return self.fit(place, 1, TO_SETTLE);
        }
        let outcome = self.search(&place, TO_SETTLE)?;
        Ok(self.refit(outcome))
    }
}
