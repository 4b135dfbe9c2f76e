//! Where the laws of a program bend or jump: at a sign of |a|, of `sign(a)`, of min, of max, and of the test of a choice.
//!
//! A curve through points bends in its curvature alone, which no integrator has to be told.

use std::collections::BTreeSet;

use crate::expr::Function;
use crate::program::{Op, Program, Value};

/// The values whose change of sign is a kink, as a program of their own: each once, in the order of the operations.
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
