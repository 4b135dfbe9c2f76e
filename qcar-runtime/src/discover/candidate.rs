//! What might be missing: a changed model, or a sensor that is wrong. Where candidates come from, the engine does not
//! know: a [`Workshop`] makes them from files.

use super::noise::Form;
use crate::campaign::Axis;
use crate::model::Model;
pub use crate::model::ParameterRole;

/// Something that might be missing, at a place.
pub struct Candidate {
    /// The name of the effect.
    pub effect: String,
    /// The link, mass or sensor location.
    pub at: String,
    /// Which of several ways in which the effect may act there; `None` where there is only one.
    pub form: Option<String>,
    /// What every real car has some of: it is fitted, and is no answer.
    pub nuisance: bool,
    /// What it would change.
    pub change: Change,
}

/// What a candidate changes.
pub enum Change {
    /// The equations: another model with parameters of its own.
    Model {
        /// The changed model.
        model: Box<dyn Model>,
        /// What it brings along beside the parameters of the base model.
        parameters: Vec<Added>,
    },
    /// What a sensor shows.
    Sensor {
        /// Its location.
        location: String,
        /// Its axis; `None` for all sensors of the location alike.
        axis: Option<Axis>,
        /// How it is wrong.
        form: Form,
        /// The number that says by how much.
        parameter: Added,
    },
}

/// A parameter that an effect brings along.
#[derive(Clone, Debug, PartialEq)]
pub struct Added {
    /// Its name in the changed model.
    pub name: String,
    /// Its name in the effect.
    pub effect_name: String,
    /// Where a search begins, SI.
    pub start: f64,
    /// What is plausible, SI, lower below upper.
    pub range: (f64, f64),
    /// Given, not to be found: it stays at its start, or at what the vehicle says.
    pub known: bool,
    /// What it is to its effect.
    pub role: ParameterRole,
}

impl Candidate {
    /// True where it changes no model.
    pub fn is_sensor(&self) -> bool {
        matches!(self.change, Change::Sensor { .. })
    }

    /// The parameters that it brings along.
    pub fn parameters(&self) -> &[Added] {
        match &self.change {
            Change::Model { parameters, .. } => parameters,
            Change::Sensor { parameter, .. } => std::slice::from_ref(parameter),
        }
    }

    /// How many of them are to be found.
    pub fn unknowns(&self) -> usize {
        self.parameters().iter().filter(|parameter| !parameter.known).count()
    }
}

/// A model and what might be missing in it.
pub trait Workshop: Send + Sync {
    /// The model.
    fn model(&self) -> &dyn Model;

    /// Every effect at every place where it applies, in each form.
    fn candidates(&self) -> Vec<Candidate>;

    /// Those of one effect or law.
    fn candidates_of(&self, effect: &str) -> Vec<Candidate>;

    /// Every law that names no cause, a curve of travel, speed or frequency whose coefficients are free, at every place
    /// where it applies.
    fn laws(&self) -> Vec<Candidate>;

    /// The same with an effect or such a law in the model; `None` for one of a sensor, which changes no model.
    fn with(&self, effect: &str, at: &str, form: Option<&str>) -> Option<Box<dyn Workshop>>;
}
