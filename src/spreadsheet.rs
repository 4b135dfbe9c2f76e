//! Workbooks of Excel; equal content gives equal bytes.

use std::borrow::Cow;
use std::path::Path;

use qcar_runtime::error::{InputError, Place, Problem};
use rust_xlsxwriter::{
    Chart, ChartAxisLabelPosition, ChartFont, ChartLegendPosition, ChartLine, ChartLineDashType, ChartSolidFill,
    ChartType, Color, DocProperties, ExcelDateTime, Format, FormatBorder, Workbook, Worksheet, XlsxError,
};

/// The number of A4 among the paper sizes of Excel.
const A4: u8 = 9;
/// Grey of the lines behind the curves of a chart.
const GRID: Color = Color::RGB(0xD9D9D9);

/// How a role is drawn, as in reports.
pub struct Pen {
    color: Color,
    /// Width of a curve, points.
    width: f64,
    dashed: bool,
    /// Some programs draw the first curve over the others, %.
    transparency: u8,
}

/// What was measured: broad, so that it is seen behind a model that agrees with it.
pub const MEASURED: Pen = Pen {
    color: Color::RGB(0x918E86),
    width: 3.0,
    dashed: false,
    transparency: 50,
};
/// A model before the fit.
pub const BEFORE: Pen = Pen {
    color: Color::RGB(0xB05108),
    width: 1.25,
    dashed: true,
    transparency: 0,
};
/// A model after the fit.
pub const AFTER: Pen = Pen {
    color: Color::RGB(0x0B5CAD),
    width: 1.25,
    dashed: false,
    transparency: 0,
};

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

impl From<Cow<'_, str>> for Cell {
    fn from(text: Cow<'_, str>) -> Self {
        Cell::from(&*text)
    }
}

impl From<f64> for Cell {
    fn from(number: f64) -> Self {
        Cell::Number(Some(number))
    }
}

/// Adds a sheet with a table whose headings stay visible, on the screen and on every printed page.
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
    sheet.set_name(name)?.set_freeze_panes(1, 0)?.set_repeat_rows(0, 0)?;
    sheet.set_paper_size(A4).set_landscape().set_print_fit_to_pages(1, 0);
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

/// A chart whose labels stand at its lower edge, not across its curves, and whose legend leaves them the whole width.
pub fn chart(kind: ChartType, title: &str) -> Chart {
    let mut chart = Chart::new(kind);
    chart.title().set_name(title).set_font(ChartFont::new().set_size(11));
    chart.legend().set_position(ChartLegendPosition::Bottom);
    chart.x_axis().set_label_position(ChartAxisLabelPosition::Low);
    chart
        .y_axis()
        .set_major_gridlines_line(ChartLine::new().set_color(GRID));
    chart
}

/// Makes the horizontal axis logarithmic from the decade below `low` to `high`, with a line at each digit.
pub fn logarithmic(chart: &mut Chart, low: f64, high: f64) {
    let axis = chart.x_axis().set_log_base(10);
    axis.set_min(10f64.powf(low.log10().floor())).set_max(high);
    axis.set_major_gridlines_line(ChartLine::new().set_color(GRID).set_width(1.25));
    axis.set_minor_gridlines_line(ChartLine::new().set_color(GRID).set_width(0.5));
}

impl Pen {
    /// The line of a curve.
    pub fn curve(&self) -> ChartLine {
        let mut line = ChartLine::new();
        line.set_color(self.color)
            .set_width(self.width)
            .set_transparency(self.transparency);
        if self.dashed {
            line.set_dash_type(ChartLineDashType::Dash);
        }
        line
    }

    /// The fill of a bar.
    pub fn bar(&self) -> ChartSolidFill {
        let mut fill = ChartSolidFill::new();
        fill.set_color(self.color);
        fill
    }
}
