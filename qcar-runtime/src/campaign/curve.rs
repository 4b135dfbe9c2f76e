//! K&C curves and road profiles.

use std::path::{Path, PathBuf};

use super::contents::{Campaign, Road, Run, Test};
use super::manifest::{CURVE, DYNAMIC_CURVE, ROAD};
use super::table::{self, Table};
use crate::error::{InputError, Place, Problem};

/// A quasi-static cycle: forces are relative to the design position, compression is positive in a bounce.
#[derive(Clone, Debug, PartialEq)]
pub struct Curve {
    /// Where it was read, to be named in errors.
    pub file: PathBuf,
    /// m, one for each sample.
    pub displacement: Vec<f64>,
    /// N, one for each sample.
    pub force: Vec<f64>,
}

/// A vertical sine, with its time and velocity.
#[derive(Clone, Debug, PartialEq)]
pub struct DynamicCurve {
    /// Where it was read, to be named in errors.
    pub file: PathBuf,
    /// s, increasing, one for each sample.
    pub time: Vec<f64>,
    /// m.
    pub displacement: Vec<f64>,
    /// m/s.
    pub velocity: Vec<f64>,
    /// N.
    pub force: Vec<f64>,
}

/// A road profile as sampled. It goes on flat beyond its ends.
#[derive(Clone, Debug, PartialEq)]
pub struct RoadSamples {
    /// Where it was read, to be named in errors.
    pub file: PathBuf,
    /// m, increasing.
    pub x: Vec<f64>,
    /// m.
    pub z: Vec<f64>,
    /// Of the segment to the right of each point.
    pub slope: Vec<f64>,
}

impl Campaign {
    /// Reads the curve of a bounce or longitudinal run.
    ///
    /// # Errors
    /// Where `run` is no such curve, or its file holds anything but finite numbers.
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
        let mut table = read(&file, CURVE)?;
        Ok(Curve {
            displacement: table.take("displacement"),
            force: table.take("force"),
            file,
        })
    }

    /// Reads the curve of a dynamic bounce run.
    ///
    /// # Errors
    /// Where `run` is no dynamic bounce, its file holds anything but finite numbers, or time does not increase.
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
        let mut table = read(&file, DYNAMIC_CURVE)?;
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

    /// Reads a road profile.
    ///
    /// # Errors
    /// Where its file holds anything but finite numbers, or `x` does not increase.
    pub fn road(&self, road: &Road) -> Result<RoadSamples, InputError> {
        let file = self.folder.join(&road.file);
        if let Some(corners) = &road.corners {
            return between(file, &road.name, corners);
        }
        let mut table = read(&file, ROAD)?;
        let x = increasing(&mut table, "x")?;
        Ok(RoadSamples {
            x,
            z: table.take("z"),
            slope: table.take("slope"),
            file,
        })
    }
}

/// A road of straight pieces; two corners above each other are a step.
fn between(file: PathBuf, name: &str, corners: &[[f64; 2]]) -> Result<RoadSamples, InputError> {
    let backward = corners.windows(2).find(|pair| pair[1][0] < pair[0][0]);
    let third = corners.windows(3).find(|three| three[0][0] == three[2][0]);
    if let Some(pair) = backward.or(third) {
        let place = Place::Name(format!("{name} x"));
        let found = format!("{} m after {} m", pair[1][0], pair[0][0]);
        let expected = "a larger value, or the same value twice for a step";
        return Err(Problem::new(file, place, found, expected, "sort the rows, or correct the value").into());
    }
    let (mut x, mut z, mut slope) = (Vec::new(), Vec::new(), Vec::new());
    for (at, corner) in corners.iter().enumerate() {
        let next = corners.get(at + 1).copied().unwrap_or([f64::INFINITY, corner[1]]);
        // The foot of a step is where the slope of the piece before it leads.
        if next[0] > corner[0] {
            x.push(corner[0]);
            z.push(corner[1]);
            slope.push((next[1] - corner[1]) / (next[0] - corner[0]));
        }
    }
    Ok(RoadSamples { file, x, z, slope })
}

fn other_kind(file: &Path, expected: &str) -> InputError {
    Problem::new(
        file,
        Place::File,
        "a run of another kind",
        expected,
        "correct the `kind` of the run",
    )
    .into()
}

fn read(file: &Path, names: &[&str]) -> Result<Table, InputError> {
    let table = table::read(file)?;
    InputError::unless_empty(table::check_names(file, &table.names, names, &[]), Some(table))
}

fn increasing(table: &mut Table, name: &str) -> Result<Vec<f64>, InputError> {
    let values = table.take(name);
    match values.windows(2).position(|pair| pair[1] <= pair[0]) {
        None => Ok(values),
        Some(row) => {
            let found = format!("{} after {}", values[row + 1], values[row]);
            let remedy = "sort the file, and remove what is there twice";
            Err(Problem::new(&table.file, table.cell(row + 1, name), found, "a larger value", remedy).into())
        }
    }
}
