//! The smallest and largest values of expressions of parameters over the declared ranges.

use std::collections::BTreeMap;

use super::Scratch;
use super::sample::bounds;
use crate::expr::{Expr, Symbol};

/// An extreme value, and the parameters that give it.
pub struct Extreme {
    /// The value.
    pub value: f64,
    /// Names and values.
    pub at: Vec<(String, f64)>,
}

/// The value that `pick` prefers over the declared ranges, by coordinate search from bound to bound. `None` if a
/// parameter has neither range nor default, or if the expression depends on a motion.
pub fn extreme(scratch: &Scratch, e: Expr, pick: fn(f64, f64) -> f64) -> Option<Extreme> {
    let mut ranges = BTreeMap::new();
    for symbol in scratch.graph.symbols([e]) {
        let Symbol::Parameter(index) = symbol else { return None };
        ranges.insert(
            index,
            bounds(scratch.model, &scratch.model.parameters[usize::from(index)])?,
        );
    }
    let mut point: BTreeMap<u16, f64> = ranges.iter().map(|(&index, &(low, _))| (index, low)).collect();
    let value = |point: &BTreeMap<u16, f64>| {
        let leaf = |symbol| match symbol {
            Symbol::Parameter(index) => point.get(&index).copied().unwrap_or(f64::NAN),
            _ => f64::NAN,
        };
        scratch.graph.evaluate(e, &leaf)
    };
    let mut best = value(&point);
    for _ in 0..2 {
        for (&index, &(low, high)) in &ranges {
            for bound in [low, high] {
                let trial = point
                    .iter()
                    .map(|(&i, &p)| (i, if i == index { bound } else { p }))
                    .collect();
                let tried = value(&trial);
                if tried != best && pick(tried, best) == tried {
                    (point, best) = (trial, tried);
                }
            }
        }
    }
    let name = |index: &u16| scratch.model.parameters[usize::from(*index)].name.clone();
    Some(Extreme {
        value: best,
        at: point.iter().map(|(index, value)| (name(index), *value)).collect(),
    })
}
