//! One file a verb: its flags, and what it does with them. A verb gives the text for standard output.

use std::path::PathBuf;

use clap::{Args, ValueEnum};

use crate::parameters::Setting;

pub mod check;
pub mod compare;
pub mod completions;
pub mod diff;
pub mod discover;
pub mod effects;
pub mod export;
pub mod fit;
pub mod frf;
pub mod inspect;
pub mod kc;
pub mod matrices;
pub mod new;
pub mod patch;
pub mod score;
pub mod show;
pub mod simulate;
pub mod study;

/// A model and the values of its parameters.
#[derive(Args)]
pub struct ModelArguments {
    /// Name of a shipped model, or path of a model file
    model: String,
    /// Parameter values: a TOML file with [parameters], or a campaign folder
    #[arg(long, value_name = "FILE")]
    params: Option<PathBuf>,
    /// One value, in place of that of the file; may be repeated
    #[arg(long, value_name = "NAME=VALUE")]
    set: Vec<Setting>,
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
