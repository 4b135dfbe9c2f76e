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

/// The functions, and the types by which the runtime calls them.
pub fn vectors(straight: &Straight, about: &About) -> (Vec<String>, String) {
    let functions = straight.functions("a line");
    let forms = functions.iter().filter_map(|own| Some((own, form(about, own)?)));
    let written = forms.map(|(own, form)| {
        let implementation = match form {
            Form::Lines(outputs) => of_lines(own, outputs),
            Form::Numbers | Form::Sets => of_sets(own),
        };
        (function(straight, own, form), implementation)
    });
    written.unzip()
}

/// The vectors over which a function is there, too.
fn form(about: &About, function: &Function) -> Option<Form> {
    if SETS.contains(&function.name.as_str()) {
        return Some(Form::Sets);
    }
    let mut responses = about.responses.iter().enumerate();
    let (_, layout) = responses.find(|(place, _)| {
        let is = |suffix| response_name(about, *place, suffix) == function.name;
        is("") || is("_jacobian")
    })?;
    Some(Form::Lines(layout.outputs.len()))
}

fn of_lines(function: &Function, outputs: usize) -> String {
    let (name, results) = (&function.name, function.program.outputs.len());
    format!(
        "
struct {type_name};

impl Responds<CONSTANTS, {outputs}, {results}> for {type_name} {{
    const FOUR: OverLines<Four, CONSTANTS, {outputs}, {results}> = vectors::four::{name};
    const EIGHT: OverLines<Eight, CONSTANTS, {outputs}, {results}> = vectors::eight::{name};

    fn one(constants: &[f64; CONSTANTS], omega: f64, out: &mut [f64; {results}]) {{
        straight::{name}(constants, omega, out);
    }}
}}
",
        type_name = camel(name),
    )
}

fn of_sets(function: &Function) -> String {
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
    const FOUR: unsafe fn(&Self, usize, &mut [seam::Lanes; {results}]) = vectors::four::{name};
    const EIGHT: unsafe fn(&Self, usize, &mut [seam::Lanes; {results}]) = vectors::eight::{name};

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
