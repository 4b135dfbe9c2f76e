//! A study as a workbook: its fit, and the errors over cleats before and after with a chart.

use std::path::Path;

use qcar_runtime::error::InputError;
use rust_xlsxwriter::{ChartType, Workbook, XlsxError};

use super::gather::{Study, Track};
use crate::files::put;
use crate::spreadsheet::{self, AFTER, BEFORE, Cell, filled, table};
use crate::units;
use crate::verbs::fit::workbook::{FILE, sheets};
use crate::verbs::simulate::comparison::Difference;

/// The sheet of the errors over cleats.
const ERRORS: &str = "Cleat errors";
/// Quantity of a motion.
const ACCELERATION: &str = "m/s^2";
/// The columns of the errors of the peaks and of the after-shakes, %.
const OF_ERRORS: [u16; 2] = [7, 10];

/// Writes the workbook into a folder.
///
/// # Errors
/// Fails if the folder cannot be written to.
pub(super) fn write(of: &Study, folder: &Path) -> Result<(), InputError> {
    let bytes = filled(&folder.join(FILE), |workbook| {
        sheets(workbook, &of.fitted)?;
        of.track.as_ref().map_or(Ok(()), |track| cleats(workbook, track))
    })?;
    put(folder, FILE, &bytes)
}

fn cleats(workbook: &mut Workbook, of: &Track) -> Result<(), XlsxError> {
    let models = [
        ("before", BEFORE, Some(&of.before)),
        ("after", AFTER, of.after.as_ref()),
    ];
    let driven: Vec<_> = models
        .into_iter()
        .filter_map(|(name, pen, driven)| Some((name, pen, driven?)))
        .collect();
    let rows = driven
        .iter()
        .flat_map(|(name, _, driven)| driven.compared.runs.iter().map(|own| row(name, own)));
    let sheet = table(workbook, ERRORS, &headings(), rows)?;
    let count = of.before.compared.runs.len() as u32;
    for (place, (column, title)) in (0..).zip(OF_ERRORS.into_iter().zip(["peak", "after-shake"])) {
        let mut chart = spreadsheet::chart(ChartType::Column, &format!("Error of the {title} over cleats"));
        for (first, (name, pen, _)) in (0..).map(|model| model * count + 1).zip(&driven) {
            let series = chart.add_series().set_name(*name).set_format(&mut pen.bar());
            series.set_categories((ERRORS, first, 1, first + count - 1, 4));
            series.set_values((ERRORS, first, column, first + count - 1, column));
        }
        chart.y_axis().set_name("error [%]");
        chart.set_width(1000).set_height(420);
        sheet.insert_chart(place * 23 + 1, OF_ERRORS[1] + 2, &chart)?;
    }
    Ok(())
}

fn headings() -> Vec<String> {
    let own = |what: &str| units::heading(what, ACCELERATION);
    let named = ["model", "run", "role", "mass", "axis"].map(String::from);
    let peaks = [own("measured peak"), own("simulated peak"), "peak error [%]".into()];
    let shakes = [
        own("measured after-shake"),
        own("simulated after-shake"),
        "after-shake error [%]".into(),
    ];
    [&named[..], &peaks, &shakes].concat()
}

fn row(model: &str, of: &Difference) -> Vec<Cell> {
    let shown = |value: f64| Cell::from(units::value(value, ACCELERATION));
    vec![
        model.into(),
        of.run.as_str().into(),
        of.role.into(),
        of.mass.as_str().into(),
        of.axis.as_str().into(),
        shown(of.measured_peak),
        shown(of.simulated_peak),
        (100.0 * of.peak_error).into(),
        shown(of.measured_after_shake),
        shown(of.simulated_after_shake),
        (100.0 * of.after_shake_error).into(),
    ]
}
