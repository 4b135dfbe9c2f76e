//! Expressions: one hash-consed graph for a model; identities are applied on construction.
//!
//! An [`Expr`] is a name for a node of its [`Graph`]; equal expressions are the same name, so that common
//! subexpressions are shared without any search. Nothing is multiplied out: the physics stays factored.

// Curves through points.
mod curve;
// The leaves of expressions, and their replacement.
mod rewrite;
// Operators on expressions.
mod algebra;
// Values and derivatives.
mod calculus;

use qcar_model::Quantity;

use crate::hash::HashMap;

pub use algebra::Formula;
pub use calculus::Differential;
pub use curve::Curve;
pub use rewrite::{Leaves, Substitution};

/// A mass, node, road or prescribed motion of the model: an index into `Model::coordinates`.
#[derive(Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Debug)]
pub struct CoordinateId(pub u16);

/// A link of the model: an index into `Model::links`.
#[derive(Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Debug)]
pub struct LinkId(pub u16);

/// What an expression may depend on.
#[derive(Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Debug)]
pub enum Symbol {
    /// A parameter of the model, by its place in `Model::parameters`.
    Parameter(u16),
    /// The position of a coordinate, m or rad.
    Position(CoordinateId),
    /// The position of a massless node relative to the one that leads its group, see `motion`.
    Offset(CoordinateId),
    /// The velocity of a coordinate, m/s or rad/s.
    Velocity(CoordinateId),
    /// The acceleration of a coordinate; of a prescribed motion it is an input.
    Acceleration(CoordinateId),
    /// The stretch `s` of a link, inside its law.
    Stretch(LinkId),
    /// The rate `v = ds/dt` of a link, inside its law.
    Rate(LinkId),
    /// The resisting force of a link without that of its inerters, N, positive in tension.
    LinkForce(LinkId),
    /// An inner state of a link's law, by its place in the law.
    Inner(LinkId, u16),
    /// A force input, by its place in `Model::forces`, N.
    Force(u16),
    /// Gravity of a direction, by its place in `Model::gravities`, m/s².
    Gravity(u16),
    /// The force of a rolling tyre on its wheel, by the place of its direction in `ContactAbout::axes` of the
    /// description, N.
    ContactForce(u16),
    /// The angular frequency ω of a harmonic excitation, rad/s.
    Frequency,
}

impl Symbol {
    /// The position, velocity or acceleration of a coordinate.
    pub fn of_motion(c: CoordinateId, quantity: Quantity) -> Symbol {
        match quantity {
            Quantity::Position => Symbol::Position(c),
            Quantity::Velocity => Symbol::Velocity(c),
            Quantity::Acceleration => Symbol::Acceleration(c),
        }
    }
}

/// A function of one argument.
#[derive(Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Debug)]
#[expect(missing_docs, reason = "each is the mathematical function of its name")]
pub enum Function {
    Abs,
    /// -1, 0 or 1; the sign of zero is 0.
    Sign,
    Sqrt,
    Exp,
    Ln,
    Sin,
    Cos,
    Tan,
    Atan,
    Tanh,
}

/// A node of the graph.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub enum Node {
    /// A number, by its bits, so that it can be hashed.
    Constant(u64),
    /// A leaf.
    Symbol(Symbol),
    /// `-a`
    Neg(Expr),
    /// `a + b`
    Add(Expr, Expr),
    /// `a - b`
    Sub(Expr, Expr),
    /// `a b`
    Mul(Expr, Expr),
    /// `a / b`
    Div(Expr, Expr),
    /// `a^n` for a whole number n other than 0 and 1
    Powi(Expr, i32),
    /// `a^b` for a positive a
    Pow(Expr, Expr),
    /// The smaller of two.
    Min(Expr, Expr),
    /// The larger of two.
    Max(Expr, Expr),
    /// `f(a)`
    Call(Function, Expr),
    /// The second if the first is above zero, else the third.
    Select(Expr, Expr, Expr),
    /// A derivative of a curve at an abscissa; the order is from 0 (the value) to 3.
    Table(u8, Expr, CurveId),
}

/// A name for a curve of a [`Graph`].
#[derive(Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Debug)]
pub struct CurveId(u32);

/// A name for a node of a [`Graph`].
#[derive(Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Debug)]
pub struct Expr(u32);

/// The graph in which all expressions of one model live.
#[derive(Clone, Default, Debug)]
pub struct Graph {
    nodes: Vec<Node>,
    names: HashMap<Node, Expr>,
    curves: Vec<Curve<Expr>>,
    curve_names: HashMap<Curve<Expr>, CurveId>,
}

impl Graph {
    /// Number of expressions, which measures the work of deriving them.
    pub fn size(&self) -> usize {
        self.nodes.len()
    }

    /// The node of a name.
    pub fn node(&self, e: Expr) -> Node {
        self.nodes[e.0 as usize]
    }

    /// The value of a constant, or `None` for anything else.
    pub fn as_constant(&self, e: Expr) -> Option<f64> {
        match self.node(e) {
            Node::Constant(bits) => Some(f64::from_bits(bits)),
            _ => None,
        }
    }

    fn intern(&mut self, node: Node) -> Expr {
        if let Some(&e) = self.names.get(&node) {
            return e;
        }
        let e = Expr(self.nodes.len() as u32);
        self.nodes.push(node);
        self.names.insert(node, e);
        e
    }

    /// A number.
    pub fn constant(&mut self, value: f64) -> Expr {
        self.intern(Node::Constant(value.to_bits()))
    }

    /// A leaf.
    pub fn symbol(&mut self, symbol: Symbol) -> Expr {
        self.intern(Node::Symbol(symbol))
    }

    fn is(&self, e: Expr, value: f64) -> bool {
        self.as_constant(e) == Some(value)
    }

    /// `-a`
    pub fn neg(&mut self, a: Expr) -> Expr {
        match self.node(a) {
            Node::Constant(bits) => self.constant(0.0 - f64::from_bits(bits)),
            Node::Neg(b) => b,
            Node::Sub(b, c) => self.sub(c, b),
            _ => self.intern(Node::Neg(a)),
        }
    }

    /// `a + b`
    pub fn add(&mut self, a: Expr, b: Expr) -> Expr {
        match (self.node(a), self.node(b)) {
            (Node::Constant(x), Node::Constant(y)) => self.constant(f64::from_bits(x) + f64::from_bits(y)),
            _ if self.is(a, 0.0) => b,
            _ if self.is(b, 0.0) => a,
            (_, Node::Neg(c)) => self.sub(a, c),
            (Node::Neg(c), _) => self.sub(b, c),
            (Node::Constant(x), _) if f64::from_bits(x) < 0.0 => {
                let less = self.constant(-f64::from_bits(x));
                self.sub(b, less)
            }
            (_, Node::Constant(x)) if f64::from_bits(x) < 0.0 => {
                let less = self.constant(-f64::from_bits(x));
                self.sub(a, less)
            }
            _ => self.intern(Node::Add(a.min(b), a.max(b))),
        }
    }

    /// `a - b`
    pub fn sub(&mut self, a: Expr, b: Expr) -> Expr {
        match (self.node(a), self.node(b)) {
            (Node::Constant(x), Node::Constant(y)) => self.constant(f64::from_bits(x) - f64::from_bits(y)),
            _ if a == b => self.constant(0.0),
            _ if self.is(b, 0.0) => a,
            _ if self.is(a, 0.0) => self.neg(b),
            (_, Node::Neg(c)) => self.add(a, c),
            (Node::Neg(c), _) => {
                let sum = self.add(c, b);
                self.neg(sum)
            }
            _ => self.intern(Node::Sub(a, b)),
        }
    }

    /// `a b`
    pub fn mul(&mut self, a: Expr, b: Expr) -> Expr {
        match (self.node(a), self.node(b)) {
            (Node::Constant(x), Node::Constant(y)) => self.constant(f64::from_bits(x) * f64::from_bits(y)),
            _ if self.is(a, 0.0) || self.is(b, 0.0) => self.constant(0.0),
            _ if self.is(a, 1.0) => b,
            _ if self.is(b, 1.0) => a,
            _ if self.is(a, -1.0) => self.neg(b),
            _ if self.is(b, -1.0) => self.neg(a),
            (Node::Neg(x), Node::Neg(y)) => self.mul(x, y),
            (Node::Neg(x), _) => {
                let product = self.mul(x, b);
                self.neg(product)
            }
            (_, Node::Neg(y)) => {
                let product = self.mul(a, y);
                self.neg(product)
            }
            (Node::Constant(x), Node::Mul(y, z)) if self.as_constant(y).is_some() => {
                let factor = self.constant(f64::from_bits(x) * self.as_constant(y).unwrap_or(1.0));
                self.mul(factor, z)
            }
            (Node::Div(one, x), _) if self.is(one, 1.0) => self.div(b, x),
            (_, Node::Div(one, y)) if self.is(one, 1.0) => self.div(a, y),
            _ if a == b => self.powi(a, 2),
            _ => self.intern(Node::Mul(a.min(b), a.max(b))),
        }
    }

    /// `a / b`
    pub fn div(&mut self, a: Expr, b: Expr) -> Expr {
        match (self.node(a), self.node(b)) {
            (Node::Constant(x), Node::Constant(y)) if f64::from_bits(y) != 0.0 => {
                self.constant(f64::from_bits(x) / f64::from_bits(y))
            }
            _ if self.is(a, 0.0) => a,
            _ if self.is(b, 1.0) => a,
            _ if a == b => self.constant(1.0),
            (Node::Neg(x), Node::Neg(y)) => self.div(x, y),
            (Node::Neg(x), _) => {
                let quotient = self.div(x, b);
                self.neg(quotient)
            }
            (_, Node::Neg(y)) => {
                let quotient = self.div(a, y);
                self.neg(quotient)
            }
            (Node::Mul(x, y), _) if y == b => x,
            (Node::Mul(x, y), _) if x == b => y,
            (_, Node::Div(x, y)) => {
                let product = self.mul(a, y);
                self.div(product, x)
            }
            _ => self.intern(Node::Div(a, b)),
        }
    }

    /// `a^n`
    pub fn powi(&mut self, a: Expr, n: i32) -> Expr {
        match (self.node(a), n) {
            (_, 0) => self.constant(1.0),
            (_, 1) => a,
            (Node::Constant(x), _) => self.constant(f64::from_bits(x).powi(n)),
            (Node::Powi(b, m), _) => self.powi(b, m * n),
            (Node::Neg(b), _) if n % 2 == 0 => self.powi(b, n),
            _ => self.intern(Node::Powi(a, n)),
        }
    }

    /// `a^b` for a positive a
    pub fn pow(&mut self, a: Expr, b: Expr) -> Expr {
        match self.as_constant(b) {
            Some(n) if n.fract() == 0.0 && n.abs() <= 64.0 => self.powi(a, n as i32),
            _ => self.intern(Node::Pow(a, b)),
        }
    }

    /// The smaller of two.
    pub fn min(&mut self, a: Expr, b: Expr) -> Expr {
        match (self.as_constant(a), self.as_constant(b)) {
            (Some(x), Some(y)) => self.constant(x.min(y)),
            _ if a == b => a,
            _ => self.intern(Node::Min(a, b)),
        }
    }

    /// The larger of two.
    pub fn max(&mut self, a: Expr, b: Expr) -> Expr {
        match (self.as_constant(a), self.as_constant(b)) {
            (Some(x), Some(y)) => self.constant(x.max(y)),
            _ if a == b => a,
            _ => self.intern(Node::Max(a, b)),
        }
    }

    /// `f(a)`
    pub fn call(&mut self, f: Function, a: Expr) -> Expr {
        match self.as_constant(a) {
            Some(x) => self.constant(f.value(x)),
            None => self.intern(Node::Call(f, a)),
        }
    }

    /// The curve of a name.
    pub fn curve(&self, id: CurveId) -> &Curve<Expr> {
        &self.curves[id.0 as usize]
    }

    /// The derivative of a curve at `x`; order 0 is its value.
    pub fn table(&mut self, order: u8, x: Expr, curve: Curve<Expr>) -> Expr {
        if order > 3 || curve.entries().all(|&entry| self.is(entry, 0.0)) {
            return self.constant(0.0);
        }
        let numbers = curve.entries().all(|&entry| self.as_constant(entry).is_some());
        if let (Some(x), true) = (self.as_constant(x), numbers) {
            let value = curve.at(order, x, |&entry| self.as_constant(entry).unwrap_or_default());
            return self.constant(value);
        }
        let id = *self.curve_names.entry(curve).or_insert_with_key(|curve| {
            self.curves.push(curve.clone());
            CurveId(self.curves.len() as u32 - 1)
        });
        self.intern(Node::Table(order, x, id))
    }

    /// `positive` if `test` is above zero, else `otherwise`.
    pub fn select(&mut self, test: Expr, positive: Expr, otherwise: Expr) -> Expr {
        match self.as_constant(test) {
            Some(x) if x > 0.0 => positive,
            Some(_) => otherwise,
            None if positive == otherwise => positive,
            None => self.intern(Node::Select(test, positive, otherwise)),
        }
    }
}
