//! Kinks and jumps of the laws of a program. They are where the argument of `abs` or `sign`, the difference of the
//! arguments of `min` or `max`, or the test of a choice changes sign.
//!
//! A curve through points jumps only in its second derivative, which does not disturb an integrator.

use std::collections::BTreeSet;

use crate::expr::Function;
use crate::program::{Op, Program, Value};

/// A program that computes the values whose change of sign is a kink: each once, in the order of the operations.
pub fn kinks(program: &Program) -> Program {
    let mut found = Program {
        ops: program.ops.clone(),
        outputs: Vec::new(),
        curves: program.curves.clone(),
    };
    let mut seen = BTreeSet::new();
    for op in &program.ops {
        let value = match *op {
            Op::Call(Function::Abs | Function::Sign, a) | Op::Select(a, ..) => a,
            Op::Min(a, b) | Op::Max(a, b) => difference(&mut found, a, b),
            _ => continue,
        };
        if seen.insert(value) {
            found.outputs.push(value);
        }
    }
    found.pruned()
}

fn difference(program: &mut Program, a: Value, b: Value) -> Value {
    let difference = Op::Sub(a, b);
    let known = program.ops.iter().position(|op| *op == difference);
    let place = known.unwrap_or_else(|| {
        program.ops.push(difference);
        program.ops.len() - 1
    });
    Value(place as u32)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::expr::Symbol;

    /// |a| with a = k x, min(a, x), a choice by x, and tanh(x), which has no kink.
    #[test]
    fn a_kink_is_where_a_law_bends() {
        let [k, x, a, size, least, chosen, smooth] = [0, 1, 2, 3, 4, 5, 6].map(Value);
        let program = Program {
            ops: vec![
                Op::Prepared(0),
                Op::Input(Symbol::Frequency),
                Op::Mul(k, x),
                Op::Call(Function::Abs, a),
                Op::Min(a, x),
                Op::Select(x, size, least),
                Op::Call(Function::Tanh, x),
            ],
            outputs: vec![chosen, smooth],
            ..Program::default()
        };
        let kinks = kinks(&program);
        let difference = Value(3);
        assert_eq!(
            kinks.ops,
            [program.ops[0], program.ops[1], program.ops[2], Op::Sub(a, x)]
        );
        assert_eq!(kinks.outputs, [a, difference, x]);
    }
}
