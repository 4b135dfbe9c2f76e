//! Inputs and states on which a derivative, an output or a kink depends, from the programs. A result may depend on a
//! variable through its sign even if the Jacobian is zero.

use qcar_dsl::c::motion_kinks;
use qcar_dsl::derive::vectors::Vectors;
use qcar_dsl::expr::Symbol;
use qcar_dsl::program::{Op, Program};

use super::variables::Variables;
use crate::export::Subject;

/// For each result, the value references of its inputs and states, in ascending order.
pub struct Dependencies {
    pub derivatives: Vec<Vec<usize>>,
    pub outputs: Vec<Vec<usize>>,
    pub kinks: Vec<Vec<usize>>,
}

impl Dependencies {
    /// The dependencies of a model. With a rolling tyre every result depends on all: the contact couples both
    /// directions.
    pub fn of(subject: Subject, variables: &Variables) -> Self {
        let (vectors, programs) = (&subject.compiled.vectors, &subject.compiled.programs);
        let all = |count: usize| vec![variables.moving().collect(); count];
        let (derivatives, outputs) = match variables.rolls {
            false => (
                of(vectors, variables, &programs.derivative),
                of(vectors, variables, &programs.outputs),
            ),
            true => (
                all(variables.first_output() - variables.first_derivative()),
                all(variables.first_kink() - variables.first_output()),
            ),
        };
        Dependencies {
            derivatives,
            outputs,
            kinks: of(vectors, variables, &motion_kinks(subject.compiled)),
        }
    }
}

fn of(vectors: &Vectors, variables: &Variables, program: &Program) -> Vec<Vec<usize>> {
    let of = |&output| {
        let needed = program.needed(&[output]);
        let ops = program.ops.iter().zip(needed).filter(|(_, needed)| *needed);
        let references = ops.filter_map(|(op, _)| match *op {
            Op::Input(symbol) => reference(vectors, variables, symbol),
            _ => None,
        });
        let mut references: Vec<usize> = references.collect();
        references.sort_unstable();
        references
    };
    program.outputs.iter().map(of).collect()
}

fn reference(vectors: &Vectors, variables: &Variables, symbol: Symbol) -> Option<usize> {
    let input = vectors.input(symbol).map(|place| variables.first_input() + place);
    input.or_else(|| Some(variables.first_state() + vectors.state(symbol)?))
}
