//! Functions that are also generated over vectors, and the types by which the runtime calls them.

use qcar_model::About;

use crate::back::straight::{Function, Straight, response_name};

use super::function::{Form, function, sets};
use super::names::camel;

/// The functions of several parameter sets other than responses.
const SETS: [&str; 6] = [
    "prepare",
    "derivative",
    "matrices",
    "sensitivities",
    "contact_force",
    "rolling_derivative",
];

/// Functions over vectors, and the types by which the runtime calls them.
#[derive(Default)]
pub struct Vectors {
    /// Those over four numbers and over eight.
    pub wide: Vec<String>,
    /// Those over four alone.
    pub fours: Vec<String>,
    /// The types.
    pub types: String,
}

/// The functions of several parameter sets and of lines of a response.
///
/// A response to a force is generated over four numbers only: with vectors of eight for all responses, rustc would take
/// a quarter longer, and most fits use responses to a road.
pub fn vectors(straight: &Straight, functions: &[Function], about: &About) -> Vectors {
    let mut vectors = Vectors::default();
    for own in functions {
        if SETS.contains(&own.name.as_str()) {
            vectors.wide.push(function(straight, own, Form::Sets));
            vectors.types += &called_for_sets(own);
        } else if let Some((outputs, road)) = response(about, own) {
            let to = if road { &mut vectors.wide } else { &mut vectors.fours };
            to.push(function(straight, own, Form::Lines(outputs)));
            vectors.types += &called_for_lines(own, outputs, road);
        }
    }
    vectors
}

/// Number of outputs of a response, and true if it is a response to a road; `None` for another function.
fn response(about: &About, function: &Function) -> Option<(usize, bool)> {
    let mut responses = about.responses.iter().enumerate();
    let (place, layout) = responses.find(|(place, _)| {
        let is = |suffix| response_name(about, *place, suffix) == function.name;
        is("") || is("_jacobian")
    })?;
    Some((layout.outputs.len(), about.excitations[place].road))
}

fn called_for_lines(function: &Function, outputs: usize, road: bool) -> String {
    let (name, results) = (&function.name, function.program.outputs.len());
    let (four, eight) = match road {
        true => (format!("wide::four::{name}"), format!("Some(wide::eight::{name})")),
        false => (format!("fours::{name}"), "None".to_string()),
    };
    format!(
        "
struct {type_name};

impl Responds<CONSTANTS, {outputs}, {results}> for {type_name} {{
    const FOUR: OverLines<Four, CONSTANTS, {outputs}, {results}> = {four};
    const EIGHT: Option<OverLines<Eight, CONSTANTS, {outputs}, {results}>> = {eight};

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
    const FOUR: unsafe fn(&Self, usize, &mut [interface::Lanes; {results}]) = wide::four::{name};
    const EIGHT: unsafe fn(&Self, usize, &mut [interface::Lanes; {results}]) = wide::eight::{name};

    fn one(&self, set: usize, out: &mut [f64; {results}]) {{
        straight::{name}({of_one}, out);
    }}
}}
",
        type_name = sets(function),
        of_one = of_one.join(", "),
    )
}

/// The type of an argument for several parameter sets.
fn field(argument: &str) -> &'static str {
    match argument {
        "p" => "[interface::Lanes; PARAMETERS]",
        "constants" => "[interface::Lanes; CONSTANTS]",
        "x" => "[interface::Lanes; STATES]",
        "u" => "[interface::Lanes; INPUTS]",
        "contact" => "interface::Contacts",
        _ => "interface::Lanes",
    }
}

/// The expression of an argument for one of several parameter sets.
fn of_one(argument: &str) -> String {
    match argument {
        "contact" => "&self.contact.get(set)".into(),
        "s" | "v" => format!("self.{argument}[set]"),
        rows => format!("&one(self.{rows}, set)"),
    }
}
