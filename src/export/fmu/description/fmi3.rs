//! Of FMI 3.0, where variables go by their references.

use super::{TOOL, between, depending, document, identity, quantity};
use crate::export::Subject;
use crate::export::fmu::dependencies::Dependencies;
use crate::export::fmu::variables::Variables;
use crate::export::fmu::xml::{around, element};

const MODEL_EXCHANGE: &[(&str, &str)] = &[("needsCompletedIntegratorStep", "false")];
const CO_SIMULATION: &[(&str, &str)] = &[("canHandleVariableCommunicationStepSize", "true")];

/// The description of a model for both kinds of the interface.
pub fn description(subject: Subject, variables: &Variables, token: &str) -> String {
    let about = &subject.compiled.about;
    let attributes = [
        ("fmiVersion", "3.0".into()),
        ("modelName", about.name.to_string()),
        ("instantiationToken", token.into()),
        ("description", about.doc.to_string()),
        ("generationTool", TOOL.into()),
        ("variableNamingConvention", "flat".into()),
    ];
    let kinds = [
        kind("ModelExchange", (&about.name, variables), MODEL_EXCHANGE),
        kind("CoSimulation", (&about.name, variables), CO_SIMULATION),
    ];
    let floats = variables.all.iter().enumerate().map(|(reference, own)| {
        let attributes = [identity(reference, own), quantity(own, variables, 0)].concat();
        element("Float64", &attributes)
    });
    let model = [
        around("ModelVariables", &[], &floats.collect::<Vec<_>>()),
        around(
            "ModelStructure",
            &[],
            &structure(variables, &Dependencies::of(subject, variables)),
        ),
    ];
    let content: Vec<String> = kinds.into_iter().chain(between(variables)).chain(model).collect();
    document(&attributes, &content)
}

/// How the sources are compiled: `buildDescription.xml`.
pub fn build_description(model: &str, compiled: &[String]) -> String {
    let file = |name: &String| element("SourceFile", &[("name", name.clone())]);
    let files: Vec<String> = compiled.iter().map(file).collect();
    let set = around("SourceFileSet", &[("language", "C99".into())], &files);
    let configuration = around("BuildConfiguration", &[("modelIdentifier", model.into())], &[set]);
    let root = around("fmiBuildDescription", &[("fmiVersion", "3.0".into())], &[configuration]);
    format!("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n{root}\n")
}

fn kind(name: &str, (model, variables): (&str, &Variables), own: &[(&str, &str)]) -> String {
    let common = [
        ("modelIdentifier", model),
        ("canGetAndSetFMUState", "true"),
        ("canSerializeFMUState", "true"),
        (
            "providesDirectionalDerivatives",
            if variables.rolls { "false" } else { "true" },
        ),
    ];
    let attributes = common.iter().chain(own).map(|&(name, value)| (name, value.into()));
    element(name, &attributes.collect::<Vec<_>>())
}

fn structure(variables: &Variables, dependencies: &Dependencies) -> Vec<String> {
    let unknown = |name, first, dependencies| depending(name, "valueReference", first, 0, dependencies);
    let initial = variables.first_derivative()..variables.first_kink();
    let initial = initial.map(|reference| element("InitialUnknown", &[("valueReference", reference.to_string())]));
    let first = variables.first_derivative();
    [
        unknown("Output", variables.first_output(), &dependencies.outputs),
        unknown("ContinuousStateDerivative", first, &dependencies.derivatives),
        initial.collect(),
        unknown("EventIndicator", variables.first_kink(), &dependencies.kinks),
    ]
    .concat()
}
