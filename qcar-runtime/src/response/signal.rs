//! Position of a measured signal among the rows of a response.

use crate::error::{Place, Problem};
use crate::model::{About, Channel, Excitation, Quantity, ResponseLayout, Signal, SignalKind};
use std::path::Path;
use thiserror::Error;

/// A signal under one excitation: a row of its response, or the excitation itself, times a power of jω.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Term {
    /// The row, counted as in [`ResponseLayout::outputs`]; `None` for the excitation itself.
    pub row: Option<usize>,
    /// The power of jω: differentiation of a motion that the model has as position or velocity, or integration.
    pub power: i32,
}

/// Reason why a model cannot give a signal.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum SignalError {
    /// There is no such mass, link or excitation.
    #[error(
        "model `{model}` has no `{location}` along {axis}; it has {known}. Choose a model that has it, or leave the channel out"
    )]
    Unknown {
        /// The requested location.
        location: String,
        /// The axis.
        axis: String,
        /// The model's name.
        model: String,
        /// The locations that exist.
        known: String,
    },
    /// The location exists, but no output gives this quantity.
    #[error(
        "model `{model}` does not output the {quantity} of `{location}`; add `output {location}.{quantity};` to it"
    )]
    NoOutput {
        /// The location.
        location: String,
        /// The quantity.
        quantity: &'static str,
        /// The model's name.
        model: String,
    },
    /// The signal is zero at every frequency.
    #[error(
        "in model `{model}`, `{location}` does not move along {axis} when `{excitation}` does; leave the channel out"
    )]
    Silent {
        /// The location.
        location: String,
        /// The axis.
        axis: String,
        /// The excitation.
        excitation: String,
        /// The model's name.
        model: String,
    },
}

impl SignalError {
    /// Converts it to a problem of the file that names `channel`.
    pub fn problem(&self, file: &Path, channel: &str) -> Problem {
        let (found, expected, remedy) = match self {
            Self::Unknown {
                location,
                axis,
                model,
                known,
            } => (
                format!("`{location}` along {axis}"),
                format!("a place of model `{model}`, which has {known}"),
                "choose a model that has it, or leave the channel out".to_owned(),
            ),
            Self::NoOutput {
                location,
                quantity,
                model,
            } => (
                format!("the {quantity} of `{location}`"),
                format!("an output of model `{model}`"),
                format!("add `output {location}.{quantity};` to the model"),
            ),
            Self::Silent {
                location,
                axis,
                excitation,
                model,
            } => (
                format!("`{location}`, which does not move along {axis} in model `{model}`"),
                format!("a place that moves when `{excitation}` does"),
                "leave the channel out".to_owned(),
            ),
        };
        Problem::new(file, Place::Name(channel.to_owned()), found, expected, remedy)
    }
}

/// The excitation of a channel: the one in its denominator, else the road along the same axis, else any excitation
/// along it.
pub fn driver(about: &About, channel: &Channel) -> Option<usize> {
    let below = &channel.denominator;
    let along = || {
        about
            .excitations
            .iter()
            .enumerate()
            .filter(|(_, own)| own.axis == below.axis)
    };
    let named = along().find(|(_, own)| own.name == below.location);
    let found = named
        .or_else(|| along().find(|(_, own)| own.road))
        .or_else(|| along().next());
    found.map(|(place, _)| place)
}

/// Finds `signal` in the response to `excitation`.
///
/// # Errors
/// Fails if the model has no such location, no such output, or no response of it.
pub fn locate(about: &About, layout: &ResponseLayout, excitation: usize, signal: &Signal) -> Result<Term, SignalError> {
    let source = &about.excitations[excitation];
    if let Some(power) = power_of_excitation(source, signal) {
        return Ok(Term { row: None, power });
    }
    let (output, power) = output_of(about, signal)?;
    match layout.outputs.iter().position(|&row| usize::from(row) == output) {
        Some(row) => Ok(Term { row: Some(row), power }),
        None => Err(SignalError::Silent {
            location: signal.location.to_string(),
            axis: signal.axis.to_string(),
            excitation: source.name.to_string(),
            model: about.name.to_string(),
        }),
    }
}

/// The output from which `signal` follows, and the power of jω between them.
///
/// # Errors
/// Fails if the model has no such location, or no such output.
pub fn output_of(about: &About, signal: &Signal) -> Result<(usize, i32), SignalError> {
    best_output(about, signal).ok_or_else(|| missing(about, signal))
}

fn power_of_excitation(source: &Excitation, signal: &Signal) -> Option<i32> {
    let here = source.name == signal.location && source.axis == signal.axis;
    match signal.kind {
        SignalKind::Motion(quantity) if here && !source.force => Some(order(quantity)),
        SignalKind::Force if here && source.force => Some(0),
        _ => None,
    }
}

/// The output with this signal, or with another derivative of the same motion, and the power of jω between them.
fn best_output(about: &About, signal: &Signal) -> Option<(usize, i32)> {
    let powers = about.outputs.iter().enumerate().filter_map(|(place, output)| {
        let here = output.signal.location == signal.location && output.signal.axis == signal.axis;
        let power = match (signal.kind, output.signal.kind) {
            (SignalKind::Motion(wanted), SignalKind::Motion(found)) => order(wanted) - order(found),
            (wanted, found) if wanted == found => 0,
            _ => return None,
        };
        here.then_some((place, power))
    });
    powers.min_by_key(|&(_, power)| power.abs())
}

fn order(quantity: Quantity) -> i32 {
    match quantity {
        Quantity::Position => 0,
        Quantity::Velocity => 1,
        Quantity::Acceleration => 2,
    }
}

/// Reason why a signal is not found: the model has no such location, or no such quantity of it.
pub fn missing(about: &About, signal: &Signal) -> SignalError {
    let model = about.name.to_string();
    let location = signal.location.to_string();
    let known = places(about, &signal.axis);
    if known.iter().any(|place| *place == signal.location) {
        SignalError::NoOutput {
            location,
            quantity: signal.kind.word(),
            model,
        }
    } else {
        let known = known
            .iter()
            .map(|place| format!("`{place}`"))
            .collect::<Vec<_>>()
            .join(", ");
        let known = if known.is_empty() {
            "nothing there".to_owned()
        } else {
            known
        };
        SignalError::Unknown {
            location,
            axis: signal.axis.to_string(),
            model,
            known,
        }
    }
}

/// The masses, links and excitations along an axis, each once.
pub fn places<'a>(about: &'a About, axis: &str) -> Vec<&'a str> {
    let outputs = about
        .outputs
        .iter()
        .filter(|o| o.signal.axis == axis)
        .map(|o| &*o.signal.location);
    let links = about.links.iter().filter(|l| l.axis == axis);
    let ends = links.clone().flat_map(|l| l.ends.iter()).map(|end| &**end);
    let excitations = about.excitations.iter().filter(|e| e.axis == axis).map(|e| &*e.name);
    let mut all: Vec<&str> = Vec::new();
    for place in outputs
        .chain(ends)
        .chain(links.clone().map(|l| &*l.name))
        .chain(excitations)
    {
        if !all.contains(&place) {
            all.push(place);
        }
    }
    all
}
