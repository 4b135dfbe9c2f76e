//! `modelDescription.xml`.

// The description of each FMI version.
pub mod fmi2;
pub mod fmi3;

use std::collections::BTreeMap;

use qcar_dsl::units::Unit;

use super::TOLERANCE;
use super::variables::{Role, Variable, Variables};
use super::xml::{around, element};

/// Attributes of a unit in every version.
const TOOL: &str = concat!("qcar ", env!("CARGO_PKG_VERSION"));

/// The whole file.
fn document(attributes: &[(&str, String)], content: &[String]) -> String {
    let root = around("fmiModelDescription", attributes, content);
    format!("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n{root}\n")
}

/// Units, categories of messages and the default experiment.
fn between(variables: &Variables) -> [String; 3] {
    let experiment = [("startTime", "0".into()), ("tolerance", format!("{TOLERANCE:e}"))];
    [
        around("UnitDefinitions", &[], &units(variables)),
        around(
            "LogCategories",
            &[],
            &[element("Category", &[("name", "logStatusError".into())])],
        ),
        element("DefaultExperiment", &experiment),
    ]
}

/// Each unit once, as whole powers of kg, m and s if possible.
fn units(variables: &Variables) -> Vec<String> {
    let units: BTreeMap<&str, Unit> = variables
        .all
        .iter()
        .map(|own| (own.unit.0.as_str(), own.unit.1))
        .collect();
    let unit = |(name, unit): (&str, Unit)| {
        let whole = unit.sixths.iter().all(|sixths| sixths % 6 == 0);
        let powers = ["kg", "m", "s"].into_iter().zip(unit.sixths);
        let powers = powers
            .filter(|(_, sixths)| *sixths != 0)
            .map(|(base, sixths)| (base, (sixths / 6).to_string()));
        let base = whole.then(|| element("BaseUnit", &powers.collect::<Vec<_>>()));
        around("Unit", &[("name", name.into())], base.as_slice())
    };
    units.into_iter().map(unit).collect()
}

/// Name, reference, description, causality, variability and initial.
fn identity(reference: usize, own: &Variable) -> Vec<(&'static str, String)> {
    let [causality, variability, initial] = match own.role {
        Role::Parameter => ["parameter", "tunable", "exact"],
        Role::Fixed => ["parameter", "fixed", "exact"],
        Role::Input => ["input", "continuous", ""],
        Role::State => ["local", "continuous", "exact"],
        Role::Derivative(_) | Role::Kink => ["local", "continuous", "calculated"],
        Role::Output => ["output", "continuous", "calculated"],
        Role::Time => ["independent", "continuous", ""],
    };
    vec![
        ("name", own.name.clone()),
        ("valueReference", reference.to_string()),
        ("description", own.description.clone()),
        ("causality", causality.into()),
        ("variability", variability.into()),
        ("initial", initial.into()),
    ]
}

/// Unit, start, nominal value and, for a derivative, the number of its state, counted from `first`.
fn quantity(own: &Variable, variables: &Variables, first: usize) -> Vec<(&'static str, String)> {
    let text = |number: Option<f64>| number.map_or(String::new(), |number| format!("{number:?}"));
    let state = match own.role {
        Role::Derivative(state) => (variables.first_state() + state + first).to_string(),
        _ => String::new(),
    };
    vec![
        ("unit", own.unit.0.clone()),
        ("start", text(own.start)),
        ("nominal", text(own.nominal())),
        ("derivative", state),
    ]
}

/// An element for each unknown: its number, and the numbers of its dependencies, all counted from `first`.
fn depending(name: &str, key: &str, unknown: usize, first: usize, dependencies: &[Vec<usize>]) -> Vec<String> {
    let line = |(place, on): (usize, &Vec<usize>)| {
        let on: Vec<String> = on.iter().map(|reference| (reference + first).to_string()).collect();
        // An empty list means no dependency; a missing list means that it is unknown.
        format!(
            "<{name} {key}=\"{}\" dependencies=\"{}\"/>",
            unknown + place + first,
            on.join(" ")
        )
    };
    dependencies.iter().enumerate().map(line).collect()
}
