//! The rows of a template: facts of the vehicle, and the parameters of models in the groups of the thesis's table 3.1.

use qcar_runtime::campaign::{FACTS, unit_of_fact};
use qcar_runtime::model::{About, Default, Parameter};

/// Descriptions of the vehicle data, in the order of [`FACTS`].
const FACT_NAMES: [&str; 7] = [
    "Static mass carried by the tyre; if empty, half of the vehicle's mass on this axle",
    "Mass of one side of the vehicle; if empty, half of the whole",
    "Unsprung mass of the same side's other axle; if empty, that of this workbook",
    "Unloaded radius of the tyre",
    "Static load of the tyre",
    "Deflection of the tyre under its static load",
    "Acceleration of gravity",
];

/// The groups, in the order of the table.
pub(super) const GROUPS: [&str; 5] = ["Vehicle", "Masses", "Vertical", "Longitudinal", "Tyre"];

/// A value of each axle.
pub(super) struct Row {
    /// Index in [`GROUPS`].
    pub group: usize,
    /// Name in the model.
    pub name: String,
    /// Coherent SI unit.
    pub unit: String,
    /// Description.
    pub doc: String,
    /// Bounds of an estimate, SI; `None` for a known value.
    pub range: Option<(f64, f64)>,
    /// True if it may be estimated.
    pub estimated: bool,
    /// Value of the front axle, SI; `None` if it is not given.
    pub front: Option<f64>,
}

/// The vehicle data and every parameter of the models, group by group.
pub(super) fn rows<'a>(models: impl Iterator<Item = &'a About>) -> Vec<Row> {
    let mut rows: Vec<Row> = FACTS
        .into_iter()
        .zip(FACT_NAMES)
        .map(|(name, doc)| fact(name, doc))
        .collect();
    for parameter in models.flat_map(|about| about.parameters.iter()) {
        let is_own = !matches!(parameter.default, Default::Same(_));
        if is_own && rows.iter().all(|row| row.name != parameter.name) {
            rows.push(row(parameter));
        }
    }
    rows.sort_by_key(|row| row.group);
    rows
}

fn fact(name: &str, doc: &str) -> Row {
    Row {
        group: 0,
        name: name.into(),
        unit: unit_of_fact(name).unwrap_or("1").into(),
        doc: doc.into(),
        range: None,
        estimated: false,
        front: None,
    }
}

fn row(of: &Parameter) -> Row {
    Row {
        group: group(of),
        name: of.name.to_string(),
        unit: of.unit.to_string(),
        doc: of.doc.to_string(),
        range: of.range.filter(|_| !of.known),
        estimated: !of.known,
        front: None,
    }
}

fn group(of: &Parameter) -> usize {
    match () {
        () if of.unit == "kg" => 1,
        () if of.name.contains("tire") => 4,
        () if of.name.ends_with("_x") => 3,
        () => 2,
    }
}
