//! K&C curves.

use std::path::{Path, PathBuf};

use super::contents::{Campaign, Run, Test};
use super::manifest::{CURVE, DYNAMIC_CURVE};
use super::table::{self, Table};
use crate::error::{InputError, Place, Problem};
use crate::mean::quantile;
use crate::proportion::{factor, is_alike};
use crate::shown::{rounded, shown};

/// Factor between two columns that no confused unit explains: mm and m are a thousand apart.
const OF_NO_UNIT: f64 = 1e4;

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
    /// Fails if `run` is no dynamic bounce, if its file has values that are not finite numbers, if time does not
    /// increase, or if velocity, displacement and the peak velocity and amplitude of the run contradict each other by a
    /// factor above 2 or below 1/2.
    pub fn dynamic_curve(&self, run: &Run) -> Result<DynamicCurve, InputError> {
        let file = self.folder.join(&run.file);
        let Test::DynamicBounce {
            peak_velocity,
            amplitude,
        } = run.test
        else {
            return Err(other_kind(&file, "a dynamic bounce"));
        };
        let curve = self.sine(run, file)?;
        InputError::unless_empty(curve.contradictions(peak_velocity, amplitude), Some(curve))
    }

    fn sine(&self, run: &Run, file: PathBuf) -> Result<DynamicCurve, InputError> {
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

impl DynamicCurve {
    /// Problems of the columns with each other, and with the set values of the rig (m/s and m).
    fn contradictions(&self, peak_velocity: f64, amplitude: f64) -> Vec<Problem> {
        let problem = |column: &str, found: String, expected: String, remedy: &str| {
            Problem::new(&self.file, Place::Name(column.into()), found, expected, remedy)
        };
        let of_key = |(column, what): (&str, &str), (recorded, set): (f64, f64), (key, si): (&str, &str)| {
            let factor = recorded / set;
            let wrong = || {
                let found = format!(
                    "{what} of {}, {} times `{key}`",
                    shown(recorded, si),
                    rounded(factor, 3)
                );
                let expected = format!("one near `{key} = {set}` of the run");
                let remedy = format!("correct `{key}` in campaign.toml, or the unit of the column");
                problem(column, found, expected, &remedy)
            };
            (!is_alike(factor)).then(wrong)
        };
        let rate = self.velocity_over_rate().filter(|factor| !is_alike(*factor));
        let of_rate = rate.map(|factor| {
            problem(
                "velocity",
                if factor.abs() < OF_NO_UNIT {
                    format!("velocities of {} times the rate of the displacement", rounded(factor, 3))
                } else {
                    "velocities that do not follow the rate of the displacement".into()
                },
                "the rate of the displacement over time".into(),
                "correct the unit of `time`, `displacement` or `velocity` in the file, such as `velocity [mm/s]`, or a sign",
            )
        });
        let peak = quantile(&ascending(self.velocity.iter().map(|velocity| velocity.abs())), MOST);
        let travel = ascending(self.displacement.iter().copied());
        let [low, high] = [1.0 - MOST, MOST].map(|share| quantile(&travel, share));
        let of_peak = of_key(
            ("velocity", "a peak velocity"),
            (peak, peak_velocity),
            ("peak_velocity", "m/s"),
        );
        let of_amplitude = of_key(
            ("displacement", "an amplitude"),
            (0.5 * (high - low), amplitude),
            ("amplitude", "m"),
        );
        of_rate.into_iter().chain(of_peak).chain(of_amplitude).collect()
    }

    /// The velocity over the rate of the displacement, by increments from row to row; `None` if one of them is zero.
    fn velocity_over_rate(&self) -> Option<f64> {
        let steps = self.time.windows(2).zip(self.velocity.windows(2));
        let travelled = steps.map(|(time, velocity)| 0.5 * (velocity[0] + velocity[1]) * (time[1] - time[0]));
        let moved = self.displacement.windows(2).map(|pair| pair[1] - pair[0]);
        factor(travelled.zip(moved))
    }
}

/// Share of the samples below the amplitude of a sine. A whole sine is at most 1.2 % below its peak there; single spikes
/// are above.
const MOST: f64 = 0.95;

fn ascending(values: impl Iterator<Item = f64>) -> Vec<f64> {
    let mut sorted: Vec<f64> = values.collect();
    sorted.sort_by(f64::total_cmp);
    sorted
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
