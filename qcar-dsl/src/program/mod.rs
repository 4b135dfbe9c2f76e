//! Straight-line programs, the scheduled equations of a model.
//!
//! A program computes its outputs from its inputs by a list of operations in order. Each operation gives one value. The
//! same program is printed as Rust and interpreted at run time, operation by operation, so that both give the same
//! bits. Whole powers are already products, and a divisor that is used twice is a reciprocal.

// From expressions to a sequence of operations.
pub mod schedule;
// The interpreter, which implements the trait of a model.
pub mod evaluate;

use crate::expr::{Curve, Function, Symbol};

/// A value of a program (an input, a constant or the result of an operation) by its position in [`Program::ops`].
#[derive(Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Debug)]
pub struct Value(pub u32);

/// The operation that gives a value. Its arguments come earlier in the program.
#[derive(Clone, Copy, PartialEq, Debug)]
#[expect(missing_docs, reason = "each mirrors the node of its name in `expr::Node`")]
pub enum Op {
    Constant(f64),
    /// A leaf, which the caller gives.
    Input(Symbol),
    /// A value that depends on the parameters alone and is computed once for a parameter set, by its position.
    Prepared(u32),
    Neg(Value),
    Add(Value, Value),
    Sub(Value, Value),
    Mul(Value, Value),
    Div(Value, Value),
    Pow(Value, Value),
    Min(Value, Value),
    Max(Value, Value),
    Call(Function, Value),
    Select(Value, Value, Value),
    /// The order, the abscissa and the position of the curve in [`Program::curves`].
    Table(u8, Value, u32),
}

impl Program {
    /// The program without values that its outputs do not need.
    pub fn pruned(&self) -> Program {
        let needed = self.needed(&self.outputs);
        let mut places = vec![Value(0); self.ops.len()];
        let mut ops = Vec::new();
        for (place, op) in self.ops.iter().enumerate().filter(|(place, _)| needed[*place]) {
            places[place] = Value(ops.len() as u32);
            ops.push(op.renumbered(|value| places[value.0 as usize]));
        }
        let new = |value: &Value| places[value.0 as usize];
        Program {
            ops,
            outputs: self.outputs.iter().map(new).collect(),
            curves: self.curves.iter().map(|curve| curve.map(new)).collect(),
        }
    }

    /// For each value, true if one of these needs it.
    pub fn needed(&self, by: &[Value]) -> Vec<bool> {
        let mut needed = vec![false; self.ops.len()];
        for value in by {
            needed[value.0 as usize] = true;
        }
        for place in (0..self.ops.len()).rev() {
            if needed[place] {
                for value in self.arguments(self.ops[place]) {
                    needed[value.0 as usize] = true;
                }
            }
        }
        needed
    }

    /// The arguments of an operation, in order; none for a leaf.
    pub fn arguments(&self, op: Op) -> impl Iterator<Item = Value> {
        let three = match op {
            Op::Constant(_) | Op::Input(_) | Op::Prepared(_) => [None; 3],
            Op::Neg(a) | Op::Call(_, a) | Op::Table(_, a, _) => [Some(a), None, None],
            Op::Add(a, b) | Op::Sub(a, b) | Op::Mul(a, b) | Op::Div(a, b) => [Some(a), Some(b), None],
            Op::Pow(a, b) | Op::Min(a, b) | Op::Max(a, b) => [Some(a), Some(b), None],
            Op::Select(test, a, b) => [Some(test), Some(a), Some(b)],
        };
        let curve = match op {
            Op::Table(.., curve) => Some(&self.curves[curve as usize]),
            _ => None,
        };
        let entries = curve.into_iter().flat_map(Curve::entries).copied();
        three.into_iter().flatten().chain(entries)
    }
}

impl Op {
    /// True if nothing is computed: for a number, or a value that the caller gives.
    pub fn is_leaf(self) -> bool {
        matches!(self, Op::Constant(_) | Op::Input(_) | Op::Prepared(_))
    }

    /// The same operation with renumbered arguments; a curve keeps its points.
    pub fn renumbered(self, new: impl Fn(Value) -> Value) -> Op {
        match self {
            Op::Constant(_) | Op::Input(_) | Op::Prepared(_) => self,
            Op::Neg(a) => Op::Neg(new(a)),
            Op::Add(a, b) => Op::Add(new(a), new(b)),
            Op::Sub(a, b) => Op::Sub(new(a), new(b)),
            Op::Mul(a, b) => Op::Mul(new(a), new(b)),
            Op::Div(a, b) => Op::Div(new(a), new(b)),
            Op::Pow(a, b) => Op::Pow(new(a), new(b)),
            Op::Min(a, b) => Op::Min(new(a), new(b)),
            Op::Max(a, b) => Op::Max(new(a), new(b)),
            Op::Call(function, a) => Op::Call(function, new(a)),
            Op::Select(test, a, b) => Op::Select(new(test), new(a), new(b)),
            Op::Table(order, x, curve) => Op::Table(order, new(x), curve),
        }
    }
}

/// A straight-line program.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Program {
    /// The operation of each value; arguments come before the operations that use them.
    pub ops: Vec<Op>,
    /// The results.
    pub outputs: Vec<Value>,
    /// The curves of its tables.
    pub curves: Vec<Curve<Value>>,
}

/// The programs of a model. [`qcar_model::About`] describes their outputs.
///
/// `matrices`, `sensitivities` and `parameter_jacobian` read parameters as `Op::Input(Symbol::Parameter)`, and so does
/// `prepare`; all others read values that depend on the parameters alone as `Op::Prepared`, the outputs of `prepare`.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Programs {
    /// The constants of a parameter set.
    pub prepare: Program,
    /// `dx = f(x, u)`
    pub derivative: Program,
    /// `y = h(x, u)`
    pub outputs: Program,
    /// Nonzeros of A, B, C and D; of a linear model it reads parameters only.
    pub matrices: Program,
    /// Nonzeros of the parameter Jacobians of A, B, C and D.
    pub sensitivities: Program,
    /// Nonzeros of ∂f/∂p and ∂h/∂p.
    pub parameter_jacobian: Program,
    /// The frequency response to each excitation; empty for a nonlinear model.
    pub responses: Vec<Response>,
    /// The programs of a rolling tyre; `None` if no tyre can roll.
    pub rolling: Option<Rolling>,
}

/// The response to one excitation at one `Symbol::Frequency`.
///
/// With n outputs and m Jacobian entries in its layout, `value` gives n real parts, then n imaginary parts;
/// `with_jacobian` gives these 2n, then the real parts of the m entries, then their imaginary parts.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Response {
    /// The response alone.
    pub value: Program,
    /// The response and its parameter Jacobian.
    pub with_jacobian: Program,
}

/// The programs of a model whose tyre rolls over a profile.
///
/// They read the equivalent stretch and its rate as `Symbol::Stretch` and `Symbol::Rate` of the tyre's link.
/// `derivative` and `outputs` also read the forces on the wheel as `Symbol::ContactForce`, in the order of
/// `Contact::axes`.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Rolling {
    /// One output: the resisting force of the tyre's law.
    pub contact_force: Program,
    /// `dx = f(x, u, contact)`
    pub derivative: Program,
    /// `y = h(x, u, contact)`
    pub outputs: Program,
}
