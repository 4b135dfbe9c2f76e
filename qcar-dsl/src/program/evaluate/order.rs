//! The order in which operations are interpreted: operations of one kind form a run, which one loop computes.
//!
//! If kinds alternate, the processor mispredicts the branch to the next operation, which costs more than the operation
//! itself.

use crate::program::{Op, Program, Value};

/// Number of operations that are reordered together: enough for long runs, and few enough that a result is still in the
/// cache when another operation uses it.
const WINDOW: usize = 256;

/// Operations of one kind, to be computed one after another.
#[derive(Debug, PartialEq)]
pub struct Run {
    /// The operation without its arguments.
    pub kind: Op,
    /// Positions of the operations in the program.
    pub places: Vec<usize>,
}

/// All operations of a program except its leaves, with arguments before the operations that use them.
///
/// The next run has the kind of the operation with the longest way to the end, counted in changes of kind. It contains
/// all operations of that kind whose arguments are computed.
pub fn runs(program: &Program) -> Vec<Run> {
    let distances = distances(program);
    let mut done: Vec<bool> = program.ops.iter().map(|op| op.is_leaf()).collect();
    let places: Vec<usize> = (0..program.ops.len()).filter(|&place| !done[place]).collect();
    let mut runs = Vec::new();
    for window in places.chunks(WINDOW) {
        let mut waiting = window.to_vec();
        // The first of the operations with the longest way: its arguments have a longer way or come earlier, so they
        // are computed.
        while let Some(next) = waiting.iter().copied().rev().max_by_key(|&place| distances[place]) {
            let kind = kind(&program.ops[next]);
            let (places, others) = waiting.into_iter().partition(|&place| {
                let op = program.ops[place];
                done[place] = self::kind(&op) == kind && program.arguments(op).all(|value| done[value.0 as usize]);
                done[place]
            });
            runs.push(Run { kind, places });
            waiting = others;
        }
    }
    runs
}

/// Number of changes of kind from each operation to the end of the program, along the longest way.
fn distances(program: &Program) -> Vec<usize> {
    let mut distances = vec![0; program.ops.len()];
    for (place, op) in program.ops.iter().enumerate().rev() {
        for value in program.arguments(*op) {
            let argument = value.0 as usize;
            let change = usize::from(kind(&program.ops[argument]) != kind(op));
            distances[argument] = distances[argument].max(distances[place] + change);
        }
    }
    distances
}

fn kind(op: &Op) -> Op {
    op.renumbered(|_| Value(0))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::expr::{Function, Symbol};

    /// Parallel laws, as in equations of motion: each is a product and a function of it, added to the sum so far.
    #[test]
    fn kinds_that_alternate_stand_in_a_row() {
        let mut ops = vec![Op::Input(Symbol::Frequency)];
        let mut push = |op| {
            ops.push(op);
            Value(ops.len() as u32 - 1)
        };
        let mut sum = Value(0);
        for place in 0..20 {
            let stiffness = push(Op::Prepared(place));
            let force = push(Op::Mul(stiffness, Value(0)));
            let friction = push(Op::Call(Function::Tanh, force));
            sum = push(Op::Add(sum, friction));
        }
        let program = Program {
            ops,
            outputs: vec![sum],
            ..Program::default()
        };
        let runs = runs(&program);
        let lengths: Vec<usize> = runs.iter().map(|run| run.places.len()).collect();
        assert_eq!(lengths, [20, 20, 20], "{runs:?}");
    }

    /// Different functions have different kinds, and so do a quotient and a product of the same arguments.
    #[test]
    fn kinds_differ_in_what_is_done() {
        let (a, b) = (Value(0), Value(1));
        let distinct = [
            Op::Call(Function::Sin, a),
            Op::Call(Function::Cos, a),
            Op::Mul(a, b),
            Op::Div(a, b),
        ];
        for (place, one) in distinct.iter().enumerate() {
            assert!(distinct[..place].iter().all(|other| kind(other) != kind(one)));
        }
        assert_eq!(kind(&Op::Mul(a, b)), kind(&Op::Mul(b, b)));
    }
}
