//! The sheet of values: a row for each parameter, with cells for the front and for the rear axle.

use qcar_runtime::campaign::workbook::{AXLES, VALUES};
use rust_xlsxwriter::{DataValidation, DataValidationErrorStyle, DataValidationRule, Workbook, Worksheet, XlsxError};

use super::rows::{GROUPS, Row};
use crate::catalogue;
use crate::spreadsheet::CellFormats;
use crate::units;

/// Columns of the description; those of each axle follow.
const WHAT: [(&str, f64); 2] = [("Name", 58.0), ("Model variable", 20.0)];
/// Columns of an axle: the value and the suffixes of further cells.
const OF_AXLE: [(&str, &str); 5] = [
    ("", ""),
    ("Unit", ".unit"),
    ("From", ".lower"),
    ("To", ".upper"),
    ("Fit", ".fit"),
];
/// Prefixes of cell names in the columns after those of both axles.
const LAST: [(&str, &str, f64); 2] = [("Comment", "comment.", 40.0), ("Kind of unit", "kind.", 14.0)];

/// Rows above the table.
const TOP: u32 = 8;

/// A sheet being written, and the names of its cells.
struct Sheet<'a> {
    sheet: Worksheet,
    formats: &'a CellFormats,
    names: Vec<(String, u32, u16)>,
}

/// Adds the sheet.
pub(super) fn write(
    workbook: &mut Workbook,
    formats: &CellFormats,
    model: Option<&str>,
    rows: &[Row],
) -> Result<(), XlsxError> {
    let mut out = Sheet {
        sheet: Worksheet::new(),
        formats,
        names: Vec::new(),
    };
    out.sheet.set_name(VALUES)?;
    out.head(model)?;
    let mut at = TOP + 1;
    for (group, title) in GROUPS.iter().enumerate() {
        let mut of_group = rows.iter().filter(|row| row.group == group).peekable();
        if of_group.peek().is_some() {
            out.sheet.write_string_with_format(at, 0, *title, &formats.heading)?;
            at += 1;
        }
        for row in of_group {
            out.row(at, row)?;
            at += 1;
        }
    }
    workbook.push_worksheet(out.sheet);
    for (name, row, column) in out.names {
        let cell = rust_xlsxwriter::utility::row_col_to_cell_absolute(row, column);
        workbook.define_name(name, &format!("={VALUES}!{cell}"))?;
    }
    Ok(())
}

impl Sheet<'_> {
    /// Text above the table.
    fn head(&mut self, model: Option<&str>) -> Result<(), XlsxError> {
        let formats = self.formats;
        self.sheet.write_string_with_format(0, 0, "Vehicle", &formats.title)?;
        let hint = "Fill in the coloured cells. You may change a unit; its row is then in that unit. Leave empty what an axle \
                    does not have. All masses are those of one corner.";
        self.sheet.write_string(1, 0, hint)?;
        self.label(2, "Axle that is read if a campaign does not state `axle`", "axle")?;
        self.word(2, 2, "axle", AXLES[0], &AXLES)?;
        self.label(3, "Mass of the whole vehicle", "vehicle.mass")?;
        self.measured(3, 2, "vehicle.mass", "kg", None)?;
        self.label(4, "Share of the front axle", "vehicle.front_share")?;
        self.measured(4, 2, "vehicle.front_share", "1", None)?;
        let models: Vec<&str> = catalogue::names().collect();
        for (row, axle) in (5..).zip(AXLES) {
            self.label(row, &format!("Model of the {axle} axle"), &format!("{axle}.model"))?;
            self.word(row, 2, &format!("{axle}.model"), model.unwrap_or(""), &models)?;
        }
        self.headings()
    }

    fn headings(&mut self) -> Result<(), XlsxError> {
        let heading = &self.formats.heading;
        for (column, (title, width)) in (0..).zip(WHAT) {
            self.sheet.set_column_width(column, width)?;
            self.sheet.write_string_with_format(TOP, column, title, heading)?;
        }
        let mut column = WHAT.len() as u16;
        for axle in AXLES {
            for (title, _) in OF_AXLE {
                let title = if title.is_empty() { axle } else { title };
                self.sheet.write_string_with_format(TOP, column, title, heading)?;
                column += 1;
            }
        }
        for (title, _, width) in LAST {
            self.sheet.set_column_width(column, width)?;
            self.sheet.write_string_with_format(TOP, column, title, heading)?;
            column += 1;
        }
        self.sheet.set_freeze_panes(TOP + 1, WHAT.len() as u16)?;
        Ok(())
    }

    fn label(&mut self, row: u32, doc: &str, name: &str) -> Result<(), XlsxError> {
        self.sheet.write_string_with_format(row, 0, doc, &self.formats.plain)?;
        self.sheet.write_string_with_format(row, 1, name, &self.formats.plain)?;
        Ok(())
    }

    fn row(&mut self, at: u32, row: &Row) -> Result<(), XlsxError> {
        self.label(at, &row.doc, &row.name)?;
        let mut column = WHAT.len() as u16;
        for (axle, given) in AXLES.into_iter().zip([row.front, None]) {
            self.of_axle(at, column, &format!("{axle}.{}", row.name), row, given)?;
            column += OF_AXLE.len() as u16;
        }
        let [comment, kind] = LAST.map(|(_, prefix, _)| format!("{prefix}{}", row.name));
        self.sheet.write_blank(at, column, &self.formats.input)?;
        self.names.push((comment, at, column));
        self.sheet
            .write_string_with_format(at, column + 1, &row.unit, &self.formats.plain)?;
        self.names.push((kind, at, column + 1));
        Ok(())
    }

    /// A value with its unit, and its bounds if it may be estimated.
    fn of_axle(&mut self, at: u32, column: u16, name: &str, row: &Row, given: Option<f64>) -> Result<(), XlsxError> {
        self.measured(at, column, name, &row.unit, given)?;
        if row.group == 0 {
            return Ok(());
        }
        let range = row
            .range
            .map(|(low, high)| [low, high].map(|end| units::value(end, &row.unit)));
        if let Some([low, high]) = range {
            let plausible = validation(low, high, &units::name(&row.unit))?;
            self.sheet.add_data_validation(at, column, at, column, &plausible)?;
        }
        for (offset, end) in [(2, range.map(|ends| ends[0])), (3, range.map(|ends| ends[1]))] {
            self.number(at, column + offset, end)?;
            self.names
                .push((format!("{name}{}", OF_AXLE[usize::from(offset)].1), at, column + offset));
        }
        let fit = if row.estimated { "yes" } else { "no" };
        self.word(at, column + 4, &format!("{name}.fit"), fit, &["yes", "no"])
    }

    /// A cell for a number, with its unit to the right.
    fn measured(&mut self, at: u32, column: u16, name: &str, si: &str, given: Option<f64>) -> Result<(), XlsxError> {
        self.number(at, column, given.map(|value| units::value(value, si)))?;
        self.names.push((name.into(), at, column));
        let shown = units::name(si);
        let mut choices = vec![&*shown, si];
        choices.extend(others(si));
        choices.dedup();
        self.word(at, column + 1, &format!("{name}.unit"), &shown, &choices)
    }

    fn number(&mut self, at: u32, column: u16, value: Option<f64>) -> Result<(), XlsxError> {
        match value {
            Some(value) => self
                .sheet
                .write_number_with_format(at, column, value, &self.formats.input)?,
            None => self.sheet.write_blank(at, column, &self.formats.input)?,
        };
        Ok(())
    }

    /// A cell for one of several words.
    fn word(&mut self, at: u32, column: u16, name: &str, word: &str, choices: &[&str]) -> Result<(), XlsxError> {
        match word {
            "" => self.sheet.write_blank(at, column, &self.formats.input)?,
            word => self
                .sheet
                .write_string_with_format(at, column, word, &self.formats.input)?,
        };
        // Units and models beyond the list are accepted too.
        let list = DataValidation::new()
            .allow_list_strings(choices)?
            .set_error_style(DataValidationErrorStyle::Information)
            .set_error_message(format!(
                "Usual are {}.",
                choices.join(", ").chars().take(200).collect::<String>()
            ))?;
        self.sheet.add_data_validation(at, column, at, column, &list)?;
        self.names.push((name.into(), at, column));
        Ok(())
    }
}

/// Further units of a kind.
fn others(si: &str) -> &'static [&'static str] {
    match si {
        "m" => &["mm"],
        "N" => &["kN"],
        "N/m" => &["N/mm"],
        "N s/m" => &["N s/mm"],
        _ => &[],
    }
}

/// Asks for confirmation of values outside the plausible range.
fn validation(low: f64, high: f64, unit: &str) -> Result<DataValidation, XlsxError> {
    DataValidation::new()
        .allow_decimal_number(DataValidationRule::Between(low, high))
        .set_error_style(DataValidationErrorStyle::Warning)
        .set_error_title("Not plausible")?
        .set_error_message(format!("Numbers from {low} to {high} {unit} are plausible."))
}
