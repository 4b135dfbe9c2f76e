//! What is unknown of an effect in a model, and what an explanation says of it.

use crate::discover::candidate::{Added, Candidate, Change, ParameterRole};
use crate::discover::noise::{Form, Nuisance};
use crate::discover::posterior::Explanation;

/// What is unknown of an effect in a model.
#[derive(Clone)]
pub struct Unknowns {
    all: Vec<Unknown>,
    /// The parameters of the model that say how much of it there is, not where it acts.
    magnitudes: Vec<String>,
}

/// A number that belongs to an effect, by its name in the effect.
#[derive(Clone)]
enum Unknown {
    /// A parameter of the model, by its name there.
    Parameter(String, String),
    /// A coefficient of the sensors' errors.
    Coefficient(String, usize, Form),
}

impl Unknowns {
    /// A candidate, with the sensors as it suspects them.
    pub fn new(candidate: &Candidate, nuisance: &Nuisance) -> Self {
        let unknowns = match &candidate.change {
            Change::Model { parameters, .. } => {
                let unknown = |p: &Added| Unknown::Parameter(p.effect_name.clone(), p.name.clone());
                parameters
                    .iter()
                    .filter(|own| own.role != ParameterRole::Clock)
                    .map(unknown)
                    .collect()
            }
            Change::Sensor { form, parameter, .. } => {
                let place = nuisance.of_sensors().saturating_sub(1);
                vec![Unknown::Coefficient(parameter.effect_name.clone(), place, *form)]
            }
        };
        let is_magnitude = |own: &&Added| !own.known && own.role != ParameterRole::Shape;
        let magnitudes = match &candidate.change {
            Change::Model { parameters, .. } => {
                parameters.iter().filter(is_magnitude).map(|p| p.name.clone()).collect()
            }
            Change::Sensor { .. } => Vec::new(),
        };
        Self {
            all: unknowns,
            magnitudes,
        }
    }

    /// True where a magnitude stands at an end of its range: the effect does duty for another. A shape may go to its limit.
    pub fn stands_at_an_end(&self, explanation: &Explanation) -> bool {
        self.magnitudes.iter().any(|name| is_at_end(explanation, name))
    }

    /// True where any of its parameters does, a shape too.
    pub fn reaches_an_end(&self, explanation: &Explanation) -> bool {
        self.all.iter().any(|unknown| match unknown {
            Unknown::Parameter(_, name) => is_at_end(explanation, name),
            Unknown::Coefficient(..) => false,
        })
    }

    /// What an explanation says of the effect: name, value, standard error, which is 0 for a value that is given.
    pub fn parameters(&self, explanation: &Explanation) -> Vec<(String, f64, f64)> {
        let refit = &explanation.refit;
        let errors = refit.stderr();
        let scatter = explanation.scatter().sqrt();
        let of = |unknown: &Unknown| match unknown {
            Unknown::Parameter(effect_name, name) => {
                let (_, value) = explanation.named.iter().find(|(known, _)| known == name)?;
                let error = free_of(explanation, name).map_or(0.0, |free| errors[free]);
                Some((effect_name.clone(), *value, error))
            }
            Unknown::Coefficient(effect_name, place, form) => {
                let coefficient = refit.coefficients[*place];
                let error = scatter * refit.coefficient_stderr[*place];
                let (value, error) = match form {
                    Form::Delay => (coefficient, error),
                    _ => (coefficient.exp(), coefficient.exp() * error),
                };
                Some((effect_name.clone(), value, error))
            }
        };
        self.all.iter().filter_map(of).collect()
    }
}

fn is_at_end(explanation: &Explanation, name: &str) -> bool {
    free_of(explanation, name).is_some_and(|free| explanation.refit.at_bound[free] != 0)
}

/// Place of a parameter among the free ones.
fn free_of(explanation: &Explanation, name: &str) -> Option<usize> {
    let place = explanation.named.iter().position(|(known, _)| known == name)?;
    explanation.refit.free.iter().position(|free| free.parameter == place)
}
