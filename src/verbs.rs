//! One file per verb: its flags, and what it does with them. A verb returns the text for standard output.

use std::path::PathBuf;

use clap::{Args, ValueEnum};
use clap_complete::engine::ArgValueCompleter;

use crate::completion;
use crate::parameters::Setting;

// The verbs themselves.
pub mod completions;
// A model file: begun,
pub mod new;
// checked,
pub mod check;
// examined,
pub mod show;
// beside another,
pub mod diff;
// with effects of the catalogue
pub mod effects;
// in it.
pub mod patch;
// What a model says: its matrices
pub mod matrices;
// its frequency response,
pub mod frf;
// and all of it for other tools.
pub mod export;
// What was measured: the channels of a file
pub mod inspect;
// and the campaign that they make,
pub mod import;
// and K&C curves,
pub mod kc;
// a model fitted to it,
pub mod fit;
// what else would tell its parameters,
pub mod plan;
// to one whose answer is known,
pub mod score;
// driven over its roads,
pub mod simulate;
// over cleats with many parameter sets,
pub mod explore;
// what its metrics depend on,
pub mod sensitivity;
// what it must be for them to be as they are wanted,
pub mod target;
// and what it lacks.
pub mod discover;
// All of that at once,
pub mod study;
// or of two sides.
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

/// What is named, each once, in the order of the first.
pub(crate) fn each_once<T: PartialEq>(named: impl IntoIterator<Item = T>) -> Vec<T> {
    let mut once: Vec<T> = Vec::new();
    for own in named {
        if !once.contains(&own) {
            once.push(own);
        }
    }
    once
}

/// How a result is printed.
#[derive(Clone, Copy, ValueEnum)]
pub(crate) enum Format {
    Text,
    Json,
}

/// How a result that is one table is printed.
#[derive(Clone, Copy, ValueEnum)]
pub(crate) enum TableFormat {
    Text,
    Json,
    Csv,
}
