//! One file per verb: its flags, and what it does with them. A verb returns the text for standard output.

use std::path::PathBuf;

use clap::{Args, ValueEnum};
use clap_complete::engine::ArgValueCompleter;

use crate::completion;
use crate::parameters::Setting;

// The verbs, in the order in which `qcar --help` lists them.
pub mod check;
pub mod compare;
pub mod completions;
pub mod diff;
pub mod discover;
pub mod effects;
pub mod explore;
pub mod export;
pub mod fit;
pub mod frf;
pub mod import;
pub mod inspect;
pub mod kc;
pub mod matrices;
pub mod new;
pub mod patch;
pub mod plan;
pub mod score;
pub mod sensitivity;
pub mod show;
pub mod simulate;
pub mod study;
pub mod target;

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
