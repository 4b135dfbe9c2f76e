//! Candidates for what is missing: a changed model or a sensor error. A [`Workshop`] makes them from files, so the
//! search does not depend on their origin.

use super::noise::Form;
use crate::campaign::Axis;
use crate::model::Model;
pub use crate::model::ParameterRole;

/// Something that may be missing, at one place.
pub struct Candidate {
    /// Name of the effect.
    pub effect: String,
    /// Link, mass or sensor location.
    pub at: String,
    /// Variant of the effect at that place; `None` if there is only one.
    pub form: Option<String>,
    /// True for a nuisance effect: every real car has some of it, so it is fitted but never reported as a finding.
    pub nuisance: bool,
    /// The change that it makes.
    pub change: Change,
}

/// Change that a candidate makes.
pub enum Change {
    /// Changes the equations: another model with additional parameters.
    Model {
        /// The changed model.
        model: Box<dyn Model>,
        /// Parameters in addition to those of the base model.
        parameters: Vec<Added>,
    },
    /// Changes what a sensor shows.
    Sensor {
        /// Location of the sensor.
        location: String,
        /// Axis of the sensor; `None` for all sensors of the location together.
        axis: Option<Axis>,
        /// Form of the error.
        form: Form,
        /// Magnitude of the error.
        parameter: Added,
    },
}

/// A parameter of an effect.
#[derive(Clone, Debug, PartialEq)]
pub struct Added {
    /// Name in the changed model.
    pub name: String,
    /// Name in the effect.
    pub effect_name: String,
    /// Start value of a search, SI.
    pub start: f64,
    /// Plausible range, SI; lower bound first.
    pub range: (f64, f64),
    /// True if the parameter is fixed at its start value or at a vehicle value.
    pub known: bool,
    /// Role of the parameter in its effect.
    pub role: ParameterRole,
    /// True if its unit has kg once, as those of a mass, stiffness, damping and force do.
    pub scales_force: bool,
}

impl Candidate {
    /// True if it changes only a sensor.
    pub fn is_sensor(&self) -> bool {
        matches!(self.change, Change::Sensor { .. })
    }

    /// The parameters of the candidate.
    pub fn parameters(&self) -> &[Added] {
        match &self.change {
            Change::Model { parameters, .. } => parameters,
            Change::Sensor { parameter, .. } => std::slice::from_ref(parameter),
        }
    }

    /// Number of its free parameters.
    pub fn unknowns(&self) -> usize {
        self.parameters().iter().filter(|parameter| !parameter.known).count()
    }
}

/// A model and the candidates for what it lacks.
pub trait Workshop: Send + Sync {
    /// The model.
    fn model(&self) -> &dyn Model;

    /// Every effect at every place where it applies, in each form.
    fn candidates(&self) -> Vec<Candidate>;

    /// The candidates of one effect or law.
    fn candidates_of(&self, effect: &str) -> Vec<Candidate>;

    /// Every law without a named cause at every place where it applies: a curve of travel, speed or frequency with free
    /// coefficients.
    fn laws(&self) -> Vec<Candidate>;

    /// The workshop with an effect or such a law in its model; `None` for a sensor error, which changes no model.
    fn with(&self, effect: &str, at: &str, form: Option<&str>) -> Option<Box<dyn Workshop>>;
}
