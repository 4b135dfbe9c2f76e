//! A value for every parameter of a model, from given values, vehicle data and defaults.

use crate::bounded;
use crate::error::{Place, Problem};
use crate::model::{About, Clock, Default};
use crate::spelling::nearest;
use std::collections::BTreeMap;
use std::path::Path;
use thiserror::Error;

/// A value for every parameter, and the ties between them.
#[derive(Clone, Debug, PartialEq)]
pub struct Values {
    p: Vec<f64>,
    /// For each parameter the one whose value it takes: itself, unless its default ties it to another.
    leader: Vec<usize>,
    /// Clock parameters, which are the time since the start of a run.
    clocks: Vec<(usize, Clock)>,
}

/// Reason why a parameter has no value.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum ParameterError {
    /// The model has no such parameter.
    #[error("model `{model}` has no parameter `{name}`; {}", unknown_remedy(.nearest))]
    Unknown {
        /// As given by the user.
        name: String,
        /// The model's name.
        model: String,
        /// The model's parameter with the most similar name.
        nearest: Option<String>,
    },
    /// The parameter has neither a value nor a default.
    #[error("model `{model}` needs `{name}` ({doc}), which has no value and no default; give it one in {unit}")]
    Missing {
        /// The parameter.
        name: String,
        /// The model's name.
        model: String,
        /// Its unit.
        unit: String,
        /// Its description.
        doc: String,
    },
    /// The value is not a number.
    #[error("`{name}` is {value}; give it a finite number")]
    NotFinite {
        /// The parameter.
        name: String,
        /// As given by the user.
        value: f64,
    },
}

impl ParameterError {
    /// The name of the parameter.
    pub fn name(&self) -> &str {
        match self {
            Self::Unknown { name, .. } | Self::Missing { name, .. } | Self::NotFinite { name, .. } => name,
        }
    }

    /// Converts it to a problem of the file that gives the values.
    pub fn problem(&self, file: &Path) -> Problem {
        let (found, expected, remedy) = match self {
            Self::Unknown { model, nearest, .. } => (
                "this parameter".to_owned(),
                format!("a parameter of model `{model}`"),
                unknown_remedy(nearest),
            ),
            Self::Missing { name, model, unit, doc } => (
                "no value".to_owned(),
                format!("a value in {unit} ({doc}), since model `{model}` has no default for it"),
                missing_remedy(name, file),
            ),
            Self::NotFinite { value, .. } => (
                value.to_string(),
                "a finite number".to_owned(),
                "correct the value".to_owned(),
            ),
        };
        Problem::new(file, Place::Name(self.name().to_owned()), found, expected, remedy)
    }
}

/// A campaign of `qcar new` or `qcar import` has a line to fill in, as a comment.
fn missing_remedy(name: &str, file: &Path) -> String {
    let line = format!("# {name} =");
    let is_given = bounded::text(file).is_ok_and(|text| text.lines().any(|own| own.trim().starts_with(&line)));
    match is_given {
        true => format!("fill in the line `{line}`"),
        false => format!("add a table [parameters.{name}]"),
    }
}

fn unknown_remedy(nearest: &Option<String>) -> String {
    match nearest {
        Some(nearest) => {
            format!("did you mean `{nearest}`? Otherwise remove it, or choose the model that it belongs to")
        }
        None => "remove it, or choose the model that it belongs to".to_owned(),
    }
}

impl Values {
    /// Takes the value of every parameter of the model from `given`, else from `vehicle`, else from its default.
    ///
    /// All names in `given` must be parameters of the model; `vehicle` may have others, since it describes the car.
    ///
    /// # Errors
    /// Fails with every name that is not a parameter of the model, and every parameter that has no value or whose value
    /// is not finite.
    pub fn resolve(
        about: &About,
        given: &BTreeMap<String, f64>,
        vehicle: &BTreeMap<String, f64>,
    ) -> Result<Self, Vec<ParameterError>> {
        let mut errors: Vec<_> = given.keys().filter_map(|name| unknown(about, name)).collect();
        let stated: Vec<Option<f64>> = about
            .parameters
            .iter()
            .map(|p| given.get(&*p.name).or_else(|| vehicle.get(&*p.name)).copied())
            .collect();
        let leader: Vec<usize> = (0..stated.len()).map(|k| leader(about, &stated, k)).collect();
        let p = leader
            .iter()
            .map(|&k| stated[k].or(default(about, k)).unwrap_or(f64::NAN))
            .collect();
        errors.extend((0..stated.len()).filter_map(|k| invalid(about, k, leader[k] == k, stated[k])));
        if errors.is_empty() {
            let clocks = about.parameters.iter().enumerate();
            let clocks = clocks.filter_map(|(k, own)| Some((k, own.clock?))).collect();
            Ok(Self { p, leader, clocks })
        } else {
            Err(errors)
        }
    }

    /// All values, in the order of the model.
    pub fn as_slice(&self) -> &[f64] {
        &self.p
    }

    /// The parameter whose value this one takes: itself unless it is tied.
    pub fn leader(&self, parameter: usize) -> usize {
        self.leader[parameter]
    }

    /// The parameters that take the value of this one, itself included.
    pub fn tied_to(&self, parameter: usize) -> Vec<usize> {
        (0..self.leader.len())
            .filter(|&k| self.leader[k] == parameter)
            .collect()
    }

    /// True if the model has clock parameters, so that it changes during a run.
    pub fn have_clocks(&self) -> bool {
        !self.clocks.is_empty()
    }

    /// The values at the fraction `part` of a run of the duration `length` (s).
    pub fn at_part(&self, part: f64, length: f64) -> Self {
        let mut then = self.clone();
        for &(place, clock) in &self.clocks {
            then.p[place] = match clock {
                Clock::Seconds => part * length,
                Clock::PartOfRun => part,
            };
        }
        then
    }

    /// Changes a parameter together with all that are tied to it.
    pub fn set(&mut self, parameter: usize, value: f64) {
        for (p, leader) in self.p.iter_mut().zip(&self.leader) {
            if *leader == parameter {
                *p = value;
            }
        }
    }
}

/// Follows ties up to a parameter that is given or has a default of its own.
fn leader(about: &About, stated: &[Option<f64>], parameter: usize) -> usize {
    let mut at = parameter;
    // After as many steps as there are parameters, every chain has ended, unless it is circular.
    for _ in 0..stated.len() {
        match about.parameters[at].default {
            Default::Same(other) if stated[at].is_none() => at = usize::from(other),
            _ => return at,
        }
    }
    at
}

fn default(about: &About, parameter: usize) -> Option<f64> {
    match about.parameters[parameter].default {
        Default::Value(value) => Some(value),
        Default::None | Default::Same(_) => None,
    }
}

fn invalid(about: &About, k: usize, leads: bool, stated: Option<f64>) -> Option<ParameterError> {
    let parameter = &about.parameters[k];
    match stated.or(default(about, k)) {
        Some(value) if value.is_finite() => None,
        Some(value) => Some(ParameterError::NotFinite {
            name: parameter.name.to_string(),
            value,
        }),
        None if !leads => None,
        None => Some(ParameterError::Missing {
            name: parameter.name.to_string(),
            model: about.name.to_string(),
            unit: parameter.unit.to_string(),
            doc: parameter.doc.to_string(),
        }),
    }
}

fn unknown(about: &About, name: &str) -> Option<ParameterError> {
    if about.parameters.iter().any(|p| p.name == name) {
        return None;
    }
    let known = about.parameters.iter().map(|p| &*p.name);
    Some(ParameterError::Unknown {
        name: name.to_owned(),
        model: about.name.to_string(),
        nearest: nearest(name, known).map(String::from),
    })
}
