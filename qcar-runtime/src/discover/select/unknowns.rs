//! The unknowns of an effect in a model, and their estimates.

use crate::discover::candidate::{Added, Candidate, Change, ParameterRole};
use crate::discover::noise::{Form, Nuisance};
use crate::discover::posterior::Explanation;

/// The unknowns of an effect in a model.
#[derive(Clone)]
pub struct Unknowns {
    all: Vec<Unknown>,
    /// Names of its free strengths, masses, stiffnesses, dampings and forces: they determine the size of the effect.
    magnitudes: Vec<String>,
    /// Names of its other free parameters that are no shapes.
    ratios: Vec<String>,
    /// The model parameter that is its strength, and the finite value at which the effect vanishes.
    strength: Option<(String, f64)>,
}

/// An unknown of an effect. The first string is its name in the effect.
#[derive(Clone)]
enum Unknown {
    /// A model parameter, with its name in the model.
    Parameter(String, String),
    /// A coefficient of the sensor errors, with its position among the coefficients and its form.
    Coefficient(String, usize, Form),
}

impl Unknowns {
    /// The unknowns of a candidate. `nuisance` must already contain the sensor error that the candidate adds.
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
        let is_ratio = |own: &Added| own.role == ParameterRole::Other && !own.scales_force;
        let (ratios, magnitudes) = match &candidate.change {
            Change::Model { parameters, .. } => {
                let (ratios, others): (Vec<&Added>, _) =
                    parameters.iter().filter(is_magnitude).partition(|own| is_ratio(own));
                (names(ratios), names(others))
            }
            Change::Sensor { .. } => Default::default(),
        };
        let strength = |own: &Added| match own.role {
            ParameterRole::Strength { vanishes_at } if vanishes_at.is_finite() => Some((own.name.clone(), vanishes_at)),
            _ => None,
        };
        let strength = match &candidate.change {
            Change::Model { parameters, .. } => parameters.iter().find_map(strength),
            Change::Sensor { .. } => None,
        };
        Self {
            all: unknowns,
            magnitudes,
            ratios,
            strength,
        }
    }

    /// Names of its model parameters, without clocks.
    pub fn parameter_names(&self) -> impl Iterator<Item = &str> {
        self.all.iter().filter_map(|unknown| match unknown {
            Unknown::Parameter(_, name) => Some(&**name),
            Unknown::Coefficient(..) => None,
        })
    }

    /// The changes of its unknowns that make the effect vanish, by position in the free parameters of a fit: that of
    /// the strength, and zero for the others. `None` if it vanishes at no finite value of a free parameter.
    pub fn removal(&self, explanation: &Explanation) -> Option<Vec<(usize, f64)>> {
        let (strength, vanishes_at) = self.strength.as_ref()?;
        let at = free_of(explanation, strength)?;
        let own = self.parameter_names().filter_map(|name| free_of(explanation, name));
        let change = |free| match free == at {
            true => vanishes_at - explanation.refit.estimate[free],
            false => 0.0,
        };
        Some(own.map(|free| (free, change(free))).collect())
    }

    /// True if a magnitude is at its bound, a sign that the effect imitates another: its strength, or another mass,
    /// stiffness, damping or force. Shape parameters are not counted.
    pub fn has_magnitude_at_bound(&self, explanation: &Explanation) -> bool {
        self.magnitudes.iter().any(|name| is_at_bound(explanation, name))
    }

    /// True if a free parameter that is neither a magnitude nor a shape is at its bound. A law with it may be that of a
    /// textbook, such as Bouc and Wen's with equal terms.
    pub fn has_ratio_at_bound(&self, explanation: &Explanation) -> bool {
        self.ratios.iter().any(|name| is_at_bound(explanation, name))
    }

    /// True if any parameter is at its bound, shape parameters included.
    pub fn has_parameter_at_bound(&self, explanation: &Explanation) -> bool {
        self.parameter_names().any(|name| is_at_bound(explanation, name))
    }

    /// True if the fitted runs determine none of its parameters: every standard error exceeds the value.
    pub fn are_undetermined(&self, explanation: &Explanation) -> bool {
        let parameters = self.parameters(explanation);
        let mut free = parameters.iter().filter(|(_, _, error)| *error != 0.0);
        // An error that is not a number is one of an undetermined parameter.
        free.clone().next().is_some() && free.all(|(_, value, error)| error.is_nan() || *error > value.abs())
    }

    /// Estimates of the effect: name, value and standard error, SI. The error is 0 for a fixed parameter.
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

fn names(of: Vec<&Added>) -> Vec<String> {
    of.into_iter().map(|own| own.name.clone()).collect()
}

fn is_at_bound(explanation: &Explanation, name: &str) -> bool {
    free_of(explanation, name).is_some_and(|free| explanation.refit.at_bound[free] != 0)
}

/// Position of a parameter among the free ones; `None` if it is fixed.
fn free_of(explanation: &Explanation, name: &str) -> Option<usize> {
    let place = explanation.named.iter().position(|(known, _)| known == name)?;
    explanation.refit.free.iter().position(|free| free.parameter == place)
}
