//! Which inputs and states a derivative, an output or a kink depends on, from the programs: what is zero in a Jacobian may
//! depend still, by a sign.

use qcar_dsl::about::About;
use qcar_dsl::c::motion_kinks;
use qcar_dsl::expr::Symbol;
use qcar_dsl::program::{Op, Program};

use super::variables::Variables;
use crate::export::Subject;

/// For each result the value references of what it depends on, in ascending order.
pub struct Dependencies {
    pub derivatives: Vec<Vec<usize>>,
    pub outputs: Vec<Vec<usize>>,
    pub kinks: Vec<Vec<usize>>,
}

impl Dependencies {
    /// Those of a model.
    pub fn of(subject: Subject, variables: &Variables) -> Self {
        let (about, programs) = (&subject.compiled.about, &subject.compiled.programs);
        Dependencies {
            derivatives: of(about, variables, &programs.derivative),
            outputs: of(about, variables, &programs.outputs),
            kinks: of(about, variables, &motion_kinks(subject.compiled)),
        }
    }
}

fn of(about: &About, variables: &Variables, program: &Program) -> Vec<Vec<usize>> {
    let of = |&output| {
        let needed = program.needed(&[output]);
        let ops = program.ops.iter().zip(needed).filter(|(_, needed)| *needed);
        let references = ops.filter_map(|(op, _)| match *op {
            Op::Input(symbol) => reference(about, variables, symbol),
            _ => None,
        });
        let mut references: Vec<usize> = references.collect();
        references.sort_unstable();
        references
    };
    program.outputs.iter().map(of).collect()
}

fn reference(about: &About, variables: &Variables, symbol: Symbol) -> Option<usize> {
    let input = about.inputs.iter().position(|input| input.symbol == symbol);
    let state = about.states.iter().position(|state| state.symbol == symbol);
    let input = input.map(|place| variables.first_input() + place);
    input.or_else(|| Some(variables.first_state() + state?))
}
