//! The terms in the law of a link.

use std::collections::BTreeSet;

use super::rewrite::names_in;
use crate::front::syntax::{Expression, ExpressionKind, LawStatement, Name};

/// The words for what a law may have.
pub const WORDS: [&str; 5] = ["spring", "damper", "inerter", "damping", "law"];

/// The words for linear terms, which can be asked for and replaced.
pub const LINEAR: [&str; 3] = ["spring", "damper", "inerter"];

/// Whether a statement of a law is a linear term of a kind.
pub fn is_term(statement: &LawStatement, kind: &str) -> bool {
    match statement {
        LawStatement::Spring(_) => kind == "spring",
        LawStatement::Damper(_) => kind == "damper",
        LawStatement::Inerter(_) => kind == "inerter",
        _ => false,
    }
}

/// Whether a law has all of some terms.
pub fn has_terms(law: &[LawStatement], terms: &[Name]) -> bool {
    terms.iter().all(|term| match term.text.as_str() {
        "damping" => damps(law),
        "law" => law
            .iter()
            .any(|s| matches!(s, LawStatement::Force(_) | LawStatement::Use(_))),
        kind => law.iter().any(|statement| is_term(statement, kind)),
    })
}

/// A linear damper, an element, or a force of the speed or of what is computed from a state. A force that is a state as
/// it stands is friction beside other laws.
fn damps(law: &[LawStatement]) -> bool {
    let mut moving: BTreeSet<&str> = BTreeSet::from(["v"]);
    let mut found = false;
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
                let alone = matches!(&force.kind, ExpressionKind::Name(name) if name.to_string() != "v");
                found |= !alone && depends(force, &moving);
            }
            _ => {}
        }
    }
    found
}

fn depends(e: &Expression, on: &BTreeSet<&str>) -> bool {
    let mut found = false;
    names_in(e, &mut |name| found |= on.contains(name.to_string().as_str()));
    found
}
