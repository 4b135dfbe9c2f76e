//! The whole compiler in one function.

use proc_macro2::TokenStream;

use crate::check::Checked;
use crate::check::{check_text, check_tokens};
use crate::derive::alone::alone;
use crate::derive::describe::{describe, vectors};
use crate::derive::response::Wanted;
use crate::derive::{identifiability, linear, motion, response};
use crate::diagnostic::Report;
use crate::program::schedule::{Compiled, schedule};
use crate::source::{Load, Source};

/// Reads and checks a model file, with all its diagnostics, but derives no programs.
///
/// # Errors
/// Fails with the report of every mistake.
pub fn check(source: Source, load: Load) -> Result<Checked, Report> {
    check_text(source, load).map(identifiability::with_identifiability)
}

/// Compiles a model file.
///
/// # Errors
/// Fails with the report of every mistake.
pub fn compile(source: Source, load: Load) -> Result<Compiled, Report> {
    compile_wanted(source, load, Wanted::Jacobian)
}

/// The same with the wanted responses only.
///
/// # Errors
/// Fails as [`compile`] does.
pub fn compile_wanted(source: Source, load: Load, wanted: Wanted) -> Result<Compiled, Report> {
    check_text(source, load).map(|checked| derive_wanted(checked, wanted))
}

/// Compiles the tokens of an inline macro.
///
/// # Errors
/// Fails with one `compile_error!` for each mistake, at the mistaken token.
pub fn compile_tokens(tokens: TokenStream, load: Load) -> Result<Compiled, TokenStream> {
    check_tokens(tokens, load).map(derive)
}

/// One link of a model on a dynamometer, by its axis and name; see [`alone`].
pub fn derive_alone(model: &Checked, axis: &str, link: &str) -> Option<Compiled> {
    alone(model, axis, link).map(derive)
}

/// Derives a model's equations, its matrices and its responses, and schedules them.
pub fn derive(model: Checked) -> Compiled {
    derive_wanted(model, Wanted::Jacobian)
}

/// The same with the wanted responses only: derivatives are most of the work for a model with many parameters and
/// outputs.
pub fn derive_wanted(model: Checked, wanted: Wanted) -> Compiled {
    let mut graph = model.graph.clone();
    let motion = motion::derive(&model, &mut graph);
    let rolling = motion::rolling_tyre(&model).map(|tyre| (motion::derive_rolling(&model, &mut graph, &tyre), tyre));
    let linear = linear::linearise(&model, &motion, &mut graph);
    let model = identifiability::with_derived_identifiability(model, graph.clone(), &motion, &linear);
    let responses = if linear.linear {
        response::responses(&model, &mut graph, wanted)
    } else {
        Vec::new()
    };
    let programs = schedule(&mut graph, &motion, rolling.as_ref(), &linear, &responses);
    let tyre = rolling.as_ref().map(|(_, tyre)| tyre);
    let vectors = vectors(&model, &motion);
    let about = describe(
        &model,
        &vectors,
        tyre,
        &linear,
        &responses,
        programs.prepare.outputs.len(),
    );
    Compiled {
        model,
        graph,
        motion,
        linear,
        about,
        vectors,
        programs,
    }
}
