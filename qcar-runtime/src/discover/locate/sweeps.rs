//! Finds the places that explain the residual of the sweeps.

use super::lines::Lines;
use super::map::stiffness_map;
use super::missing_stiffness::MissingStiffness;
use crate::campaign::Role;
use crate::discover::observe::{Evidence, Kind, PredictError, Stimulus, predict};
use crate::discover::posterior::{Misfit, Refit, refit};
use crate::model::Model;

/// Places that explain the residual of the sweeps.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Sweeps {
    /// Places of the model, best explanation first; empty without sweeps.
    pub places: Vec<MissingStiffness>,
    /// Sum of the squared normalised residuals of the first harmonics.
    pub squared_residual: f64,
}

/// Relative uncertainty added to every value before κ is computed, a choice. A wrong model that is fitted closely would
/// distribute its error over all its parameters.
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
        let tolerant = refit(model, &before.values, &before.free, &sweeps.with_tolerance(TOLERANCE))?;
        let base = predict(model, &tolerant.values, &[], &sweeps, Role::Fit)?;
        Ok(Self {
            squared_residual: Lines::new(&tolerant, &sweeps, &base).squared_residual(),
            places: stiffness_map(model, &tolerant, &sweeps)?,
        })
    }

    /// Share of `squared_residual` that another model explains, from its `misfit`; `None` if there is no residual.
    pub fn explained_by(&self, misfit: &Misfit, evidence: &Evidence) -> Option<f64> {
        let first = evidence
            .of_role(Role::Fit)
            .filter(|(_, series)| series.kind == Kind::Harmonic(1));
        let squares = first
            .flat_map(|(place, _)| &misfit.residuals[place])
            .map(|residual| residual * residual);
        // Each part of a complex residual is in units of its own standard deviation, hence the factor 2.
        (self.squared_residual > 0.0).then(|| 1.0 - squares.sum::<f64>() / 2.0 / self.squared_residual)
    }
}
