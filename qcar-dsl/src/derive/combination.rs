//! Sums of products with common factors taken out, as usual for a lever: `(a - b) + r (b - c)`, not `a + (r - 1) b - r
//! c`. Common parts of links are then one expression.

use crate::derive::elimination::Scalar;
use crate::expr::{Expr, Graph, Node};

/// `Σ coefficient value`
pub fn combine<S: Scalar>(g: &mut Graph, terms: impl IntoIterator<Item = (Expr, S)>) -> S {
    let mut parts: Vec<(Expr, S)> = Vec::new();
    for (coefficient, value) in terms {
        for (factor, number) in summands(g, coefficient) {
            let number = g.constant(number);
            let term = value.scale(g, number);
            match parts.iter_mut().find(|(other, _)| *other == factor) {
                Some((_, sum)) => *sum = sum.add(g, term),
                None => parts.push((factor, term)),
            }
        }
    }
    let zero = S::zero(g);
    parts.into_iter().fold(zero, |total, (factor, sum)| {
        let part = sum.scale(g, factor);
        total.add(g, part)
    })
}

/// A coefficient as a sum of numbers times factors; the factor of a plain number is 1.
fn summands(g: &mut Graph, coefficient: Expr) -> Vec<(Expr, f64)> {
    let scaled = |summands: Vec<(Expr, f64)>, by: f64| summands.into_iter().map(move |(factor, x)| (factor, by * x));
    match g.node(coefficient) {
        Node::Constant(bits) => vec![(g.constant(1.0), f64::from_bits(bits))],
        Node::Neg(a) => scaled(summands(g, a), -1.0).collect(),
        Node::Add(a, b) => summands(g, a).into_iter().chain(summands(g, b)).collect(),
        Node::Sub(a, b) => {
            let left = summands(g, a);
            left.into_iter().chain(scaled(summands(g, b), -1.0)).collect()
        }
        _ => vec![(coefficient, 1.0)],
    }
}
