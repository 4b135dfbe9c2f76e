//! Random programs with every operation of the language.

use proptest::prelude::*;
use proptest::sample::Index;
use qcar_dsl::expr::{Curve, Function, Graph, Symbol};
use qcar_dsl::program::{Op, Program, Value};

/// The constants that a model prepares, of which a program reads some.
pub const PREPARED: usize = 50;

/// All functions of the language.
pub const FUNCTIONS: [Function; 10] = [
    Function::Abs,
    Function::Sign,
    Function::Sqrt,
    Function::Exp,
    Function::Ln,
    Function::Sin,
    Function::Cos,
    Function::Tan,
    Function::Atan,
    Function::Tanh,
];

/// The kind of an operation, and how far back in the program its arguments stand.
pub type Step = (usize, [Index; 3]);

/// Kinds of [`Step`]: arithmetic and comparisons, functions, and a table with its derivatives.
pub const KINDS: usize = 9 + FUNCTIONS.len() + 4;

/// Fewer than this many steps of the first so many kinds.
pub fn steps(kinds: usize, most: usize) -> impl Strategy<Value = Vec<Step>> {
    prop::collection::vec((0..kinds, any::<[Index; 3]>()), 1..most)
}

/// The numbers of some of the prepared constants, fewer than `most`.
pub fn prepared(most: usize) -> impl Strategy<Value = Vec<u32>> {
    prop::collection::vec(0..PREPARED as u32, 1..most)
}

/// Leaves and numbers, then operations on any earlier values; one in `every` is a result, the last ones first.
pub fn program(symbols: &[Symbol], prepared: &[u32], numbers: &[f64], steps: &[Step], every: usize) -> Program {
    let mut ops: Vec<Op> = symbols.iter().copied().map(Op::Input).collect();
    ops.extend(prepared.iter().copied().map(Op::Prepared));
    ops.extend(numbers.iter().copied().map(Op::Constant));
    let mut curves = Vec::new();
    for &(kind, places) in steps {
        let [a, b, c] = places.map(|place| Value(place.index(ops.len()) as u32));
        ops.push(match kind {
            0 => Op::Neg(a),
            1 => Op::Add(a, b),
            2 => Op::Sub(a, b),
            3 => Op::Mul(a, b),
            4 => Op::Div(a, b),
            5 => Op::Pow(a, b),
            6 => Op::Min(a, b),
            7 => Op::Max(a, b),
            8 => Op::Select(a, b, c),
            kind if kind < 9 + FUNCTIONS.len() => Op::Call(FUNCTIONS[kind - 9], a),
            kind => {
                curves.push(curve([b, c, a, c, a, b]));
                Op::Table((kind - 9 - FUNCTIONS.len()) as u8, a, curves.len() as u32 - 1)
            }
        });
    }
    let outputs = (0..ops.len() as u32).rev().step_by(every).map(Value).collect();
    Program { ops, outputs, curves }
}

/// A curve through three points, by its ordinates and slopes.
fn curve(entries: [Value; 6]) -> Curve<Value> {
    let mut g = Graph::default();
    let zero = g.constant(0.0);
    let points = Curve::monotone(&mut g, &[-1.0, 0.2, 1.5], vec![zero; 3]);
    let mut entries = entries.into_iter();
    points.map(|_| entries.next().unwrap())
}
