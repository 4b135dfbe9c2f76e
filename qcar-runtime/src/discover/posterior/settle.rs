//! The end of a refit: what its sweeps show beyond their steady harmonics.

use super::problem::Posterior;
use super::refit::Refit;
use crate::campaign::Role;
use crate::discover::observe::{Evidence, PredictError, Series, Stimulus, unsteady};
use crate::model::Model;

/// Rounds of a refit with what its sweeps add to their steady harmonics: the second has it from where the first arrived.
const ROUNDS: usize = 2;
/// Evaluations of such a round: it begins beside its end, and what is still far then is no explanation.
const TO_SETTLE: usize = 20;

/// The same refit with what its sweeps show beyond their steady harmonics, which a search alone leaves out: see
/// [`unsteady`].
///
/// # Errors
/// Where the model lacks what was measured.
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
    /// A short search, and the discrepancy where there is one.
    fn settle(&mut self, place: Vec<f64>) -> Result<Refit, PredictError> {
        if self.discrepancy.is_some() {
            return self.fit(place, 1, TO_SETTLE);
        }
        let outcome = self.search(&place, TO_SETTLE)?;
        Ok(self.refit(outcome))
    }
}
