//! The workbook of a vehicle as `qcar new template` writes it: values in named cells such as `front.k_tire`, and tables
//! of K&C curves and cleats.

use std::path::{Path, PathBuf};

use qcar_signals::signal::{Recording, Signal};

use super::contents::{ChannelMapping, Profile, Road, Role, Run, Test, Window};
use super::recorded::Files;
use super::unit::Declared;
use crate::error::{InputError, Place};
use cells::Cells;

// The contents of named cells.
mod cells;

/// Axles, as prefixes of cells and columns.
pub const AXLES: [&str; 2] = ["front", "rear"];
/// The sheet of the values.
pub const VALUES: &str = "Vehicle";
/// The sheet of the K&C curves, with columns such as `front bounce displacement`.
pub const CURVES: &str = "K&C curves";
/// The sheet of the damper curves.
pub const DAMPERS: &str = "Damper curves";
/// The sheet of the obstacles, with columns such as `cleat_20 x` and `cleat_20 z`.
pub const CLEATS: &str = "Cleats";
/// The curves of the K&C rig, and the columns of each with their units.
pub const TESTS: [&str; 2] = ["bounce", "longitudinal"];
/// See [`TESTS`].
pub const COLUMNS: [(&str, &str); 2] = [("displacement", "m"), ("force", "N")];

/// Contents of a workbook for one axle.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Workbook {
    /// Its file, for error messages.
    pub file: PathBuf,
    /// The model of the axle; `None` if no cell names it.
    pub model: Option<String>,
    /// Vehicle data.
    pub vehicle: Vec<Entry>,
    /// Start values of parameters.
    pub parameters: Vec<Entry>,
    /// Empty named cells, with their positions.
    pub blanks: Vec<(String, Place)>,
    /// K&C curves.
    pub(super) runs: Vec<Run>,
    /// Cleats.
    pub(super) roads: Vec<Road>,
}

/// A value of a workbook.
#[derive(Clone, Debug, PartialEq)]
pub struct Entry {
    /// Name of the parameter or vehicle datum.
    pub name: String,
    /// Value, SI.
    pub value: f64,
    /// A coherent SI unit.
    pub unit: String,
    /// Bounds of the estimation, SI.
    pub range: Option<(f64, f64)>,
    /// False for a known parameter, which keeps its value.
    pub fit: bool,
    /// Source of the value.
    pub comment: String,
    /// The cell.
    pub place: Place,
}

/// True if the name of a file is that of a workbook.
pub fn is_workbook(file: &Path) -> bool {
    file.extension().is_some_and(|extension| extension == "xlsx")
}

impl Workbook {
    /// Reads a workbook for an axle, `front` or `rear`; without one, for the axle in its cell `axle`.
    ///
    /// # Errors
    /// Fails if the file is no such workbook, and with every cell that has no number, no unit of its kind, or a formula
    /// that was never computed.
    pub fn read(file: &Path, axle: Option<&str>) -> Result<Workbook, InputError> {
        Workbook::known(file, "", axle, &Files::default())
    }

    /// The same for a campaign, which calls it `named` and reads it at most once.
    pub(super) fn known(file: &Path, named: &str, axle: Option<&str>, files: &Files) -> Result<Workbook, InputError> {
        let recording = files.get(file)?;
        let mut cells = Cells::new(file, &recording);
        let axle = cells.axle(axle)?;
        let (vehicle, parameters) = (cells.facts(&axle), cells.parameters(&axle));
        let model = cells.text(&format!("{axle}.model"));
        let (runs, roads) = (
            curves(&mut cells, &recording, named, &axle),
            roads(&mut cells, &recording, named),
        );
        InputError::unless_empty(
            cells.problems,
            Some(Workbook {
                file: file.into(),
                model,
                vehicle,
                parameters,
                blanks: cells.blanks,
                runs,
                roads,
            }),
        )
    }
}

/// The columns of a sheet.
fn of_sheet<'a>(recording: &'a Recording, sheet: &str) -> impl Iterator<Item = &'a Signal> {
    recording
        .signals
        .iter()
        .filter(move |signal| signal.source.group == sheet)
}

/// Number of values of a column from its top; `None` without any.
fn filled(signal: &Signal) -> Option<usize> {
    let last = signal.samples.iter().rposition(|value| value.is_finite());
    last.map(|last| last + 1)
}

/// A run for each K&C curve of the axle that is filled.
fn curves(cells: &mut Cells<'_>, recording: &Recording, file: &str, axle: &str) -> Vec<Run> {
    let tests = TESTS.into_iter().zip([Test::Bounce, Test::Longitudinal]);
    let curve = |(kind, test): (&str, Test)| {
        let columns = COLUMNS.map(|(column, _)| format!("{axle} {kind} {column}"));
        let lengths = columns.each_ref().map(|name| {
            let column = of_sheet(recording, CURVES).find(|signal| signal.name == *name);
            column.and_then(filled)
        });
        if lengths == [None; 2] {
            return None;
        }
        if lengths[0] != lengths[1] {
            cells.wrong(
                Place::Words(format!("sheet `{CURVES}`")),
                format!("{} values of `{}`", lengths[0].unwrap_or(0), columns[0]),
                format!("{} values as of `{}`", lengths[1].unwrap_or(0), columns[1]),
                "fill both columns row by row, or leave both empty",
            );
            return None;
        }
        let mappings = columns.iter().zip(COLUMNS);
        let mappings = mappings.map(|(source, (column, si))| ChannelMapping {
            source: format!("{CURVES}/{source}"),
            unit: None,
            ..ChannelMapping::plain(column, si)
        });
        Some(Run {
            name: format!("{file} {axle} {kind}"),
            file: file.into(),
            plain: false,
            window: Window::default(),
            without: Vec::new(),
            columns: mappings.collect(),
            role: Role::Fit,
            test,
        })
    };
    tests.filter_map(curve).collect()
}

/// A road for each cleat that is filled.
fn roads(cells: &mut Cells<'_>, recording: &Recording, file: &str) -> Vec<Road> {
    let along = of_sheet(recording, CLEATS).filter_map(|signal| Some((signal.name.strip_suffix(" x")?, signal)));
    let mut roads = Vec::new();
    for (name, x) in along {
        let above = format!("{name} z");
        let z = of_sheet(recording, CLEATS).find(|signal| signal.name == above);
        match (filled(x), z.and_then(filled)) {
            (None, None) => {}
            (Some(count), Some(other)) if count == other => {
                let heights = z.map_or_else(Vec::new, |z| z.samples.range(0..count).collect());
                let units = [x, z.unwrap_or(x)].map(|signal| length(cells, signal));
                if let [Some(of_x), Some(of_z)] = units {
                    let corners = x.samples.range(0..count).zip(heights);
                    roads.push(Road {
                        name: name.into(),
                        file: file.into(),
                        profile: Profile::Corners(corners.map(|(x, z)| [of_x.si(x), of_z.si(z)]).collect()),
                    });
                }
            }
            (count, other) => cells.wrong(
                Place::Words(format!("sheet `{CLEATS}`")),
                format!("{} values of `{name} x`", count.unwrap_or(0)),
                format!("{} values as of `{above}`", other.unwrap_or(0)),
                "fill both columns row by row, or leave both empty",
            ),
        }
    }
    roads
}

/// The unit of a column of lengths.
fn length(cells: &mut Cells<'_>, signal: &Signal) -> Option<Declared> {
    cells.unit(
        Place::Words(format!("{}, column `{}`", signal.source.place, signal.name)),
        &signal.unit,
        Some("m"),
    )
}
