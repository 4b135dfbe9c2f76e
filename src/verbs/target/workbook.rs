//! The result as a workbook: targets, parameters, and the designs of the front.

use std::path::Path;

use qcar_runtime::error::InputError;
use rust_xlsxwriter::{Workbook, XlsxError};

use super::gather::{Answer, FrontAnswer, Target};
use crate::files::put;
use crate::spreadsheet::{Cell, filled, table};
use crate::units;
use crate::verbs::fit::workbook::FILE;

/// Writes the workbook into a folder.
///
/// # Errors
/// Fails if the folder cannot be written to.
pub(super) fn write(of: &Answer, folder: &Path) -> Result<(), InputError> {
    let bytes = filled(&folder.join(FILE), |workbook| {
        targets(workbook, of)?;
        parameters(workbook, of)?;
        let front = of.front.as_ref().filter(|front| !front.points.is_empty());
        front.map_or(Ok(()), |front| designs(workbook, of, front))
    })?;
    put(folder, FILE, &bytes)
}

fn targets(workbook: &mut Workbook, of: &Answer) -> Result<(), XlsxError> {
    let headings = [
        "target",
        "run",
        "unit",
        "sense",
        "limit",
        "today",
        "design",
        "met",
        "beyond_%",
        "multiplier",
        "in_space_%",
        "lower_95_%",
        "upper_95_%",
        "holds_%",
    ];
    let rows = of.targets.iter().map(|own| {
        let shown = |value: f64| Cell::from(units::value(value, &own.unit));
        vec![
            own.metric.as_str().into(),
            own.run.as_deref().unwrap_or("").into(),
            units::name(&own.unit).into(),
            own.sense.into(),
            shown(own.limit),
            shown(own.today),
            shown(own.design),
            if own.met { "yes" } else { "no" }.into(),
            Cell::from(100.0 * own.excess),
            Cell::from(own.multiplier),
            Cell::Number(own.in_space.map(|share| 100.0 * share)),
            end(own, 0),
            end(own, 1),
            Cell::Number(own.holds.map(|share| 100.0 * share)),
        ]
    });
    table(workbook, "Targets", &headings.map(String::from), rows).map(drop)
}

/// An end of the interval of the design's value.
fn end(of: &Target, side: usize) -> Cell {
    let ends = of.uncertainty.as_ref().map(|uncertainty| uncertainty.interval[side]);
    Cell::Number(ends.map(|value| units::value(value, &of.unit)))
}

fn parameters(workbook: &mut Workbook, of: &Answer) -> Result<(), XlsxError> {
    let headings = [
        "parameter",
        "unit",
        "lower",
        "upper",
        "today",
        "design",
        "space_from",
        "space_to",
    ];
    let rows = of.parameters.iter().map(|own| {
        let shown = |value: Option<f64>| Cell::Number(value.map(|value| units::value(value, &own.unit)));
        vec![
            own.name.as_str().into(),
            units::name(&own.unit).into(),
            shown(Some(own.range[0])),
            shown(Some(own.range[1])),
            shown(Some(own.today)),
            shown(Some(own.design)),
            shown(own.interval.map(|interval| interval[0])),
            shown(own.interval.map(|interval| interval[1])),
        ]
    });
    table(workbook, "Parameters", &headings.map(String::from), rows).map(drop)
}

fn designs(workbook: &mut Workbook, of: &Answer, front: &FrontAnswer) -> Result<(), XlsxError> {
    let metrics = front.metrics.iter().map(|own| units::heading(&own.name, &own.unit));
    let names = of.parameters.iter().map(|own| units::heading(&own.name, &own.unit));
    let headings: Vec<String> = metrics.chain(names).chain(["cost".into()]).collect();
    let rows = front.points.iter().map(|point| {
        let values = point
            .values
            .iter()
            .zip(&front.metrics)
            .map(|(value, own)| units::value(*value, &own.unit));
        let own = point
            .parameters
            .0
            .iter()
            .zip(&of.parameters)
            .map(|((_, value), own)| units::value(*value, &own.unit));
        values.chain(own).chain([point.cost]).map(Cell::from).collect()
    });
    table(workbook, "Front", &headings, rows).map(drop)
}
