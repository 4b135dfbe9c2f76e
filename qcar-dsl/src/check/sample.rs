//! Generic values for the leaves of expressions. A structural property, such as a rank, holds at almost every point, so
//! a few pseudo-random points decide it. The points are always the same, which keeps the compiler deterministic.

use std::cell::RefCell;

use crate::expr::{Expr, Graph, Node, Symbol};
use crate::hash::HashMap;
use crate::model::{Default, Model, Parameter};

/// Ranges from which values are drawn.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Kind {
    /// Numbers near 1, for the best conditioning.
    Plain,
    /// Parameters near their defaults, or within their declared ranges; motions of millimetres.
    Declared,
}

/// A value for every leaf.
#[derive(Clone, Copy)]
pub struct Point<'a> {
    model: &'a Model,
    /// The ranges of the values.
    pub kind: Kind,
    seed: u64,
    /// Seed of all leaves other than parameters, so that a parameter set can be tested in several motions.
    motion: u64,
    /// Factor on the size of the motion.
    size: f64,
}

/// Number of motions of the usual size. Later ones have a tenth of it up to a hundred times it, log-uniform: the pieces
/// of a curve may lie anywhere.
const OF_USUAL_SIZE: u64 = 4;

impl<'a> Point<'a> {
    /// A point, determined by its number.
    pub fn new(model: &'a Model, kind: Kind, seed: u64) -> Point<'a> {
        Point {
            model,
            kind,
            seed,
            motion: seed,
            size: 1.0,
        }
    }

    /// The same parameters in another motion, specific to the parameter set.
    pub fn moved(self, motion: u64) -> Point<'a> {
        let seed = (self.seed << 8) + motion;
        let size = match motion {
            0..OF_USUAL_SIZE => 1.0,
            _ => 10.0_f64.powf(3.0 * uniform(seed, u64::MAX) - 1.0),
        };
        Point {
            motion: seed,
            size,
            ..self
        }
    }

    /// The value of a leaf.
    pub fn leaf(&self, symbol: Symbol) -> f64 {
        match symbol {
            Symbol::Parameter(index) => self.parameter(index),
            _ => {
                let scale = if self.kind == Kind::Plain { 2.0 } else { 0.1 };
                self.size * scale * (2.0 * uniform(self.motion, tag(symbol)) - 1.0)
            }
        }
    }

    fn parameter(&self, index: u16) -> f64 {
        let parameter = &self.model.parameters[usize::from(index)];
        // Time advances from motion to motion.
        let seed = if parameter.clock { self.motion } else { self.seed };
        let chance = uniform(seed, tag(Symbol::Parameter(index)));
        let plain = 0.5 + 1.5 * chance;
        match (self.kind, parameter.range, parameter.default) {
            // Near the defaults, since values from all over wide ranges would make a badly conditioned system.
            (Kind::Declared, Some((low, high)), Default::Value(value)) if value != 0.0 => {
                (value * plain).clamp(low, high)
            }
            (Kind::Declared, Some((low, high)), _) if low > 0.0 => low * (high / low).powf(chance),
            (Kind::Declared, Some((low, high)), _) => low + (high - low) * chance,
            (Kind::Declared, None, Default::Value(value)) => value,
            (Kind::Declared, None, Default::Same(other)) => self.parameter(other),
            _ => plain,
        }
    }
}

/// The bounds of a parameter in its declaration; its default alone if it has no range.
pub fn bounds(model: &Model, parameter: &Parameter) -> Option<(f64, f64)> {
    match (parameter.range, parameter.default) {
        (Some(range), _) => Some(range),
        (None, Default::Value(value)) => Some((value, value)),
        (None, Default::Same(other)) => bounds(model, &model.parameters[usize::from(other)]),
        (None, Default::None) => None,
    }
}

/// Expressions at a point, each computed once.
pub struct Values<'a> {
    graph: &'a Graph,
    leaf: &'a dyn Fn(Symbol) -> f64,
    known: RefCell<HashMap<Expr, f64>>,
}

impl<'a> Values<'a> {
    /// With a value for every leaf.
    pub fn new(graph: &'a Graph, leaf: &'a dyn Fn(Symbol) -> f64) -> Values<'a> {
        Values {
            graph,
            leaf,
            known: RefCell::default(),
        }
    }

    /// The value of an expression.
    pub fn of(&self, e: Expr) -> f64 {
        if let Some(&value) = self.known.borrow().get(&e) {
            return value;
        }
        let value = match self.graph.node(e) {
            Node::Constant(bits) => f64::from_bits(bits),
            Node::Symbol(symbol) => (self.leaf)(symbol),
            Node::Neg(a) => -self.of(a),
            Node::Add(a, b) => self.of(a) + self.of(b),
            Node::Sub(a, b) => self.of(a) - self.of(b),
            Node::Mul(a, b) => self.of(a) * self.of(b),
            Node::Div(a, b) => self.of(a) / self.of(b),
            Node::Powi(a, n) => self.of(a).powi(n),
            Node::Pow(a, b) => self.of(a).powf(self.of(b)),
            Node::Min(a, b) => self.of(a).min(self.of(b)),
            Node::Max(a, b) => self.of(a).max(self.of(b)),
            Node::Call(f, a) => f.value(self.of(a)),
            Node::Select(test, a, b) => self.of(if self.of(test) > 0.0 { a } else { b }),
            Node::Table(order, x, curve) => self.graph.curve(curve).at(order, self.of(x), |&entry| self.of(entry)),
        };
        self.known.borrow_mut().insert(e, value);
        value
    }
}

/// A hash of a leaf, so that equal leaves have equal values.
pub fn tag(symbol: Symbol) -> u64 {
    let (kind, first, second) = match symbol {
        Symbol::Parameter(index) => (1, index, 0),
        Symbol::Stretch(link) => (2, link.0, 0),
        Symbol::Rate(link) => (3, link.0, 0),
        Symbol::Inner(link, index) => (4, link.0, index),
        Symbol::Force(input) => (6, input, 0),
        Symbol::Position(c) => (7, c.0, 0),
        Symbol::Velocity(c) => (8, c.0, 0),
        Symbol::Acceleration(c) => (9, c.0, 0),
        Symbol::Offset(c) => (10, c.0, 0),
        _ => (5, 0, 0),
    };
    (kind << 32) | (u64::from(first) << 16) | u64::from(second)
}

/// A number between 0 and 1 (splitmix64 of Steele, Lea and Flood, 2014).
pub fn uniform(seed: u64, tag: u64) -> f64 {
    let mut z = seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) ^ tag.wrapping_mul(0xD1B5_4A32_D192_ED03);
    z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64
}
