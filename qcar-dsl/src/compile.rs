//! The whole compiler in one function.

use proc_macro2::TokenStream;

use crate::check::Checked;
use crate::describe::describe;
use crate::diagnostic::Report;
use crate::front::{check_text, check_tokens};
use crate::schedule::{Compiled, schedule};
use crate::source::{Load, Source};
use crate::{linear, motion, response};

/// Compiles a model file.
///
/// # Errors
/// The report of every mistake that is found.
pub fn compile(source: Source, load: Load) -> Result<Compiled, Report> {
    check_text(source, load).map(derive)
}

/// Compiles the tokens of an inline macro.
///
/// # Errors
/// One `compile_error!` for each mistake, at the mistaken token.
pub fn compile_tokens(tokens: TokenStream, load: Load) -> Result<Compiled, TokenStream> {
    check_tokens(tokens, load).map(derive)
}

/// Derives a model's equations, its matrices and its responses, and schedules them.
pub fn derive(model: Checked) -> Compiled {
    let mut graph = model.graph.clone();
    let motion = motion::derive(&model, &mut graph);
    let rolling = motion::rolling_tyre(&model).map(|tyre| (motion::derive_rolling(&model, &mut graph, &tyre), tyre));
    let linear = linear::linearise(&model, &motion, &mut graph);
    let responses = if linear.linear {
        response::responses(&model, &mut graph)
    } else {
        Vec::new()
    };
    let programs = schedule(&mut graph, &motion, rolling.as_ref(), &linear, &responses);
    let tyre = rolling.as_ref().map(|(_, tyre)| tyre);
    let about = describe(
        &model,
        &motion,
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
        programs,
    }
}
