//! A fit as a workbook: parameters, fit percentages, and measured and modelled transmissibilities with a chart of each.

use std::ops::RangeInclusive;
use std::path::Path;

use nalgebra::Complex;
use qcar_runtime::error::InputError;
use rust_xlsxwriter::{ChartAxisCrossing, ChartType, Format, Workbook, Worksheet, XlsxError};

use super::files::{Compared, compare};
use super::{Fitted, render};
use crate::files::put;
use crate::spreadsheet::{self, AFTER, BEFORE, Cell, MEASURED, Pen, filled, table};
use crate::units;

/// The name of every workbook of results.
pub(crate) const FILE: &str = "results.xlsx";

/// The sheet of the transmissibilities.
const RATIOS: &str = "Transmissibilities";
/// Source of each curve, in the order of the columns.
const SOURCES: [(&str, Pen); 3] = [("measured", MEASURED), ("before", BEFORE), ("after", AFTER)];
/// First column of the magnitudes; the phases follow.
const MAGNITUDES: u16 = 4;
/// Number of charts side by side, and rows and columns between them.
const CHARTS: (usize, u32, u16) = (2, 16, 8);
/// Decimals of decibels and degrees that are shown; a cell keeps them all.
const DECIMALS: &str = "0.000";

/// Writes the workbook into a folder.
///
/// # Errors
/// Fails if the folder cannot be written to.
pub(super) fn write(of: &Fitted, folder: &Path) -> Result<(), InputError> {
    let bytes = filled(&folder.join(FILE), |workbook| sheets(workbook, of))?;
    put(folder, FILE, &bytes)
}

/// Adds the sheets of a fit.
pub(crate) fn sheets(workbook: &mut Workbook, of: &Fitted) -> Result<(), XlsxError> {
    parameters(workbook, of)?;
    channels(workbook, of)?;
    ratios(workbook, &compare(of))
}

fn parameters(workbook: &mut Workbook, of: &Fitted) -> Result<(), XlsxError> {
    let headings = [
        "parameter",
        "unit",
        "start",
        "value",
        "stderr",
        "stderr_%",
        "from",
        "to",
        "remark",
    ];
    let row = |own: &qcar_runtime::fit::report::ParameterFit| {
        let shown = |value: Option<f64>| Cell::Number(value.map(|value| units::value(value, &own.unit)));
        vec![
            own.name.as_str().into(),
            units::name(&own.unit).into(),
            shown(Some(own.start)),
            shown(Some(own.value)),
            shown(own.stderr),
            Cell::Number(own.relative_stderr.map(|part| 100.0 * part)),
            shown(own.range.map(|range| range.0)),
            shown(own.range.map(|range| range.1)),
            Cell::Text(render::remark(own)),
        ]
    };
    table(
        workbook,
        "Parameters",
        &headings.map(String::from),
        of.fit.parameters.iter().map(row),
    )
    .map(drop)
}

fn channels(workbook: &mut Workbook, of: &Fitted) -> Result<(), XlsxError> {
    let row = |own: &qcar_runtime::fit::report::ChannelFit| {
        vec![
            own.name.as_str().into(),
            own.run.as_str().into(),
            own.role.into(),
            if own.fitted { "yes" } else { "no" }.into(),
            own.quality.fit_magnitude.into(),
            own.quality.fit_phase.into(),
        ]
    };
    table(
        workbook,
        "Fit",
        &render::CHANNEL_HEADINGS.map(String::from),
        of.fit.channels.iter().map(row),
    )
    .map(drop)
}

/// All ratios in rows, with a chart of each at the side.
fn ratios(workbook: &mut Workbook, all: &[Compared]) -> Result<(), XlsxError> {
    let of_all = |unit: &'static str| SOURCES.map(|(source, _)| format!("{source} [{unit}]"));
    let headings = [
        ["run", "channel", "unit", "frequency [Hz]"].map(String::from).to_vec(),
        of_all("dB").to_vec(),
        of_all("deg").to_vec(),
    ]
    .concat();
    let sheet = table(workbook, RATIOS, &headings, all.iter().flat_map(rows))?;
    for column in MAGNITUDES..MAGNITUDES + 2 * SOURCES.len() as u16 {
        sheet.set_column_format(column, &Format::new().set_num_format(DECIMALS))?;
    }
    let mut next = 1;
    for (place, own) in all.iter().enumerate() {
        let last = next + own.observation.frequency.len() as u32 - 1;
        chart(sheet, place, own, next..=last)?;
        next = last + 1;
    }
    Ok(())
}

fn rows<'a>(of: &'a Compared) -> impl Iterator<Item = Vec<Cell>> + 'a {
    let row = |(line, frequency): (usize, &f64)| {
        let values = [of.observation.value[line], of.before[line], of.after[line]];
        let shown = |value: Complex<f64>| units::value(value.norm(), &of.unit);
        let decibels = values.map(|value| Cell::from(20.0 * shown(value).log10()));
        let degrees = values.map(|value| Cell::from(value.arg().to_degrees()));
        let named = [
            Cell::from(of.level.name.as_str()),
            (&*of.observation.channel.name).into(),
            units::name(&of.unit).into(),
            (*frequency).into(),
        ];
        named.into_iter().chain(decibels).chain(degrees).collect()
    };
    of.observation.frequency.iter().enumerate().map(row)
}

/// Magnitudes over frequency.
fn chart(sheet: &mut Worksheet, place: usize, of: &Compared, rows: RangeInclusive<u32>) -> Result<(), XlsxError> {
    let (first, last) = rows.into_inner();
    let title = format!("{}, {}", of.observation.channel.name, of.level.name);
    let mut chart = spreadsheet::chart(ChartType::ScatterStraight, &title);
    for (column, (source, pen)) in (MAGNITUDES..).zip(SOURCES) {
        let series = chart.add_series().set_name(source).set_format(&mut pen.curve());
        series.set_categories((RATIOS, first, MAGNITUDES - 1, last, MAGNITUDES - 1));
        series.set_values((RATIOS, first, column, last, column));
    }
    chart.x_axis().set_name("frequency [Hz]");
    if let [low, .., high] = of.observation.frequency[..] {
        spreadsheet::logarithmic(&mut chart, low, high);
    }
    chart
        .y_axis()
        .set_name(&format!("magnitude [{}]", units::decibels(&of.unit)))
        .set_crossing(ChartAxisCrossing::Min);
    let (beside, high, wide) = CHARTS;
    let (row, column) = ((place / beside) as u32 * high + 1, (place % beside) as u16 * wide);
    let right = MAGNITUDES + 2 * SOURCES.len() as u16 + 1;
    sheet.insert_chart(row, right + column, &chart).map(drop)
}
