//! The sheets of curves and cleats: names and units, with empty columns below.

use qcar_runtime::campaign::workbook::{AXLES, CLEATS, COLUMNS, CURVES, DAMPERS, TESTS};
use rust_xlsxwriter::{DataValidation, DataValidationRule, Workbook, XlsxError};

use crate::spreadsheet::CellFormats;
use crate::units;

/// Heights of the cleats of the thesis, mm.
const HEIGHTS: [u8; 4] = [10, 20, 30, 40];
/// Columns of a damper curve and their units.
const DAMPER: [(&str, &str); 2] = [("velocity", "m/s"), ("force", "N")];
/// Number of prepared rows.
const PREPARED: u32 = 5000;

/// Adds the sheets.
pub(super) fn write(workbook: &mut Workbook, formats: &CellFormats) -> Result<(), XlsxError> {
    let of_test = |axle, test| COLUMNS.map(|(column, unit)| (format!("{axle} {test} {column}"), unit));
    let curves = AXLES
        .into_iter()
        .flat_map(|axle| TESTS.into_iter().flat_map(move |test| of_test(axle, test)));
    let dampers = AXLES
        .into_iter()
        .flat_map(|axle| DAMPER.map(|(column, unit)| (format!("{axle} {column}"), unit)));
    let cleats = HEIGHTS
        .into_iter()
        .flat_map(|height| ["x", "z"].map(|axis| (format!("cleat_{height} {axis}"), "m")));
    table(workbook, formats, CURVES, curves.collect())?;
    table(workbook, formats, DAMPERS, dampers.collect())?;
    table(workbook, formats, CLEATS, cleats.collect())
}

fn table(
    workbook: &mut Workbook,
    formats: &CellFormats,
    name: &str,
    columns: Vec<(String, &str)>,
) -> Result<(), XlsxError> {
    let sheet = workbook.add_worksheet();
    sheet.set_name(name)?;
    for (at, (heading, unit)) in (0..).zip(&columns) {
        sheet.set_column_width(at, heading.len().max(10) as f64 + 2.0)?;
        sheet.write_string_with_format(0, at, heading, &formats.heading)?;
        sheet.write_string_with_format(1, at, &*units::name(unit), &formats.input)?;
    }
    sheet.set_freeze_panes(2, 0)?;
    let number = DataValidation::new()
        .allow_decimal_number(DataValidationRule::Between(-1e300, 1e300))
        .set_error_title("No number")?
        .set_error_message("Write a number, in the unit of the column.")?;
    sheet.add_data_validation(2, 0, PREPARED, columns.len() as u16 - 1, &number)?;
    Ok(())
}
