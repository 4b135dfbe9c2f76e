//! The workbook that a campaign refers to. Values of the campaign take precedence over those of the workbook.

use std::path::Path;

use super::super::contents::{Parameter, Road, Run};
use super::super::fields::Section;
use super::super::recorded::Files;
use super::super::workbook::{Entry, Workbook};

/// The workbook; `None` if none is named or it cannot be read.
pub(super) fn named(folder: &Path, top: &Section<'_>, files: &Files) -> Option<Workbook> {
    let axle = top.optional_text("axle");
    let Some(named) = top.optional_text("workbook") else {
        if axle.is_some() {
            top.wrong(
                "axle",
                "no `workbook`",
                "`workbook = \"vehicle.xlsx\"` as well",
                "add it, or remove `axle`",
            );
        }
        return None;
    };
    let read = Workbook::known(&folder.join(&named), &named, axle.as_deref(), files);
    read.map_err(|error| top.adopt(error)).ok()
}

/// The model of the campaign, which its workbook may name. An unreadable workbook counts as one that names it.
pub(super) fn model(top: &Section<'_>, workbook: Option<&Workbook>) -> Option<String> {
    match workbook {
        None if top.has("workbook") => top.optional_text("model"),
        Some(workbook) if workbook.model.is_some() && !top.has("model") => workbook.model.clone(),
        _ => top.text("model"),
    }
}

impl Workbook {
    pub(super) fn with_roads(&self, mut roads: Vec<Road>) -> Vec<Road> {
        let is_new = |road: &&Road| roads.iter().all(|own| own.name != road.name);
        let others: Vec<Road> = self.roads.iter().filter(is_new).cloned().collect();
        roads.extend(others);
        roads
    }

    pub(super) fn with_runs(&self, mut runs: Vec<Run>) -> Vec<Run> {
        runs.extend(self.runs.iter().cloned());
        runs
    }

    pub(super) fn with_facts(&self, mut facts: Vec<(String, f64)>) -> Vec<(String, f64)> {
        let is_new = |entry: &&Entry| facts.iter().all(|(name, _)| *name != entry.name);
        let others: Vec<_> = self
            .vehicle
            .iter()
            .filter(is_new)
            .map(|own| (own.name.clone(), own.value))
            .collect();
        facts.extend(others);
        facts
    }

    /// `facts` are the vehicle data of the campaign, which may be parameters of the model.
    pub(super) fn with_parameters(&self, mut parameters: Vec<Parameter>, facts: &[(String, f64)]) -> Vec<Parameter> {
        let is_new = |entry: &&Entry| {
            let stated = parameters.iter().map(|own| &own.name);
            stated
                .chain(facts.iter().map(|(name, _)| name))
                .all(|name| *name != entry.name)
        };
        let others: Vec<Parameter> = self.parameters.iter().filter(is_new).map(Parameter::from).collect();
        parameters.extend(others);
        parameters
    }
}

impl From<&Entry> for Parameter {
    fn from(of: &Entry) -> Self {
        Parameter {
            name: of.name.clone(),
            value: of.value,
            unit: of.unit.clone(),
            range: of.range,
            fit: of.fit,
            comment: of.comment.clone(),
        }
    }
}
