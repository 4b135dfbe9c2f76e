//! Workbooks of Excel; equal content gives equal bytes.

use std::path::Path;

use qcar_runtime::error::{InputError, Place, Problem};
use rust_xlsxwriter::{Color, DocProperties, ExcelDateTime, Format, FormatBorder, Workbook, Worksheet, XlsxError};

/// Cell formats.
pub struct CellFormats {
    /// Title of a sheet.
    pub title: Format,
    /// Heading of a column or of a group of rows.
    pub heading: Format,
    /// Cell to read.
    pub plain: Format,
    /// Cell to fill in.
    pub input: Format,
}

impl Default for CellFormats {
    fn default() -> Self {
        CellFormats {
            title: Format::new().set_bold().set_font_size(14),
            heading: Format::new().set_bold().set_background_color(Color::RGB(0xD9E2EC)),
            input: Format::new()
                .set_background_color(Color::RGB(0xFFF9E5))
                .set_border(FormatBorder::Thin)
                .set_border_color(Color::RGB(0xCCCCCC)),
            plain: Format::new(),
        }
    }
}

/// An empty workbook.
///
/// # Errors
/// Fails only for invalid formats of this module.
pub fn workbook() -> Result<Workbook, XlsxError> {
    let mut workbook = Workbook::new();
    // The current time would change the bytes.
    let properties = DocProperties::new().set_creation_datetime(&ExcelDateTime::from_ymd(2000, 1, 1)?);
    workbook.set_properties(&properties);
    Ok(workbook)
}

/// The bytes of a workbook that `fill` has filled, for the file `file`.
///
/// # Errors
/// Fails if Excel cannot hold the content: too many rows, or an invalid name.
pub fn filled(file: &Path, fill: impl FnOnce(&mut Workbook) -> Result<(), XlsxError>) -> Result<Vec<u8>, InputError> {
    let bytes = workbook().and_then(|mut workbook| {
        fill(&mut workbook)?;
        workbook.save_to_buffer()
    });
    bytes.map_err(|error| {
        let (expected, remedy) = (
            "a workbook within the limits of Excel",
            "shorten the names, or take fewer runs",
        );
        Problem::new(file, Place::File, error.to_string(), expected, remedy).into()
    })
}

/// Content of a cell.
pub enum Cell {
    /// Text.
    Text(String),
    /// A number as it is shown; `None` for an empty cell.
    Number(Option<f64>),
}

impl From<&str> for Cell {
    fn from(text: &str) -> Self {
        Cell::Text(text.into())
    }
}

impl From<f64> for Cell {
    fn from(number: f64) -> Self {
        Cell::Number(Some(number))
    }
}

/// Adds a sheet with a table whose headings stay visible.
///
/// # Errors
/// Fails if the table has more rows than a sheet.
pub fn table<'a>(
    workbook: &'a mut Workbook,
    name: &str,
    headings: &[String],
    rows: impl IntoIterator<Item = Vec<Cell>>,
) -> Result<&'a mut Worksheet, XlsxError> {
    let formats = CellFormats::default();
    let sheet = workbook.add_worksheet();
    sheet.set_name(name)?.set_freeze_panes(1, 0)?;
    for (column, heading) in (0..).zip(headings) {
        sheet.set_column_width(column, heading.chars().count().max(8) as f64 + 2.0)?;
        sheet.write_string_with_format(0, column, heading, &formats.heading)?;
    }
    for (at, row) in (1..).zip(rows) {
        for (column, cell) in (0..).zip(row) {
            match cell {
                Cell::Text(text) => sheet.write_string(at, column, text)?,
                Cell::Number(Some(number)) if number.is_finite() => sheet.write_number(at, column, number)?,
                Cell::Number(_) => sheet,
            };
        }
    }
    Ok(sheet)
}
