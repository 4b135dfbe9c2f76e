//! The description of a model as JSON, from which the Python side makes its named tuples.

use qcar::state_space::{InputName, OutputName, StateName, input_name, output_name, state_name};
use qcar_runtime::model::{About, Default, Parameter};
use serde::Serialize;

#[derive(Serialize)]
struct Described<'a> {
    name: &'a str,
    doc: &'a str,
    linear: bool,
    parameters: Vec<Named<'a>>,
    states: Vec<StateName>,
    inputs: Vec<InputName>,
    outputs: Vec<OutputName>,
    excitations: Vec<Drives<'a>>,
    channels: Vec<&'a str>,
}

#[derive(Serialize)]
struct Named<'a> {
    name: &'a str,
    unit: &'a str,
    doc: &'a str,
    default: Option<f64>,
    same_as: Option<&'a str>,
    range: Option<(f64, f64)>,
    known: bool,
}

#[derive(Serialize)]
struct Drives<'a> {
    name: &'a str,
    axis: &'a str,
    kind: &'static str,
    unit: &'static str,
}

/// The description of a model.
pub fn described(about: &About) -> String {
    let drives = about.excitations.iter().map(|own| Drives {
        name: &own.name,
        axis: &own.axis,
        kind: match (own.force, own.road) {
            (true, _) => "force",
            (false, true) => "road",
            (false, false) => "motion",
        },
        unit: if own.force { "N" } else { "m" },
    });
    let described = Described {
        name: &about.name,
        doc: &about.doc,
        linear: about.linear,
        parameters: about.parameters.iter().map(|own| parameter(about, own)).collect(),
        states: about.states.iter().map(state_name).collect(),
        inputs: about.inputs.iter().map(|own| input_name(about, own)).collect(),
        outputs: about.outputs.iter().map(output_name).collect(),
        excitations: drives.collect(),
        channels: about.channels.iter().map(|own| &*own.name).collect(),
    };
    qcar::json::line(&described)
}

fn parameter<'a>(about: &'a About, of: &'a Parameter) -> Named<'a> {
    let (default, same_as) = match of.default {
        Default::None => (None, None),
        Default::Value(value) => (Some(value), None),
        Default::Same(other) => (None, Some(&*about.parameters[usize::from(other)].name)),
    };
    Named {
        name: &of.name,
        unit: &of.unit,
        doc: &of.doc,
        default,
        same_as,
        range: of.range,
        known: of.known,
    }
}
