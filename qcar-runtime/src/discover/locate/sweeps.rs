//! Finds the places that explain the residual of the sweeps.

use super::kappa::Kappa;
use super::lines::Lines;
use super::map::kappa_map;
use crate::campaign::Role;
use crate::discover::observe::{Evidence, Kind, PredictError, Stimulus, predict};
use crate::discover::posterior::{Gap, Refit, refit};
use crate::model::Model;

/// What the sweeps show about the place of a missing effect.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Sweeps {
    /// Places of the model, best explanation first; empty without sweeps.
    pub places: Vec<Kappa>,
    /// Sum of squared, normalised first harmonics that the base model leaves.
    pub left: f64,
}

/// Relative uncertainty added to every value before κ is computed: a wrong model that is fitted closely hides its error
/// in all its parameters.
const TOLERANCE: f64 = 0.1;

impl Sweeps {
    /// Finds the places that explain the residual of a fitted model in the sweeps.
    ///
    /// # Errors
    /// Fails if the model lacks a measured quantity.
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

    /// Share of `left` that another model explains, from its residual `gap`; `None` if nothing was left.
    pub fn explained_by(&self, gap: &Gap, evidence: &Evidence) -> Option<f64> {
        let first = evidence
            .of_role(Role::Fit)
            .filter(|(_, series)| series.kind == Kind::Harmonic(1));
        let squares = first
            .flat_map(|(place, _)| &gap.residuals[place])
            .map(|residual| residual * residual);
        // Each part of a complex residual is in units of its own standard deviation, hence the factor 2.
        (self.left > 0.0).then(|| 1.0 - squares.sum::<f64>() / 2.0 / self.left)
    }
}
