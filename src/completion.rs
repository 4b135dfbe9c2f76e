//! Completion in a shell: names of shipped models and effects, and paths.

use std::ffi::OsStr;

use clap_complete::engine::{CompletionCandidate, PathCompleter, ValueCompleter};

use crate::catalogue;

/// A model, by name or path.
pub fn models(begun: &OsStr) -> Vec<CompletionCandidate> {
    named(catalogue::names(), begun)
}

/// An effect, by name or path.
pub fn effects(begun: &OsStr) -> Vec<CompletionCandidate> {
    named(models::effects().iter().map(|effect| effect.name), begun)
}

/// Either of them.
pub fn models_and_effects(begun: &OsStr) -> Vec<CompletionCandidate> {
    let effects = models::effects().iter().map(|effect| effect.name);
    named(catalogue::names().chain(effects), begun)
}

fn named<'a>(names: impl Iterator<Item = &'a str>, begun: &OsStr) -> Vec<CompletionCandidate> {
    let typed = begun.to_string_lossy();
    let fitting = names.filter(|name| name.starts_with(&*typed));
    let paths = PathCompleter::any().complete(begun);
    fitting.map(CompletionCandidate::new).chain(paths).collect()
}
