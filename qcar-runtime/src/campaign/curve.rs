//! K&C curves.

use std::path::{Path, PathBuf};

use super::contents::{Campaign, Run, Test};
use super::manifest::{CURVE, DYNAMIC_CURVE};
use super::table::{self, Table};
use crate::error::{InputError, Place, Problem};

/// A slow cycle: forces relative to the design position; compression is positive in a bounce.
#[derive(Clone, Debug, PartialEq)]
pub struct Curve {
    /// Its file, for error messages.
    pub file: PathBuf,
    /// Travel, m, one value for each sample.
    pub displacement: Vec<f64>,
    /// Force, N, one value for each sample.
    pub force: Vec<f64>,
}

/// A vertical sine, with its time and velocity.
#[derive(Clone, Debug, PartialEq)]
pub struct DynamicCurve {
    /// Its file, for error messages.
    pub file: PathBuf,
    /// Time, s, increasing, one value for each sample.
    pub time: Vec<f64>,
    /// Travel, m.
    pub displacement: Vec<f64>,
    /// Velocity, m/s.
    pub velocity: Vec<f64>,
    /// Force, N.
    pub force: Vec<f64>,
}

impl Campaign {
    /// Reads the curve of a bounce or longitudinal run.
    ///
    /// # Errors
    /// Fails if `run` is no such curve, or if its file has values that are not finite numbers.
    pub fn curve(&self, run: &Run) -> Result<Curve, InputError> {
        let file = self.folder.join(&run.file);
        if !matches!(run.test, Test::Bounce | Test::Longitudinal) {
            return Err(other_kind(&file, "a quasi-static curve"));
        }
        if let Some(recorded) = self.recorded(run) {
            return Ok(Curve {
                displacement: recorded.column("displacement"),
                force: recorded.column("force"),
                file,
            });
        }
        let mut table = read(&file, CURVE, &[])?;
        Ok(Curve {
            displacement: table.take("displacement"),
            force: table.take("force"),
            file,
        })
    }

    /// Reads the curve of a dynamic bounce run.
    ///
    /// # Errors
    /// Fails if `run` is no dynamic bounce, if its file has values that are not finite numbers, or if time does not
    /// increase.
    pub fn dynamic_curve(&self, run: &Run) -> Result<DynamicCurve, InputError> {
        let file = self.folder.join(&run.file);
        if !matches!(run.test, Test::DynamicBounce { .. }) {
            return Err(other_kind(&file, "a dynamic bounce"));
        }
        if let Some(recorded) = self.recorded(run) {
            return Ok(DynamicCurve {
                time: recorded.times(),
                displacement: recorded.column("displacement"),
                velocity: recorded.column("velocity"),
                force: recorded.column("force"),
                file,
            });
        }
        let mut table = read(&file, DYNAMIC_CURVE, &[])?;
        let time = increasing(&mut table, "time")?;
        let (displacement, velocity, force) = (table.take("displacement"), table.take("velocity"), table.take("force"));
        Ok(DynamicCurve {
            file,
            time,
            displacement,
            velocity,
            force,
        })
    }
}

pub(super) fn other_kind(file: &Path, expected: &str) -> InputError {
    Problem::new(
        file,
        Place::File,
        "a run of another kind",
        expected,
        "correct the `kind` of the run",
    )
    .into()
}

pub(super) fn read(file: &Path, required: &[&str], allowed: &[&str]) -> Result<Table, InputError> {
    let table = table::read(file)?;
    InputError::unless_empty(table::check_names(file, &table.names, required, allowed), Some(table))
}

pub(super) fn increasing(table: &mut Table, name: &str) -> Result<Vec<f64>, InputError> {
    let values = table.take(name);
    match values.windows(2).position(|pair| pair[1] <= pair[0]) {
        None => Ok(values),
        Some(row) => {
            let found = format!("{} after {}", values[row + 1], values[row]);
            let remedy = "sort the file, and remove duplicate rows";
            Err(Problem::new(&table.file, table.cell(row + 1, name), found, "a larger value", remedy).into())
        }
    }
}
