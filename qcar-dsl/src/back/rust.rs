//! A compiled model printed as one Rust module.
//!
//! The module is prose for a reviewer: every function carries its equation, the lines of the model that it comes from
//! and its operation count; every statement is one operation, every result says what it is. It is written as text and
//! not as tokens, since tokens carry no comments. It needs `qcar_runtime` and nothing else.

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
/// The same model gives the same bytes, wherever its file lies; `FINGERPRINT` in the text is a hash of the rest of it.
pub fn module(compiled: &Compiled) -> String {
    let sections = [
        USES.to_string(),
        typed::sizes(&compiled.about),
        parameters::parameters(compiled),
        typed::functions(compiled),
        seam::implementation(compiled) + &seam::responses(&compiled.about) + &seam::sets(&compiled.about),
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

const USES: &str = "use ::qcar_runtime::generated::{Entries, Jacobians, LinesMut, Number, Responds, Results, Rows, RowsMut, Sets, StateSpace};
use ::qcar_runtime::generated::{contact, fixed, fixed_mut, no_response, respond, respond_sets, together};
use ::qcar_runtime::model as seam;
use ::qcar_runtime::model::{Entry, Matrix, Model as _};
use ::qcar_runtime::nalgebra::SVector;
use ::std::borrow::Cow::Borrowed;
";

const STRAIGHT: &str = "/// The straight-line functions, over numbers or vectors of them: no branch, no allocation.
///
/// They are inlined into what knows the instructions for such vectors.
pub mod straight {
    use super::{CONSTANTS, Entries, INPUTS, Number, PARAMETERS, Results, STATES, seam};

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
