//! A compiled model as functions of JavaScript, for pages and for programs that run in a browser or in Node.
//!
//! Every statement is one operation of a program, in its order. A function takes arrays or numbers and gives a new
//! array.

// A program as a JavaScript function.
mod function;

use crate::back::straight::Straight;
use crate::program::schedule::Compiled;

/// A function of a model.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Printed {
    /// `prepare`, `derivative`, `response_z_pad`.
    pub name: String,
    /// `function prepare(p) { … }`, without a comment.
    pub text: String,
}

/// Helper functions that the others call.
pub const SUPPORT: &str = include_str!("javascript/curve.js");

/// All functions of a model; a response takes an angular frequency in rad/s.
pub fn functions(compiled: &Compiled) -> Vec<Printed> {
    let straight = Straight::new(compiled);
    let functions = straight.functions("").into_iter();
    functions
        .map(|own| Printed {
            text: function::text(&own, &straight),
            name: own.name,
        })
        .collect()
}

/// Reserved names: keywords, and names that a function uses in addition to its own variables.
pub const RESERVED: &[&str] = &[
    "Infinity",
    "Math",
    "NaN",
    "arguments",
    "await",
    "break",
    "case",
    "catch",
    "class",
    "const",
    "continue",
    "curve_at",
    "debugger",
    "default",
    "delete",
    "do",
    "else",
    "enum",
    "eval",
    "export",
    "extends",
    "false",
    "finally",
    "for",
    "function",
    "if",
    "implements",
    "import",
    "in",
    "instanceof",
    "interface",
    "let",
    "new",
    "null",
    "out",
    "package",
    "private",
    "protected",
    "public",
    "return",
    "static",
    "super",
    "switch",
    "this",
    "throw",
    "true",
    "try",
    "typeof",
    "undefined",
    "var",
    "void",
    "while",
    "with",
    "yield",
];
