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
// A piece of a program as a Rust function.
mod function;
// Sizes and functions over typed vectors.
mod typed;
// The implementation of the trait.
mod seam;

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
    let sections = [
        USES.to_string(),
        typed::sizes(&compiled.about),
        parameters::parameters(compiled),
        typed::functions(compiled),
        seam::implementation(compiled) + &seam::blocks(&compiled.about) + &seam::sets(&compiled.about),
        about::about(&compiled.about),
        format!("{STRAIGHT}{}}}\n", indent(&function::functions(compiled).join("\n"))),
    ];
    let body = sections.join("\n");
    let fingerprint = format!(
        "\n/// A hash of the text of this module.\npub const FINGERPRINT: u64 = {:#018x};\n",
        fnv1a(body.as_bytes())
    );
    let doc = if compiled.model.doc.is_empty() {
        &compiled.model.name
    } else {
        &compiled.model.doc
    };
    format!(
        "/// {doc}\n{ALLOW}pub mod {} {{\n{}}}\n",
        compiled.model.name,
        indent(&(body + &fingerprint))
    )
}

const ALLOW: &str = "#[allow(clippy::all, unused, non_snake_case, reason = \"names and numbers are the model's, and not every model needs all\")]\n";

const USES: &str =
    "use ::qcar_runtime::generated::{Block, Jacobians, LINES, Sets, StateSpace, fixed, fixed_mut, no_response, respond, sign, together};
use ::qcar_runtime::model as seam;
use ::qcar_runtime::model::{Entry, Matrix};
use ::qcar_runtime::nalgebra::SVector;
use ::std::borrow::Cow::Borrowed;
";

const STRAIGHT: &str = "/// The straight-line functions, over arrays: no branch, no bounds check, no allocation.
pub mod straight {
    use super::{CONSTANTS, INPUTS, LINES, PARAMETERS, STATES, seam, sign};

";

fn indent(text: &str) -> String {
    let margin = |line: &str| if line.is_empty() { "" } else { "    " };
    text.lines().flat_map(|line| [margin(line), line, "\n"]).collect()
}

/// The 64-bit FNV-1a hash (Fowler, Noll and Vo).
fn fnv1a(bytes: &[u8]) -> u64 {
    bytes.iter().fold(0xcbf2_9ce4_8422_2325, |hash, &byte| {
        (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3)
    })
}
