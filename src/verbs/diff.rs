//! `qcar diff`: the differences between two models.

use clap::Args;
use clap_complete::engine::ArgValueCompleter;
use qcar_dsl::difference::{Difference, LineChange, difference};
use qcar_dsl::response::Wanted;
use serde::Serialize;

use crate::catalogue;
use crate::completion;
use crate::failure::Failure;
use crate::json::{self, Ordered};
use crate::terminal::prose;
use crate::verbs::Format;

/// Show the differences between two models: parameters, masses, links, equations
#[derive(Args)]
#[command(
    after_help = "Examples:\n  qcar diff axle_c axle_c_rigid_tm\n  qcar diff axle_a models/axles/axle_c.axle --format json"
)]
pub struct Arguments {
    /// Name of a shipped model, or path of a model file
    #[arg(add = ArgValueCompleter::new(completion::models))]
    first: String,
    /// The model to compare with it
    #[arg(add = ArgValueCompleter::new(completion::models))]
    second: String,
    /// Output format
    #[arg(long, value_enum, default_value_t = Format::Text)]
    format: Format,
}

/// One line before and after the change.
#[derive(Serialize)]
pub(crate) struct Change<'a> {
    name: &'a str,
    before: Option<&'a str>,
    after: Option<&'a str>,
}

impl Change<'_> {
    fn of(changed: &LineChange) -> Change<'_> {
        Change {
            name: &changed.name,
            before: changed.before.as_deref(),
            after: changed.after.as_deref(),
        }
    }
}

/// Runs the verb.
pub fn run(arguments: &Arguments) -> Result<String, Failure> {
    let (first, second) = (
        catalogue::compiled_wanted(&arguments.first, Wanted::Nothing)?,
        catalogue::compiled_wanted(&arguments.second, Wanted::Nothing)?,
    );
    let difference = difference(&first.model, &second.model);
    Ok(match arguments.format {
        Format::Text => prose(&difference.to_string()),
        Format::Json => in_json(&difference),
    })
}

fn in_json(difference: &Difference) -> String {
    json::line(&parts(difference))
}

/// The differences, by heading.
pub(crate) fn parts(difference: &Difference) -> Ordered<Vec<Change<'_>>> {
    let parts = difference.parts.iter().map(|part| {
        let changes: Vec<Change> = part.changes.iter().map(Change::of).collect();
        (part.heading.replace(' ', "_"), changes)
    });
    parts.collect()
}
