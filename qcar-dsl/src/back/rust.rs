//! A compiled model printed as one Rust module.
//!
//! The module is written for a reviewer: the comment of every function has its equation, the lines of the model that it
//! comes from and its operation count. Every statement is one operation, and a comment names every result. The module
//! is printed as text, since tokens carry no comments. It depends on `qcar_runtime` only.

// The description of a model for the runtime.
mod about;
// Identifiers.
mod names;
// The parameters as a type.
mod parameters;
// How Rust writes an operation.
mod language;
// A piece of a program as a Rust function.
mod function;
// Functions over vectors.
mod vectors;
// Sizes and functions over typed vectors.
mod typed;
// The implementation of the trait.
mod trait_impl;

use function::Form;

use crate::back::straight::Straight;
use crate::program::schedule::Compiled;

/// The name of the type that stands for a model: `AxleD` for `axle_d`.
pub fn type_name(model: &str) -> String {
    names::camel(model)
}

/// The Rust text of a model: `pub mod name { … }`.
///
/// The same model gives the same bytes, in whatever folder its file is; `FINGERPRINT` in the text is a hash of the
/// rest.
pub fn module(compiled: &Compiled) -> String {
    let straight = Straight::new(compiled);
    let functions = straight.functions("a line");
    let numbers = functions
        .iter()
        .map(|own| function::function(&straight, own, Form::Numbers));
    let vectors = vectors::vectors(&straight, &functions, &compiled.about);
    let sections = [
        USES.to_string(),
        typed::sizes(&compiled.about),
        parameters::parameters(compiled),
        typed::functions(compiled),
        trait_impl::implementation(compiled) + &vectors.types,
        about::about(&compiled.about),
        within(STRAIGHT, numbers, "}"),
        within(WIDE, vectors.wide.iter().map(|own| indent("", own)), "    }\n}"),
        within(FOURS, vectors.fours.iter().map(|own| indent("", own)), "    }\n}"),
    ];
    let mut body = sections.join("\n");
    let hash = fnv1a(body.as_bytes());
    body += &format!("\n/// A hash of the text of this module.\npub const FINGERPRINT: u64 = {hash:#018x};\n");
    let doc = if compiled.model.doc.is_empty() {
        &compiled.model.name
    } else {
        &compiled.model.doc
    };
    let head = format!("/// {doc}\n{ALLOW}pub mod {} {{\n", compiled.model.name);
    indent(&head, &body) + "}\n"
}

const ALLOW: &str = "#[allow(clippy::all, unused, non_snake_case, reason = \"names and numbers are the model's, and not every model needs all\")]\n";

const USES: &str =
    "use ::qcar_runtime::generated::{Eight, Four, Jacobians, LinesMut, OverLines, Responds, Sets, StateSpace};
use ::qcar_runtime::generated::{fixed, fixed_mut, no_response, one, respond, respond_sets, together};
use ::qcar_runtime::model as interface;
use ::qcar_runtime::model::{Entry, Matrix};
use ::qcar_runtime::nalgebra::SVector;
use ::std::borrow::Cow::Borrowed;
";

const STRAIGHT: &str = "/// The straight-line functions, over arrays: no branch, no bounds check, no allocation.
pub mod straight {
    use super::{CONSTANTS, INPUTS, PARAMETERS, STATES, interface};
    use ::qcar_runtime::generated::{sign, table};
";

const WIDE: &str =
    "/// The same functions over vectors of four and of eight numbers: several parameter sets, or several lines of a response.
mod wide {
    use super::*;

    ::qcar_runtime::in_vectors! {
";

const FOURS: &str = "/// Further responses over vectors of four numbers.
mod fours {
    use super::*;

    ::qcar_runtime::in_fours! {
";

/// Functions between the beginning and the end of their module.
fn within(head: &str, functions: impl Iterator<Item = String>, end: &str) -> String {
    let mut text = head.to_string();
    for own in functions {
        text += &indent("\n", &own);
    }
    text + end + "\n"
}

/// A text with a margin at each of its lines, after a head without one. The text of a long model has megabytes, so each
/// copy of it counts.
fn indent(head: &str, text: &str) -> String {
    let mut indented = String::with_capacity(head.len() + text.len() + text.len() / 4);
    indented += head;
    for line in text.lines() {
        indented.extend([if line.is_empty() { "" } else { "    " }, line, "\n"]);
    }
    indented
}

/// The 64-bit FNV-1a hash (Fowler, Noll and Vo).
fn fnv1a(bytes: &[u8]) -> u64 {
    bytes.iter().fold(0xcbf2_9ce4_8422_2325, |hash, &byte| {
        (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3)
    })
}
