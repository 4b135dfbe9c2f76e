//! `qcar new template`: the workbook of a vehicle, to be filled in with Excel (thesis section 3.2).

use std::path::{Path, PathBuf};

use clap::Args;
use clap_complete::engine::ArgValueCompleter;
use qcar_runtime::error::InputError;

use super::must_be_new;
use crate::catalogue;
use crate::completion;
use crate::failure::{Failure, flag};
use crate::files::put;
use crate::parameters;
use crate::spreadsheet::{CellFormats, filled};
use rows::{Row, rows};

// The rows of the workbook.
mod rows;
// The sheet of values.
mod values;
// The sheets of curves and cleats.
mod tables;

/// Write the workbook of a vehicle for Excel: parameters of both axles, K&C and damper curves, cleats
///
/// Every value has a cell with a name such as front.k_tire, a unit that may be changed, and bounds. A campaign takes it
/// with `workbook = "vehicle.xlsx"`, and --params takes it wherever values are wanted.
#[derive(Args)]
#[command(
    after_help = "Examples:\n  qcar new template vehicle.xlsx\n  qcar new template city_car.xlsx --model axle_a --params models/campaigns/axle_a_rig --units engineering"
)]
pub(super) struct Arguments {
    /// The file to write, which ends in .xlsx
    file: PathBuf,
    /// Parameters of this model only, by name or path, instead of those of all shipped corner models
    #[arg(long, add = ArgValueCompleter::new(completion::models))]
    model: Option<String>,
    /// Initial values for the front axle: a TOML file with [parameters], or a campaign folder
    #[arg(long, value_name = "FILE")]
    params: Option<PathBuf>,
}

pub(super) fn run(arguments: &Arguments) -> Result<String, Failure> {
    let file = &arguments.file;
    let name = file.file_name().and_then(|name| name.to_str()).unwrap_or_default();
    if !name.ends_with(".xlsx") {
        let found = format!("`{}`", file.display());
        return Err(flag(
            "FILE",
            found,
            "a name that ends in .xlsx",
            "write a name such as vehicle.xlsx",
        )
        .into());
    }
    must_be_new(file)?;
    let models = match &arguments.model {
        Some(model) => vec![catalogue::load(model)?],
        None => corners()?,
    };
    let mut rows = rows(models.iter().map(|model| model.about()));
    let given = arguments
        .params
        .as_deref()
        .map(parameters::given)
        .transpose()?
        .unwrap_or_default();
    rows.iter_mut()
        .for_each(|row| row.front = given.get(&row.name).copied());
    let bytes = workbook(file, arguments.model.as_deref(), &rows)?;
    put(file.parent().unwrap_or(Path::new("")), name, &bytes)?;
    let file = file.display();
    Ok(format!(
        "{file} written. Fill it in, then\n  write `workbook = \"{name}\"` into a campaign.toml, or\n  \
         qcar frf MODEL --params {file}\n"
    ))
}

/// The shipped models of a corner of a car.
fn corners() -> Result<Vec<catalogue::Loaded>, Failure> {
    let mut found = Vec::new();
    for name in catalogue::names() {
        let model = catalogue::load(name)?;
        if model.about().parameters.iter().any(|own| own.name == "m_corner") {
            found.push(model);
        }
    }
    Ok(found)
}

fn workbook(file: &Path, model: Option<&str>, rows: &[Row]) -> Result<Vec<u8>, InputError> {
    filled(file, |workbook| {
        let formats = CellFormats::default();
        values::write(workbook, &formats, model, rows)?;
        tables::write(workbook, &formats)
    })
}
