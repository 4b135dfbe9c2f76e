//! Inertias that are zero or negative.

use super::Scratch;
use super::extremes::extreme;
use crate::diagnostic::{Diagnostic, structure};
use crate::expr::{Expr, Node, Symbol};
use crate::model::{CoordinateKind, Default, Model};

/// Checks that every inertia is positive at the defaults and somewhere in the declared ranges, and over the whole range
/// if it is a single parameter. A difference of masses need not be positive everywhere, since ranges are independent.
pub fn inertias_are_positive(scratch: &Scratch) -> Vec<Diagnostic> {
    let mut found = Vec::new();
    for coordinate in &scratch.model.coordinates {
        let CoordinateKind::Mass(inertia) = coordinate.kind else {
            continue;
        };
        let at_defaults = defaults(scratch, inertia).is_some_and(|value| value <= 0.0);
        let highest = extreme(scratch, inertia, f64::max).map(|extreme| extreme.value);
        let lowest = extreme(scratch, inertia, f64::min).map(|extreme| extreme.value);
        let is_parameter = matches!(scratch.graph.node(inertia), Node::Symbol(Symbol::Parameter(_)));
        let (span, name) = (coordinate.declared.span, &coordinate.name);
        if highest.is_some_and(|value| value <= 0.0) || at_defaults {
            found.push(structure::inertia_not_positive(span, name));
        } else if is_parameter && lowest.is_some_and(|value| value <= 0.0) {
            found.push(structure::inertia_can_vanish(span, name, lowest.unwrap_or_default()));
        }
    }
    found
}

/// The value at the defaults; `None` if a parameter has none.
fn defaults(scratch: &Scratch, e: Expr) -> Option<f64> {
    let symbols = scratch.graph.symbols([e]);
    let all = symbols.iter().all(|&symbol| default(scratch.model, symbol).is_some());
    all.then(|| {
        scratch
            .graph
            .evaluate(e, &|symbol| default(scratch.model, symbol).unwrap_or_default())
    })
}

fn default(model: &Model, symbol: Symbol) -> Option<f64> {
    let Symbol::Parameter(index) = symbol else { return None };
    match model.parameters[usize::from(index)].default {
        Default::None => None,
        Default::Value(value) => Some(value),
        Default::Same(other) => default(model, Symbol::Parameter(other)),
    }
}
