//! Dynamometer tables: the force of a link over its speed.

use std::f64::consts::TAU;
use std::path::{Path, PathBuf};

use super::contents::{Campaign, Dynamometer, Run, Test};
use super::curve::{other_kind, read};
use super::manifest::{FORCES, UNCERTAINTY};
use crate::error::{InputError, Place, Problem};
use crate::shown::{rounded, shown};

/// Forces of a link at its speeds, all positive in extension, one value for each row.
#[derive(Clone, Debug, PartialEq)]
pub struct ForceTable {
    /// Its file, for error messages.
    pub file: PathBuf,
    /// Speed, m/s, not zero.
    pub velocity: Vec<f64>,
    /// Force, N.
    pub force: Vec<f64>,
    /// Standard deviation of each force, N, above zero.
    pub uncertainty: Vec<f64>,
}

/// A force in the direction of the motion has the wrong sign if it exceeds this number of its standard deviations, and
/// this share of the largest force: a damper never supplies energy.
const PUSHES: f64 = 3.0;
const NOTABLE: f64 = 0.05;
/// Fewest rows: one sine gives a force in rebound and one in compression.
const FEWEST: usize = 2;
/// Possible frequencies of the fastest sine, Hz. A choice: dynamometers take about a second for it, so that a unit wrong
/// by 1000 leaves this range, while a table of creeping speeds alone (2 mm/s over a stroke of 50 mm) stays inside.
const POSSIBLE: std::ops::RangeInclusive<f64> = 0.01..=100.0;

impl Campaign {
    /// Reads the table of a dynamometer.
    ///
    /// # Errors
    /// Fails if `run` is no such table, if its file has values that are not finite numbers, if it has a single row, if a
    /// speed is zero, if a sine of the amplitude of the run would need less than 0.01 s or more than 100 s for the
    /// largest speed, if a force acts in the direction of the motion, or if the uncertainty is missing, given twice, or
    /// not positive.
    pub fn force_table(&self, run: &Run) -> Result<ForceTable, InputError> {
        let file = self.folder.join(&run.file);
        let Test::Dynamometer(test) = &run.test else {
            return Err(other_kind(&file, "a dynamometer's table"));
        };
        let (velocity, force, each, lines) = match self.recorded(run) {
            Some(recorded) => (recorded.column("velocity"), recorded.column("force"), None, None),
            None => {
                let mut table = read(&file, FORCES, UNCERTAINTY)?;
                let has_each = table.names.iter().any(|name| name == UNCERTAINTY[0]);
                let each = has_each.then(|| table.take(UNCERTAINTY[0]));
                (table.take("velocity"), table.take("force"), each, Some(table.lines))
            }
        };
        let read = ForceTable {
            uncertainty: stated(test, each, velocity.len(), &file)?,
            file,
            velocity,
            force,
        };
        let mut problems = read.problems(lines.as_deref());
        problems.extend(read.too_few());
        problems.extend(read.no_sine(test.amplitude));
        InputError::unless_empty(problems, Some(read))
    }
}

/// The uncertainty of the run for all forces, or of its file for each.
fn stated(test: &Dynamometer, each: Option<Vec<f64>>, rows: usize, file: &Path) -> Result<Vec<f64>, InputError> {
    let problem = |found: &str, remedy: &str| {
        let expected = "the standard deviation of a force (N), in the run or in a column";
        Problem::new(file, Place::Name("uncertainty".into()), found, expected, remedy)
    };
    match (test.uncertainty, each) {
        (Some(all), None) => Ok(vec![all; rows]),
        (None, Some(each)) => Ok(each),
        (None, None) => Err(problem(
            "no uncertainty",
            "add `uncertainty = \"10 N\"` to the run, or a column `uncertainty` to the table",
        )
        .into()),
        (Some(_), Some(_)) => Err(problem("an uncertainty in the run and a column of it", "remove one of them").into()),
    }
}

impl ForceTable {
    fn too_few(&self) -> Option<Problem> {
        let (found, expected) = (
            "a single row",
            "at least two: a force in rebound and one in compression",
        );
        let problem = || Problem::new(&self.file, Place::File, found, expected, "export the whole table");
        (self.velocity.len() < FEWEST).then(problem)
    }

    /// Problem of speeds that no sine of this amplitude (m) has on a dynamometer.
    fn no_sine(&self, amplitude: f64) -> Option<Problem> {
        let fastest = self.velocity.iter().fold(0.0, |most: f64, speed| most.max(speed.abs()));
        let frequency = fastest / (TAU * amplitude);
        let problem = || {
            let found = format!(
                "a largest speed of {}, for which a sine of the amplitude {} has {}",
                shown(fastest, "m/s"),
                shown(amplitude, "m"),
                shown(rounded(frequency, 3), "Hz")
            );
            let expected = format!("from {} to {} Hz", POSSIBLE.start(), POSSIBLE.end());
            let remedy = "correct the unit of the column, such as `velocity [mm/s]`, or `amplitude` in campaign.toml";
            Problem::new(&self.file, Place::Name("velocity".into()), found, expected, remedy)
        };
        (fastest > 0.0 && !POSSIBLE.contains(&frequency)).then(problem)
    }

    /// Checks the rows; `lines` are their lines in a plain table.
    fn problems(&self, lines: Option<&[u64]>) -> Vec<Problem> {
        let place = |row: usize, name: &str| match lines {
            Some(lines) => Place::Cell(lines[row], name.into()),
            None => Place::Name(name.into()),
        };
        let most = self.force.iter().fold(0.0, |most: f64, force| most.max(force.abs()));
        let mut problems = Vec::new();
        let mut turned = Vec::new();
        for row in 0..self.velocity.len() {
            let (velocity, force, uncertainty) = (self.velocity[row], self.force[row], self.uncertainty[row]);
            let problem = |name, found: f64, expected, remedy| {
                Problem::new(&self.file, place(row, name), format!("{found}"), expected, remedy)
            };
            if velocity == 0.0 {
                let expected = "a nonzero speed of the rod at the middle of its travel";
                problems.push(problem("velocity", velocity, expected, "remove the row"));
            }
            if uncertainty <= 0.0 {
                let expected = "a standard deviation above zero (N)";
                problems.push(problem("uncertainty", uncertainty, expected, "correct it"));
            }
            if force * velocity < 0.0 && force.abs() > (PUSHES * uncertainty).max(NOTABLE * most) {
                turned.push(row);
            }
        }
        if let Some(&row) = turned.first() {
            let found = format!(
                "a force of {} at {}, which acts in the direction of the motion, and {} such rows in all",
                shown(self.force[row], "N"),
                shown(self.velocity[row], "m/s"),
                turned.len()
            );
            let expected =
                "velocity and force both positive as the damper gets longer (rebound), both negative in compression";
            let remedy = "reverse the sign of one of the columns, for example `force = { source = \"force\", unit = \"N\", sign = -1 }` in the run";
            problems.push(Problem::new(&self.file, place(row, "force"), found, expected, remedy));
        }
        problems
    }
}
