//! The functions that are there over vectors, too, and what the runtime needs to call them.

use qcar_model::About;

use crate::back::straight::{Function, Straight, response_name};

use super::function::{Form, function, sets};
use super::names::camel;

/// The functions of several parameter sets, beside the responses.
const SETS: [&str; 6] = [
    "prepare",
    "derivative",
    "matrices",
    "sensitivities",
    "contact_force",
    "rolling_derivative",
];

/// Functions over vectors, and the types by which the runtime calls them.
pub type Vectors = (Vec<String>, String);

/// Those of several parameter sets.
pub fn of_sets(straight: &Straight, functions: &[Function]) -> Vectors {
    let functions = functions.iter().filter(|own| SETS.contains(&own.name.as_str()));
    functions
        .map(|own| (function(straight, own, Form::Sets), called_for_sets(own)))
        .unzip()
}

/// Those of lines of a response.
pub fn of_lines(straight: &Straight, functions: &[Function], about: &About) -> Vectors {
    let lines = functions.iter().filter_map(|own| {
        let outputs = outputs(about, own)?;
        let written = function(straight, own, Form::Lines(outputs));
        Some((written, called_for_lines(own, outputs)))
    });
    lines.unzip()
}

/// How many outputs a response has.
fn outputs(about: &About, function: &Function) -> Option<usize> {
    let mut responses = about.responses.iter().enumerate();
    let (_, layout) = responses.find(|(place, _)| {
        let is = |suffix| response_name(about, *place, suffix) == function.name;
        is("") || is("_jacobian")
    })?;
    Some(layout.outputs.len())
}

fn called_for_lines(function: &Function, outputs: usize) -> String {
    let (name, results) = (&function.name, function.program.outputs.len());
    format!(
        "
struct {type_name};

impl Responds<CONSTANTS, {outputs}, {results}> for {type_name} {{
    const FOUR: unsafe fn(&[seam::Lanes; CONSTANTS], &seam::Lanes, usize, &mut LinesMut<'_, {outputs}, {results}>) = lines::{name};

    fn one(constants: &[f64; CONSTANTS], omega: f64, out: &mut [f64; {results}]) {{
        straight::{name}(constants, omega, out);
    }}
}}
",
        type_name = camel(name),
    )
}

fn called_for_sets(function: &Function) -> String {
    let (name, results) = (&function.name, function.program.outputs.len());
    let arguments = function.arguments.iter();
    let fields: String = arguments
        .clone()
        .map(|argument| format!("    {argument}: &'a {},\n", field(argument)))
        .collect();
    let of_one: Vec<String> = arguments.map(|argument| of_one(argument)).collect();
    format!(
        "
struct {type_name}<'a> {{
{fields}}}

impl Sets<{results}> for {type_name}<'_> {{
    const FOUR: unsafe fn(&Self, usize, &mut [seam::Lanes; {results}]) = sets::four::{name};
    const EIGHT: unsafe fn(&Self, usize, &mut [seam::Lanes; {results}]) = sets::eight::{name};

    fn one(&self, set: usize, out: &mut [f64; {results}]) {{
        straight::{name}({of_one}, out);
    }}
}}
",
        type_name = sets(function),
        of_one = of_one.join(", "),
    )
}

/// What an argument is of several parameter sets.
fn field(argument: &str) -> &'static str {
    match argument {
        "p" => "[seam::Lanes; PARAMETERS]",
        "constants" => "[seam::Lanes; CONSTANTS]",
        "x" => "[seam::Lanes; STATES]",
        "u" => "[seam::Lanes; INPUTS]",
        "contact" => "seam::Contacts",
        _ => "seam::Lanes",
    }
}

/// An argument of one of several parameter sets.
fn of_one(argument: &str) -> String {
    match argument {
        "contact" => "&self.contact.get(set)".into(),
        "s" | "v" => format!("self.{argument}[set]"),
        rows => format!("&one(self.{rows}, set)"),
    }
}
