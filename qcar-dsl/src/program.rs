//! Straight-line programs: what is left of a model when its equations are scheduled.
//!
//! A program computes its outputs from its inputs by a list of operations, each a value of its own, in order.
//! The same program is printed as Rust and interpreted at run time, operation by operation, so that both
//! give the same bits.

use crate::expr::{Function, Symbol};

/// A value of a program: an input, a constant or the result of an operation, by its place.
#[derive(Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Debug)]
pub struct Value(pub u32);

/// How a value comes about. The arguments come earlier in the program.
#[derive(Clone, Copy, PartialEq, Debug)]
#[expect(missing_docs, reason = "each mirrors the node of its name in `expr::Node`")]
pub enum Op {
    Constant(f64),
    /// A leaf, given by the caller.
    Input(Symbol),
    /// What depends on the parameters alone and was computed once for a parameter set, by its place.
    Prepared(u32),
    Neg(Value),
    Add(Value, Value),
    Sub(Value, Value),
    Mul(Value, Value),
    Div(Value, Value),
    Powi(Value, i32),
    Pow(Value, Value),
    Min(Value, Value),
    Max(Value, Value),
    Call(Function, Value),
    Select(Value, Value, Value),
}

/// A straight-line program.
#[derive(Clone, Debug, Default)]
pub struct Program {
    /// What each value is, in an order in which it can be computed.
    pub ops: Vec<Op>,
    /// The results.
    pub outputs: Vec<Value>,
}
