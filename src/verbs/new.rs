//! `qcar new`: first files, which never overwrite others.

use std::path::{Path, PathBuf};

use clap::{Args, Subcommand};
use qcar_runtime::spelling;

use crate::failure::{Failure, flag};

// A model file and its parameters.
mod axle;
// The records of a campaign without a rig for cars.
pub(super) mod records;
// An empty campaign folder.
pub(super) mod campaign;
// The workbook of a vehicle.
mod template;

/// Create first files for an axle, a campaign or a vehicle, with comments that explain the next steps
///
/// Existing files are never overwritten.
#[derive(Args)]
#[command(
    after_help = "Examples:\n  qcar new axle city_car\n  qcar new campaign city_car_rig --model city_car.axle\n  qcar new template vehicle.xlsx"
)]
pub struct Arguments {
    #[command(subcommand)]
    what: What,
}

#[derive(Subcommand)]
enum What {
    Axle(axle::Arguments),
    Campaign(campaign::Arguments),
    Template(template::Arguments),
}

/// Runs the verb.
pub fn run(arguments: &Arguments) -> Result<String, Failure> {
    match &arguments.what {
        What::Axle(arguments) => axle::run(arguments),
        What::Campaign(arguments) => campaign::run(arguments),
        What::Template(arguments) => template::run(arguments),
    }
}

/// A name, and the folder for its files.
#[derive(Args)]
struct Named {
    /// Lower-case letters, digits and `_`, a letter first
    name: String,
    /// The folder to write into instead of the current one; created if missing
    #[arg(long, value_name = "DIR")]
    dir: Option<PathBuf>,
}

impl Named {
    /// The folder to write into.
    fn folder(&self) -> &Path {
        self.dir.as_deref().unwrap_or("".as_ref())
    }

    /// Checks a name against the rules of model files and file systems.
    fn check(&self) -> Result<(), Failure> {
        if spelling::is_name(&self.name) {
            return Ok(());
        }
        let found = format!("`{}`", self.name);
        let expected = "lower-case letters, digits and `_`, a letter first";
        Err(flag("NAME", found, expected, "write a name such as `city_car`").into())
    }
}

/// Fails if a file or folder exists.
fn must_be_new(path: &Path) -> Result<(), Failure> {
    if !path.exists() {
        return Ok(());
    }
    let found = format!("{}, which exists already", path.display());
    let remedy = "choose another name or another folder with --dir, or move it away";
    Err(flag("NAME", found, "a name that is not in use", remedy).into())
}
