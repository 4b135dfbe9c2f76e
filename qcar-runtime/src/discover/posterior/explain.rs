//! Explanation of the evidence by a model, and the setting of a fit.

use std::collections::BTreeMap;

use super::misfit::Misfit;
use super::refit::Refit;
use crate::campaign::Role;
use crate::discover::noise::Factors;
use crate::discover::observe::{Evidence, PredictError};
use crate::model::About;
use crate::response::parameters::Values;

/// A parameter of the base model as the campaign gives it.
#[derive(Clone, Debug, PartialEq)]
pub struct Given {
    /// Name.
    pub name: String,
    /// Start value, SI.
    pub value: f64,
    /// Bounds of a free parameter, SI; `None` if it is fixed.
    pub range: Option<(f64, f64)>,
}

/// Inputs of the engineer besides the evidence.
#[derive(Clone, Debug, PartialEq)]
pub struct Setting {
    /// Parameters of the base model.
    pub given: Vec<Given>,
    /// Vehicle data by name, SI; a model need not use them.
    pub vehicle: BTreeMap<String, f64>,
}

impl Setting {
    /// Checks that every parameter of the model has a value.
    ///
    /// # Errors
    /// Fails if a value has no parameter in the model, or a parameter has no value.
    pub fn check(&self, about: &About) -> Result<(), PredictError> {
        let given = self.given.iter().map(|p| (p.name.clone(), p.value)).collect();
        let values = Values::resolve(about, &given, &self.vehicle);
        values.map(|_| ()).map_err(PredictError::Parameters)
    }
}

/// Fit of a model and its residuals over all runs.
#[derive(Clone, Debug)]
pub struct Explanation {
    /// All parameters of the model by name, SI.
    pub named: Vec<(String, f64)>,
    /// The fit, with its nuisance parameters.
    pub refit: Refit,
    /// Residuals over all runs.
    pub misfit: Misfit,
}

impl Explanation {
    /// As [`Refit::scatter`].
    pub fn scatter(&self) -> f64 {
        self.refit.scatter()
    }

    /// Log likelihood of the runs of a role, up to a constant, for each part of the data; `None` without a discrepancy.
    pub fn log_likelihoods(&self, role: Role, evidence: &Evidence) -> Option<Vec<f64>> {
        let discrepancy = self.refit.discrepancy.as_ref()?.carried_to(evidence, role);
        Some(discrepancy.log_likelihoods(self.residual(role, evidence)))
    }

    /// Log likelihood of the fitted passages along each axis, up to a constant; `None` without a discrepancy.
    pub fn log_likelihoods_of_passages(&self, evidence: &Evidence) -> Option<Vec<f64>> {
        let discrepancy = self.refit.discrepancy.as_ref()?.carried_to(evidence, Role::Fit);
        Some(discrepancy.log_likelihoods_of_passages(self.residual(Role::Fit, evidence)))
    }

    /// Logarithmic score: the log likelihood of the held-out runs, up to a constant, with the log prior of their
    /// discrepancy; `None` without a discrepancy. The held-out residuals determine its scale `τ`. With that of the
    /// fitted runs, a model with a small discrepancy would be penalised for any part of the signal that only the
    /// held-out runs excite, and a model that is wrong everywhere would not.
    pub fn log_score(&self, evidence: &Evidence) -> Option<f64> {
        let mut residual = self.residual(Role::HeldOut, evidence);
        let mut discrepancy = self.refit.discrepancy.as_ref()?.carried_to(evidence, Role::HeldOut);
        discrepancy.estimate(&residual, &Factors::default());
        discrepancy.whiten(&mut residual);
        let square: f64 = residual.iter().map(|value| value * value).sum();
        Some(-square / 2.0 - discrepancy.cost())
    }

    /// Residual of the runs of a role, in units of the noise.
    fn residual(&self, role: Role, evidence: &Evidence) -> Vec<f64> {
        let mut residual = Vec::new();
        for (place, series) in evidence.of_role(role) {
            let parts = series.kind.parts();
            let own = &self.misfit.residuals[place];
            let units = series
                .sigma
                .iter()
                .zip(&series.noise)
                .map(|(sigma, noise)| sigma / noise);
            let units = units.flat_map(|unit| std::iter::repeat_n(unit, parts));
            residual.extend(own.iter().zip(units).map(|(residual, unit)| residual * unit));
        }
        residual
    }
}
