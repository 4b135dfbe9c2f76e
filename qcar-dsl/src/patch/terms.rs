//! The terms in the law of a link.

use std::collections::BTreeSet;

use super::rewrite::names_in;
use crate::front::syntax::{Expression, ExpressionKind, LawStatement, Name, Operator};

/// The words for terms that a law may have.
pub const WORDS: [&str; 5] = ["spring", "damper", "inerter", "damping", "law"];

/// The words for linear terms, which effects can read and replace.
pub const LINEAR: [&str; 3] = ["spring", "damper", "inerter"];

/// True if a statement of a law is a linear term of a kind.
pub fn is_term(statement: &LawStatement, kind: &str) -> bool {
    match statement {
        LawStatement::Spring(_) => kind == "spring",
        LawStatement::Damper(_) => kind == "damper",
        LawStatement::Inerter(_) => kind == "inerter",
        _ => false,
    }
}

/// True if a law has all of these terms.
pub fn has_terms(law: &[LawStatement], terms: &[Name]) -> bool {
    terms.iter().all(|term| match term.text.as_str() {
        "damping" => damps(law),
        "law" => law
            .iter()
            .any(|s| matches!(s, LawStatement::Force(_) | LawStatement::Use(_))),
        kind => law.iter().any(|statement| is_term(statement, kind)),
    })
}

/// True if a law has damping: a linear damper, an element, or a force that depends on the rate or on a value computed
/// from a state. A force that equals a state is damping if the state relaxes at rest; otherwise it is friction in
/// addition to other laws.
fn damps(law: &[LawStatement]) -> bool {
    let mut moving: BTreeSet<&str> = BTreeSet::from(["v"]);
    let mut found = false;
    let relaxes = |force: &str| {
        law.iter()
            .any(|own| matches!(own, LawStatement::Rate(name, rate) if name.text == force && !vanishes_at_rest(rate)))
    };
    for statement in law {
        match statement {
            LawStatement::State(name, _) => {
                moving.insert(&name.text);
            }
            LawStatement::Let(own) if depends(&own.value, &moving) => {
                moving.insert(&own.name.text);
            }
            LawStatement::Damper(_) | LawStatement::Use(_) => found = true,
            LawStatement::Force(force) => {
                found |= match &force.kind {
                    ExpressionKind::Name(name) if name.to_string() != "v" => relaxes(&name.to_string()),
                    _ => depends(force, &moving),
                };
            }
            _ => {}
        }
    }
    found
}

/// True if an expression is zero whenever `v` is, whatever the rest.
fn vanishes_at_rest(e: &Expression) -> bool {
    match &e.kind {
        ExpressionKind::Name(name) => name.to_string() == "v",
        ExpressionKind::Negative(a) => vanishes_at_rest(a),
        ExpressionKind::Binary(Operator::Add | Operator::Subtract, a, b) => vanishes_at_rest(a) && vanishes_at_rest(b),
        ExpressionKind::Binary(Operator::Multiply, a, b) => vanishes_at_rest(a) || vanishes_at_rest(b),
        ExpressionKind::Binary(Operator::Divide | Operator::Power, a, _) => vanishes_at_rest(a),
        ExpressionKind::Call(name, arguments) => name.text == "abs" && arguments.iter().all(vanishes_at_rest),
        ExpressionKind::If(_, a, b) => vanishes_at_rest(a) && vanishes_at_rest(b),
        _ => false,
    }
}

fn depends(e: &Expression, on: &BTreeSet<&str>) -> bool {
    let mut found = false;
    names_in(e, &mut |name| found |= on.contains(name.to_string().as_str()));
    found
}
