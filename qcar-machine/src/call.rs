//! Operations for which machine code calls Rust: functions, powers and tables.

use qcar_dsl::expr::{Curve, Function};
use qcar_dsl::program::{Op, Program};

/// An operation that machine code calls Rust for.
#[derive(Debug)]
pub enum Call {
    /// Of one argument.
    Function(Function),
    /// A power.
    Power,
    /// Derivative of a curve of this order, by the positions of its entries among the arguments; the first is the
    /// abscissa.
    Table(u8, Curve<usize>),
}

impl Call {
    /// The operation as a call; `None` if it is not one.
    pub fn of(program: &Program, op: Op) -> Option<Call> {
        match op {
            // Operations of one or two instructions.
            Op::Call(Function::Abs | Function::Sign | Function::Sqrt, _) => None,
            Op::Call(function, _) => Some(Call::Function(function)),
            Op::Pow(..) => Some(Call::Power),
            Op::Table(order, _, curve) => {
                let mut places = 1..;
                let curve = program.curves[curve as usize].map(|_| places.next().unwrap_or_default());
                Some(Call::Table(order, curve))
            }
            _ => None,
        }
    }

    /// Number of arguments.
    pub fn arguments(&self) -> usize {
        match self {
            Call::Function(_) => 1,
            Call::Power => 2,
            Call::Table(_, curve) => 1 + curve.entries().count(),
        }
    }

    /// Value, with the bits of the interpreter.
    pub fn value(&self, argument: impl Fn(usize) -> f64) -> f64 {
        match self {
            Call::Function(function) => function.value(argument(0)),
            Call::Power => argument(0).powf(argument(1)),
            Call::Table(order, curve) => curve.at(*order, argument(0), |&entry| argument(entry)),
        }
    }
}
