//! Values and derivatives of every operation.

use super::{CurveId, Expr, Function, Graph, Leaves, Node, Symbol};
use crate::hash::HashMap;

/// The derivative of `y = f(x)` by `x`, as an expression in both.
type Slope = fn(&mut Graph, Expr, Expr) -> Expr;

/// The value and the slope of a function.
#[rustfmt::skip]
fn law(f: Function) -> (fn(f64) -> f64, Slope) {
    match f {
        Function::Abs  => (f64::abs,  |g, x, _| g.of(Function::Sign.at(x))),
        Function::Sign => (sign,      |g, _, _| g.of(0.0)),
        Function::Sqrt => (f64::sqrt, |g, _, y| g.of(0.5 / y)),
        Function::Exp  => (f64::exp,  |g, _, y| g.of(y)),
        Function::Ln   => (f64::ln,   |g, x, _| g.of(1.0 / x)),
        Function::Sin  => (f64::sin,  |g, x, _| g.of(Function::Cos.at(x))),
        Function::Cos  => (f64::cos,  |g, x, _| g.of(-Function::Sin.at(x))),
        Function::Tan  => (f64::tan,  |g, _, y| g.of(1.0 + y.power(2))),
        Function::Atan => (f64::atan, |g, x, _| g.of(1.0 / (1.0 + x.power(2)))),
        Function::Tanh => (f64::tanh, |g, _, y| g.of(1.0 - y.power(2))),
    }
}

/// The sign of a number; unlike `f64::signum`, the sign of zero is zero.
fn sign(x: f64) -> f64 {
    if x > 0.0 {
        1.0
    } else if x < 0.0 {
        -1.0
    } else {
        x
    }
}

impl Function {
    /// The value at `x`.
    pub fn value(self, x: f64) -> f64 {
        law(self).0(x)
    }
}

/// Derivatives of expressions whose leaves have given derivatives: by a variable, by time, or along a direction.
#[derive(Clone, Debug)]
pub struct Differential {
    leaves: Leaves,
    known: HashMap<Expr, Expr>,
}

impl Differential {
    /// Takes the derivatives of some leaves; those of all others are zero.
    pub fn new(leaves: Leaves) -> Self {
        Differential {
            leaves,
            known: HashMap::default(),
        }
    }

    /// The derivative by one leaf.
    pub fn by(graph: &mut Graph, leaf: Symbol) -> Self {
        Self::new(Leaves::from([(leaf, graph.constant(1.0))]))
    }

    /// Gives a leaf its derivative. No expression that holds the leaf may have been differentiated before.
    pub fn set(&mut self, leaf: Symbol, derivative: Expr) {
        self.leaves.insert(leaf, derivative);
    }

    /// The derivative of a leaf; `None` if it is zero.
    pub fn leaf(&self, leaf: Symbol) -> Option<Expr> {
        self.leaves.get(&leaf).copied()
    }

    /// The leaves whose derivative is not zero.
    pub fn leaves(&self) -> impl Iterator<Item = Symbol> {
        self.leaves.keys().copied()
    }

    /// The derivative of an expression.
    pub fn of(&mut self, g: &mut Graph, e: Expr) -> Expr {
        if let Some(&known) = self.known.get(&e) {
            return known;
        }
        let derivative = self.rule(g, e);
        self.known.insert(e, derivative);
        derivative
    }

    /// The differentiation rule of each operation. `e` is the operation itself, whose value the derivatives of
    /// quotients and functions use.
    fn rule(&mut self, g: &mut Graph, e: Expr) -> Expr {
        match g.node(e) {
            Node::Constant(_) => g.constant(0.0),
            Node::Symbol(leaf) => self.leaf(leaf).unwrap_or_else(|| g.constant(0.0)),
            Node::Neg(a) => {
                let da = self.of(g, a);
                g.neg(da)
            }
            Node::Add(a, b) => {
                let (da, db) = (self.of(g, a), self.of(g, b));
                g.add(da, db)
            }
            Node::Sub(a, b) => {
                let (da, db) = (self.of(g, a), self.of(g, b));
                g.sub(da, db)
            }
            Node::Mul(a, b) => {
                let (da, db) = (self.of(g, a), self.of(g, b));
                g.of(da * b + a * db)
            }
            Node::Div(a, b) => self.quotient(g, e, a, b),
            Node::Powi(a, n) => {
                let da = self.of(g, a);
                g.of(f64::from(n) * a.power(n - 1) * da)
            }
            Node::Pow(a, b) => {
                let (da, db) = (self.of(g, a), self.of(g, b));
                g.of(e * (db * Function::Ln.at(a) + b * (da / a)))
            }
            Node::Min(a, b) => {
                let (da, db) = (self.of(g, a), self.of(g, b));
                let test = g.of(b - a);
                g.select(test, da, db)
            }
            Node::Max(a, b) => {
                let (da, db) = (self.of(g, a), self.of(g, b));
                let test = g.of(a - b);
                g.select(test, da, db)
            }
            Node::Call(f, a) => {
                let da = self.of(g, a);
                let slope = law(f).1(g, a, e);
                g.of(slope * da)
            }
            Node::Select(test, a, b) => {
                let (da, db) = (self.of(g, a), self.of(g, b));
                g.select(test, da, db)
            }
            Node::Table(order, x, curve) => self.table(g, order, x, curve),
        }
    }

    /// The change along the curve, and that of the curve itself.
    fn table(&mut self, g: &mut Graph, order: u8, x: Expr, curve: CurveId) -> Expr {
        let curve = g.curve(curve).clone();
        let dx = self.of(g, x);
        let slope = g.table(order + 1, x, curve.clone());
        let along = g.mul(slope, dx);
        let mut change = curve.map(|&entry| self.of(g, entry));
        change.monotone = false;
        let of_curve = g.table(order, x, change);
        g.add(along, of_curve)
    }

    /// `(da - (a/b) db) / b`, which shares the quotient and its divisor.
    fn quotient(&mut self, g: &mut Graph, e: Expr, a: Expr, b: Expr) -> Expr {
        let da = self.of(g, a);
        if let (Node::Powi(base, n), Some(0.0)) = (g.node(b), g.as_constant(da)) {
            let rate = self.of(g, base);
            return g.of(-f64::from(n) * (e / base * rate));
        }
        let db = self.of(g, b);
        g.of((da - e * db) / b)
    }
}
