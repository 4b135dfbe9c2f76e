//! Traversals of expressions: their dependencies, substitution of their leaves, and their values.

use std::collections::{BTreeMap, BTreeSet};

use super::{Curve, Expr, Graph, Node, Symbol};
use crate::hash::{HashMap, HashSet};

/// An expression for each of several leaves.
pub type Leaves = BTreeMap<Symbol, Expr>;

impl Graph {
    /// The arguments of a node, in order.
    pub fn arguments(&self, node: Node) -> impl Iterator<Item = Expr> {
        let three = match node {
            Node::Constant(_) | Node::Symbol(_) => [None; 3],
            Node::Neg(a) | Node::Powi(a, _) | Node::Call(_, a) | Node::Table(_, a, _) => [Some(a), None, None],
            Node::Add(a, b) | Node::Sub(a, b) | Node::Mul(a, b) | Node::Div(a, b) => [Some(a), Some(b), None],
            Node::Pow(a, b) | Node::Min(a, b) | Node::Max(a, b) => [Some(a), Some(b), None],
            Node::Select(test, a, b) => [Some(test), Some(a), Some(b)],
        };
        let curve = match node {
            Node::Table(.., curve) => Some(self.curve(curve)),
            _ => None,
        };
        let entries = curve.into_iter().flat_map(Curve::entries).copied();
        three.into_iter().flatten().chain(entries)
    }

    /// The expression of a node whose arguments exist, with the identities applied.
    pub fn rebuild(&mut self, node: Node) -> Expr {
        match node {
            Node::Constant(bits) => self.constant(f64::from_bits(bits)),
            Node::Symbol(leaf) => self.symbol(leaf),
            Node::Neg(a) => self.neg(a),
            Node::Add(a, b) => self.add(a, b),
            Node::Sub(a, b) => self.sub(a, b),
            Node::Mul(a, b) => self.mul(a, b),
            Node::Div(a, b) => self.div(a, b),
            Node::Powi(a, n) => self.powi(a, n),
            Node::Pow(a, b) => self.pow(a, b),
            Node::Min(a, b) => self.min(a, b),
            Node::Max(a, b) => self.max(a, b),
            Node::Call(f, a) => self.call(f, a),
            Node::Select(test, a, b) => self.select(test, a, b),
            Node::Table(order, x, curve) => self.table(order, x, self.curve(curve).clone()),
        }
    }

    /// The leaves that expressions depend on.
    pub fn symbols(&self, roots: impl IntoIterator<Item = Expr>) -> BTreeSet<Symbol> {
        let mut seen = HashSet::default();
        let mut found = BTreeSet::new();
        let mut waiting: Vec<Expr> = roots.into_iter().collect();
        while let Some(e) = waiting.pop() {
            if !seen.insert(e) {
                continue;
            }
            if let Node::Symbol(leaf) = self.node(e) {
                found.insert(leaf);
            }
            waiting.extend(self.arguments(self.node(e)));
        }
        found
    }

    /// The value of an expression for given values of its leaves.
    pub fn evaluate(&self, e: Expr, leaf: &impl Fn(Symbol) -> f64) -> f64 {
        let value = |a| self.evaluate(a, leaf);
        match self.node(e) {
            Node::Constant(bits) => f64::from_bits(bits),
            Node::Symbol(symbol) => leaf(symbol),
            Node::Neg(a) => -value(a),
            Node::Add(a, b) => value(a) + value(b),
            Node::Sub(a, b) => value(a) - value(b),
            Node::Mul(a, b) => value(a) * value(b),
            Node::Div(a, b) => value(a) / value(b),
            Node::Powi(a, n) => value(a).powi(n),
            Node::Pow(a, b) => value(a).powf(value(b)),
            Node::Min(a, b) => value(a).min(value(b)),
            Node::Max(a, b) => value(a).max(value(b)),
            Node::Call(f, a) => f.value(value(a)),
            Node::Select(test, a, b) => value(if value(test) > 0.0 { a } else { b }),
            Node::Table(order, x, curve) => self.curve(curve).at(order, value(x), |&entry| value(entry)),
        }
    }
}

/// Replaces leaves by expressions, once: leaves in the replacements stay.
#[derive(Clone, Debug)]
pub struct Substitution {
    leaves: Leaves,
    known: HashMap<Expr, Expr>,
}

impl Substitution {
    /// Replaces these leaves.
    pub fn new(leaves: Leaves) -> Self {
        Substitution {
            leaves,
            known: HashMap::default(),
        }
    }

    /// Substitutes definitions, each of which may use earlier ones. The replacements contain no defined leaf.
    pub fn of_definitions(graph: &mut Graph, definitions: &[(Symbol, Expr)]) -> Self {
        let mut substitution = Self::new(Leaves::new());
        for &(leaf, definition) in definitions {
            let value = substitution.apply(graph, definition);
            substitution.leaves.insert(leaf, value);
        }
        substitution
    }

    /// The expression with its leaves replaced.
    pub fn apply(&mut self, graph: &mut Graph, e: Expr) -> Expr {
        if let Some(&known) = self.known.get(&e) {
            return known;
        }
        let node = graph.node(e);
        let result = match node {
            Node::Symbol(leaf) => self.leaves.get(&leaf).copied().unwrap_or(e),
            Node::Table(order, x, curve) => {
                let curve = graph.curve(curve).clone().map(|&entry| self.apply(graph, entry));
                let x = self.apply(graph, x);
                graph.table(order, x, curve)
            }
            _ => {
                let node = node.map(|a| self.apply(graph, a));
                graph.rebuild(node)
            }
        };
        self.known.insert(e, result);
        result
    }
}

impl Node {
    /// The same operation with other arguments; a curve keeps its points.
    pub fn map(self, mut f: impl FnMut(Expr) -> Expr) -> Node {
        match self {
            Node::Constant(_) | Node::Symbol(_) => self,
            Node::Table(order, x, curve) => Node::Table(order, f(x), curve),
            Node::Neg(a) => Node::Neg(f(a)),
            Node::Add(a, b) => Node::Add(f(a), f(b)),
            Node::Sub(a, b) => Node::Sub(f(a), f(b)),
            Node::Mul(a, b) => Node::Mul(f(a), f(b)),
            Node::Div(a, b) => Node::Div(f(a), f(b)),
            Node::Powi(a, n) => Node::Powi(f(a), n),
            Node::Pow(a, b) => Node::Pow(f(a), f(b)),
            Node::Min(a, b) => Node::Min(f(a), f(b)),
            Node::Max(a, b) => Node::Max(f(a), f(b)),
            Node::Call(function, a) => Node::Call(function, f(a)),
            Node::Select(test, a, b) => Node::Select(f(test), f(a), f(b)),
        }
    }
}
