//! How well a model explains the evidence, and from where a search for its parameters may begin.

use std::collections::BTreeMap;

use super::gap::Gap;
use super::refit::Refit;
use crate::discover::observe::PredictError;
use crate::model::About;
use crate::response::parameters::Values;

/// A parameter of the base model as the campaign gives it.
#[derive(Clone, Debug, PartialEq)]
pub struct Given {
    /// Name.
    pub name: String,
    /// Start value, SI.
    pub value: f64,
    /// Bounds, for one that may move.
    pub range: Option<(f64, f64)>,
}

/// What the engineer gives beside the evidence.
#[derive(Clone, Debug, PartialEq)]
pub struct Setting {
    /// The parameters of the base model.
    pub given: Vec<Given>,
    /// Facts of the vehicle, which a model may or may not use.
    pub vehicle: BTreeMap<String, f64>,
}

impl Setting {
    /// # Errors
    /// A value for a parameter that the model does not have, and a parameter without a value.
    pub fn check(&self, about: &About) -> Result<(), PredictError> {
        let given = self.given.iter().map(|p| (p.name.clone(), p.value)).collect();
        let values = Values::resolve(about, &given, &self.vehicle);
        values.map(|_| ()).map_err(PredictError::Parameters)
    }
}

/// A model's explanation.
#[derive(Clone, Debug)]
pub struct Explanation {
    /// The parameters of its model by name.
    pub named: Vec<(String, f64)>,
    /// Its parameters and sensor errors.
    pub refit: Refit,
    /// What it leaves.
    pub gap: Gap,
}

impl Explanation {
    /// What the fitted residuals scatter by, squared; 1 where only noise is left.
    pub fn scatter(&self) -> f64 {
        self.refit.scatter()
    }
}
