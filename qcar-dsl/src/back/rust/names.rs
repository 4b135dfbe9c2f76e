//! Names that are free of Rust's keywords.

use crate::back::straight::Names;

/// Names that a function uses in addition to its own variables.
const RESERVED: &[&str] = &[
    "CONSTANTS",
    "INPUTS",
    "PARAMETERS",
    "STATES",
    "V",
    "f64",
    "first",
    "kept",
    "out",
    "interface",
    "sets",
    "sign",
    "table",
];

/// The names of local variables beside these arguments.
pub fn names(arguments: &[&'static str]) -> Names {
    let used = KEYWORDS.iter().chain(RESERVED).chain(arguments);
    Names::beside(used.copied())
}

/// A name as a Rust identifier, such as a field; keywords get an underscore.
pub fn identifier(name: &str) -> String {
    if is_keyword(name) {
        format!("{name}_")
    } else {
        name.to_string()
    }
}

/// `axle_d` as `AxleD`.
pub fn camel(name: &str) -> String {
    let capital = |part: &str| {
        let mut letters = part.chars();
        letters
            .next()
            .map(|first| first.to_uppercase().chain(letters).collect::<String>())
            .unwrap_or_default()
    };
    name.split('_').map(capital).collect()
}

fn is_keyword(name: &str) -> bool {
    KEYWORDS.contains(&name)
}

/// Strict and reserved keywords of all editions, and the underscore.
const KEYWORDS: &[&str] = &[
    "Self", "_", "abstract", "as", "async", "await", "become", "box", "break", "const", "continue", "crate", "do",
    "dyn", "else", "enum", "extern", "false", "final", "fn", "for", "gen", "if", "impl", "in", "let", "loop", "macro",
    "match", "mod", "move", "mut", "override", "priv", "pub", "ref", "return", "self", "static", "struct", "super",
    "trait", "true", "try", "type", "typeof", "unsafe", "unsized", "use", "virtual", "where", "while", "yield",
];
