//! One file per verb: its flags and its work. A verb returns the text for standard output.

use std::path::PathBuf;

use clap::{Args, ValueEnum};
use clap_complete::engine::ArgValueCompleter;

use crate::completion;
use crate::parameters::Setting;

// Completion scripts of shells.
pub mod completions;
// A first model file, campaign folder or workbook.
pub mod new;
// The stages of a model as text.
pub mod show;
// Differences between two models.
pub mod diff;
// The catalogue of effects.
pub mod effects;
// A model with an effect added.
pub mod patch;
// Matrices with their derivatives.
pub mod matrices;
// Natural frequencies and mode shapes.
pub mod modes;
// Frequency responses.
pub mod frf;
// A model for other tools.
pub mod export;
// The channels of a measured file.
pub mod inspect;
// A first campaign from measured files.
pub mod import;
// Gradients of K&C curves.
pub mod kc;
// Parameters fitted to a campaign.
pub mod fit;
// Mistakes of a model, and of a campaign what a fit and others would refuse.
pub mod check;
// Further measurements that would determine the parameters better.
pub mod plan;
// Fitted parameters beside the true ones.
pub mod score;
// Rides and replays.
pub mod simulate;
// Metrics of many parameter sets.
pub mod explore;
// Sensitivity of metrics to parameters.
pub mod sensitivity;
// Designs that meet targets.
pub mod target;
// The effect that a model lacks.
pub mod discover;
// All verbs on one campaign, and a report.
pub mod study;
// Two parameter sets, models or campaigns beside each other.
pub mod compare;

/// A model and the values of its parameters.
#[derive(Args)]
pub struct ModelArguments {
    /// Name of a shipped model, or path of a model file
    #[arg(add = ArgValueCompleter::new(completion::models))]
    model: String,
    /// Parameter values: a TOML file with [parameters], or a campaign folder
    #[arg(long, value_name = "FILE")]
    params: Option<PathBuf>,
    /// A single value, which takes precedence over that of the file; may be repeated
    #[arg(long, value_name = "NAME=VALUE")]
    set: Vec<Setting>,
}

/// Names without duplicates, in the order of their first use.
pub(crate) fn each_once<T: PartialEq>(named: impl IntoIterator<Item = T>) -> Vec<T> {
    let mut once: Vec<T> = Vec::new();
    for own in named {
        if !once.contains(&own) {
            once.push(own);
        }
    }
    once
}

/// Output format of a result.
#[derive(Clone, Copy, ValueEnum)]
pub(crate) enum Format {
    Text,
    Json,
}

/// Output format of a result that is one table.
#[derive(Clone, Copy, ValueEnum)]
pub(crate) enum TableFormat {
    Text,
    Json,
    Csv,
}
