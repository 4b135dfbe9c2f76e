//! `qcar effects`: the catalogue of effects that a model may miss.

use clap::Args;

use crate::catalogue;
use crate::effects;
use crate::failure::Failure;
use crate::table::Table;

/// List the effects that may be missing in a model, and where each applies
///
/// Without a model, the whole catalogue is described.
#[derive(Args)]
#[command(after_help = "Examples:\n  qcar effects\n  qcar effects axle_c")]
pub struct Arguments {
    /// Name of a shipped model, or path of a model file
    model: Option<String>,
}

/// Does it.
pub fn run(arguments: &Arguments) -> Result<String, Failure> {
    match &arguments.model {
        Some(model) => places(model),
        None => catalogue(),
    }
}

fn catalogue() -> Result<String, Failure> {
    let mut table = Table::new(["effect", "what it is", "how it shows"]);
    for patch in effects::all()? {
        let effect = patch.effect();
        table.row(vec![effect.name.text.clone(), effect.doc.clone(), effect.shows.clone()]);
    }
    Ok(table.text())
}

fn places(model: &str) -> Result<String, Failure> {
    let compiled = catalogue::compiled(model)?;
    let mut table = Table::new(["effect", "places"]);
    for patch in effects::all()? {
        let places = patch.places(&compiled.model);
        if !places.is_empty() {
            table.row(vec![patch.effect().name.text.clone(), places.join(", ")]);
        }
    }
    Ok(table.text())
}
