//! `qcar patch`: a model with an effect in it, as a model file.

use std::path::PathBuf;

use clap::Args;
use clap_complete::engine::ArgValueCompleter;
use qcar_dsl::response::Wanted;

use super::ModelArguments;
use crate::catalogue;
use crate::completion;
use crate::effects;
use crate::failure::Failure;
use crate::files::{must_be_free, put};
use crate::parameters;
use crate::table::noted;
use crate::terminal::aside;

/// Add an effect to a model and write the new model file
///
/// The new file contains the whole model, with its options resolved, and compiles like any other. Ranges and start
/// values that depend on the model's own parameters are evaluated at the given values, at the defaults, or else in the
/// middle of the ranges. An existing file is never overwritten.
#[derive(Args)]
#[command(
    after_help = "Examples:\n  qcar patch axle_c coulomb_friction --at damper\n  qcar patch axle_a bushing_relaxation --at top_mount --params models/campaigns/axle_a_rig --out softer.axle"
)]
pub struct Arguments {
    #[command(flatten)]
    model: ModelArguments,
    /// Name of a shipped effect (`qcar effects` lists them), or path of an effect's file
    #[arg(add = ArgValueCompleter::new(completion::effects))]
    effect: String,
    /// The place: a link, mass or sensor location of the model
    #[arg(long, value_name = "PLACE")]
    at: String,
    /// One of the effect's forms; default: the usual one
    #[arg(long, value_name = "FORM")]
    form: Option<String>,
    /// File to write; default: standard output
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
}

/// Text in place of the evidence of a discovery.
const NO_EVIDENCE: &str = "Evidence: none yet.";

/// Runs the verb.
pub fn run(arguments: &Arguments) -> Result<String, Failure> {
    arguments.out.as_deref().map_or(Ok(()), must_be_free)?;
    let ModelArguments { model, params, set } = &arguments.model;
    let compiled = catalogue::compiled_wanted(model, Wanted::Nothing)?;
    let values = parameters::stated(&compiled.about, params.as_deref(), set)?;
    let patched = effects::find(&arguments.effect, arguments.form.as_deref())?
        .apply(&compiled.model, &arguments.at, &|name| values.get(name).copied())
        .map_err(|report| Failure::Input(report.to_string()))?;
    let text = patched.text(NO_EVIDENCE);
    let mut notes = parameters::stated_out_of_range(&compiled.about, &values);
    notes.extend(patched.note_on_sensors().map(String::from));
    let notes = noted(&notes);
    let Some(path) = &arguments.out else {
        aside(&notes);
        return Ok(text);
    };
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    put(path.parent().unwrap_or("".as_ref()), &name, &text)?;
    Ok(format!("{} written to {}\n{notes}", patched.model.name, path.display()))
}
