//! The order in which operations are interpreted: those of one kind in a row, so that a run of them is one loop.
//!
//! A processor guesses badly what the next operation will be, and a wrong guess costs more than the operation itself.

use crate::program::{Op, Program, Value};

/// Operations that are put in order together: enough for long runs, and few enough that what one computes is still
/// close to the processor when another uses it.
const WINDOW: usize = 256;

/// Operations of one kind, to be computed one after the other.
#[derive(Debug, PartialEq)]
pub struct Run {
    /// The operation without its arguments.
    pub kind: Op,
    /// Its places in the program.
    pub places: Vec<usize>,
}

/// All operations of a program but its leaves, in an order in which they can be computed.
///
/// Next comes the kind of the operation from which it is still furthest to the end, counted in changes of kind, and
/// with it all of that kind that can be computed by then.
pub fn runs(program: &Program) -> Vec<Run> {
    let distances = distances(program);
    let mut done: Vec<bool> = program.ops.iter().map(|op| op.is_leaf()).collect();
    let places: Vec<usize> = (0..program.ops.len()).filter(|&place| !done[place]).collect();
    let mut runs = Vec::new();
    for window in places.chunks(WINDOW) {
        let mut waiting = window.to_vec();
        // Of the furthest the first, whose arguments are further or earlier and so are there.
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

/// How often the kind changes from each operation to the end, along the longest way.
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

    /// Laws side by side, as equations of motion have them: each a product and a function of it, added to those before.
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

    /// Functions differ in kind, and so do a quotient and a product of the same two.
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
