//! The parameter struct of a generated model.

use qcar_model::Parameter;

use crate::model::Default;
use crate::program::schedule::Compiled;

use super::names::identifier;

/// `pub struct Parameters`, with a documented field for each parameter, and its conversions.
pub fn parameters(compiled: &Compiled) -> String {
    let parameters = &compiled.about.parameters;
    let fields: Vec<String> = parameters.iter().map(|parameter| identifier(&parameter.name)).collect();
    let documented = |(parameter, field): (&Parameter, &String)| {
        format!("    /// {}\n    pub {field}: f64,\n", sentence(parameter, parameters))
    };
    let documented: String = parameters.iter().zip(&fields).map(documented).collect();
    let listed = |prefix: &str| {
        fields
            .iter()
            .map(|field| format!("{prefix}{field}"))
            .collect::<Vec<_>>()
            .join(", ")
    };
    let assigned = fields
        .iter()
        .enumerate()
        .map(|(place, field)| format!("{field}: values[{place}]"));
    let assigned = assigned.collect::<Vec<_>>().join(", ");
    let names = parameters
        .iter()
        .map(|parameter| format!("{:?}", parameter.name))
        .collect::<Vec<_>>()
        .join(", ");
    format!(
        "/// A parameter set, in SI.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Parameters {{
{documented}}}

impl Parameters {{
    /// The names, in the order of the model file.
    pub const NAMES: [&'static str; PARAMETERS] = [{names}];

    /// The values in the order of [`Parameters::NAMES`].
    pub const fn to_array(&self) -> [f64; PARAMETERS] {{
        [{}]
    }}

    /// From values in the order of [`Parameters::NAMES`].
    pub const fn from_array(values: [f64; PARAMETERS]) -> Parameters {{
        Parameters {{ {assigned} }}
    }}
}}
",
        listed("self."),
    ) + &defaults(parameters).unwrap_or_default()
}

/// `impl Default`; `None` if a parameter of the model has no default.
fn defaults(parameters: &[Parameter]) -> Option<String> {
    let assigned = parameters.iter().map(|parameter| {
        let value = default(parameter, parameters)?;
        Some(format!("            {}: {value:?},\n", identifier(&parameter.name)))
    });
    let assigned = assigned.collect::<Option<String>>()?;
    Some(format!(
        "
impl ::std::default::Default for Parameters {{
    /// The values of the model file.
    fn default() -> Parameters {{
        Parameters {{
{assigned}        }}
    }}
}}
"
    ))
}

/// The default in the model file: a value, or that of the parameter to which it refers.
fn default(parameter: &Parameter, all: &[Parameter]) -> Option<f64> {
    match parameter.default {
        Default::None => None,
        Default::Value(value) => Some(value),
        Default::Same(other) => default(&all[other as usize], all),
    }
}

/// `Stiffness of the tyre, N/m; from 50000 to 1000000; 200000 unless given.`
fn sentence(parameter: &Parameter, all: &[Parameter]) -> String {
    let mut text = match parameter.doc.is_empty() {
        true => parameter.unit.to_string(),
        false => format!("{}, {}", parameter.doc.trim_end_matches('.'), parameter.unit),
    };
    if let Some((low, high)) = parameter.range {
        text += &format!("; from {low} to {high}");
    }
    match parameter.default {
        Default::None => {}
        Default::Value(value) => text += &format!("; {value} unless given"),
        Default::Same(other) => text += &format!("; as `{}` unless given", all[other as usize].name),
    }
    text + "."
}
