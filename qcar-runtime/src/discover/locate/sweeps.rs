//! The places that explain what a model leaves of the sweeps.

use super::kappa::Kappa;
use super::lines::Lines;
use super::map::kappa_map;
use crate::campaign::Role;
use crate::discover::observe::{Evidence, Kind, PredictError, Stimulus, predict};
use crate::discover::posterior::{Gap, Refit, refit};
use crate::model::Model;

/// What the sweeps say of where something is missing.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Sweeps {
    /// The places of the model, the best explanation first; none without sweeps.
    pub places: Vec<Kappa>,
    /// Sum of the squared first harmonics, over their uncertainty, that the model leaves without any of it.
    pub left: f64,
}

/// Uncertainty added to every value before κ is asked for, as its share: a wrong model that is pressed to fit hides its
/// fault in all its parameters.
const TOLERANCE: f64 = 0.1;

impl Sweeps {
    /// Finds the places that explain what a fitted model leaves of the sweeps.
    ///
    /// # Errors
    /// Where the model lacks what was measured.
    pub fn new(model: &dyn Model, before: &Refit, evidence: &Evidence) -> Result<Self, PredictError> {
        let sweeps = evidence.only(|run| matches!(evidence.runs[run].stimulus, Stimulus::Sweep { .. }));
        if sweeps.of_role(Role::Fit).next().is_none() {
            return Ok(Self::default());
        }
        let eased = refit(model, &before.values, &before.free, &sweeps.tolerant(TOLERANCE))?;
        let base = predict(model, &eased.values, &[], &sweeps, Role::Fit)?;
        Ok(Self {
            left: Lines::new(&eased, &sweeps, &base).left(),
            places: kappa_map(model, &eased, &sweeps)?,
        })
    }

    /// The share of what is left for which a model accounts that leaves this gap; `None` where nothing is left.
    pub fn explained_by(&self, gap: &Gap, evidence: &Evidence) -> Option<f64> {
        let first = evidence
            .of_role(Role::Fit)
            .filter(|(_, series)| series.kind == Kind::Harmonic(1));
        let squares = first
            .flat_map(|(place, _)| &gap.residuals[place])
            .map(|residual| residual * residual);
        // Each part of a complex residual is in units of its own standard deviation.
        (self.left > 0.0).then(|| 1.0 - squares.sum::<f64>() / 2.0 / self.left)
    }
}
