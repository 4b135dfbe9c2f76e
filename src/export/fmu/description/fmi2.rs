//! Of FMI 2.0, where variables are counted from 1.

use super::{TOOL, between, depending, document, identity, quantity};
use crate::export::Subject;
use crate::export::fmu::dependencies::Dependencies;
use crate::export::fmu::variables::Variables;
use crate::export::fmu::xml::{around, element};

const MODEL_EXCHANGE: &[(&str, &str)] = &[("completedIntegratorStepNotNeeded", "true")];
const CO_SIMULATION: &[(&str, &str)] = &[
    ("canHandleVariableCommunicationStepSize", "true"),
    ("canInterpolateInputs", "true"),
];

/// The description of a model for both kinds of the interface.
pub fn description(subject: Subject, variables: &Variables, token: &str, compiled: &[String]) -> String {
    let about = &subject.compiled.about;
    let attributes = [
        ("fmiVersion", "2.0".into()),
        ("modelName", about.name.to_string()),
        ("guid", token.into()),
        ("description", about.doc.to_string()),
        ("generationTool", TOOL.into()),
        ("variableNamingConvention", "flat".into()),
        ("numberOfEventIndicators", variables.kinks.to_string()),
    ];
    let kinds = [
        kind("ModelExchange", (&about.name, variables), MODEL_EXCHANGE, compiled),
        kind("CoSimulation", (&about.name, variables), CO_SIMULATION, compiled),
    ];
    let model = [
        around("ModelVariables", &[], &scalars(variables)),
        around(
            "ModelStructure",
            &[],
            &structure(variables, &Dependencies::of(subject, variables)),
        ),
    ];
    let content: Vec<String> = kinds.into_iter().chain(between(variables)).chain(model).collect();
    document(&attributes, &content)
}

fn kind(name: &str, (model, variables): (&str, &Variables), own: &[(&str, &str)], compiled: &[String]) -> String {
    let common = [
        ("modelIdentifier", model),
        ("canGetAndSetFMUstate", "true"),
        ("canSerializeFMUstate", "true"),
        (
            "providesDirectionalDerivative",
            if variables.rolls { "false" } else { "true" },
        ),
    ];
    let attributes = common.iter().chain(own).map(|&(name, value)| (name, value.into()));
    let attributes: Vec<(&str, String)> = attributes.collect();
    let file = |name: &String| element("File", &[("name", name.clone())]);
    let files: Vec<String> = compiled.iter().map(file).collect();
    around(name, &attributes, &[around("SourceFiles", &[], &files)])
}

/// Kinks have no variables, only a number.
fn scalars(variables: &Variables) -> Vec<String> {
    let exposed = variables.all.iter().take(variables.first_kink()).enumerate();
    exposed
        .map(|(reference, own)| {
            let real = element("Real", &quantity(own, variables, 1));
            around("ScalarVariable", &identity(reference, own), &[real])
        })
        .collect()
}

fn structure(variables: &Variables, dependencies: &Dependencies) -> Vec<String> {
    let initial = variables.first_derivative()..variables.first_kink();
    let initial = initial.map(|reference| element("Unknown", &[("index", (reference + 1).to_string())]));
    let unknown = |first, dependencies| depending("Unknown", "index", first, 1, dependencies);
    let parts = [
        ("Outputs", unknown(variables.first_output(), &dependencies.outputs)),
        (
            "Derivatives",
            unknown(variables.first_derivative(), &dependencies.derivatives),
        ),
        ("InitialUnknowns", initial.collect()),
    ];
    let filled = parts.iter().filter(|(_, unknowns)| !unknowns.is_empty());
    filled.map(|(name, unknowns)| around(name, &[], unknowns)).collect()
}
