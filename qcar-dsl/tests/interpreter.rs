//! Programs interpreted in another order than theirs give the same bits as in theirs.

use proptest::prelude::*;
use qcar_dsl::compile::derive;
use qcar_dsl::evaluate::Evaluator;
use qcar_dsl::expr::{Function, Symbol};
use qcar_dsl::model::{CoordinateKind, Term};
use qcar_dsl::program::{Op, Program, Value};
use qcar_dsl::schedule::Compiled;
use qcar_model::{Model as _, Points};

use super::common::programs::{KINDS, PREPARED, prepared, program, steps};
use super::common::{Builder, cases};

/// More than two blocks of the interpreter, and not a whole number of any.
const POINTS: usize = 37;

/// A mass on a tyre: two states, and the road and gravity as inputs.
fn car() -> Compiled {
    let mut b = Builder::new("car");
    let [m, k, c] = ["m", "k", "c"].map(|name| b.parameter(name));
    let pad = b.coordinate("z", "pad", CoordinateKind::Road);
    b.gravity("z");
    let body = b.mass("z", "body", m);
    let tire = b.between(body, pad);
    b.link("z", "tire", &tire, vec![Term::Spring(k), Term::Damper(c)]);
    derive(b.build())
}

/// The program in its own order.
fn plainly(program: &Program, leaf: impl Fn(Op) -> f64) -> Vec<f64> {
    let mut values: Vec<f64> = Vec::new();
    for &op in &program.ops {
        let of = |value: Value| values[value.0 as usize];
        values.push(match op {
            Op::Constant(number) => number,
            Op::Input(_) | Op::Prepared(_) => leaf(op),
            Op::Neg(a) => -of(a),
            Op::Add(a, b) => of(a) + of(b),
            Op::Sub(a, b) => of(a) - of(b),
            Op::Mul(a, b) => of(a) * of(b),
            Op::Div(a, b) => of(a) / of(b),
            Op::Pow(a, b) => of(a).powf(of(b)),
            Op::Min(a, b) => of(a).min(of(b)),
            Op::Max(a, b) => of(a).max(of(b)),
            Op::Call(function, a) => called(function, of(a)),
            Op::Select(test, a, _) if of(test) > 0.0 => of(a),
            Op::Select(_, _, b) => of(b),
            Op::Table(order, x, place) => program.curves[place as usize].at(order, of(x), |&entry| of(entry)),
        });
    }
    program.outputs.iter().map(|value| values[value.0 as usize]).collect()
}

fn called(function: Function, x: f64) -> f64 {
    match function {
        Function::Abs => x.abs(),
        Function::Sign if x == 0.0 || x.is_nan() => x,
        Function::Sign => x.signum(),
        Function::Sqrt => x.sqrt(),
        Function::Exp => x.exp(),
        Function::Ln => x.ln(),
        Function::Sin => x.sin(),
        Function::Cos => x.cos(),
        Function::Tan => x.tan(),
        Function::Atan => x.atan(),
        Function::Tanh => x.tanh(),
    }
}

/// Bit for bit, but that no two ways of computing need agree on which NaN is none.
fn same(got: f64, want: f64) -> bool {
    got.to_bits() == want.to_bits() || got.is_nan() && want.is_nan()
}

proptest! {
    #![proptest_config(cases(64))]

    #[test]
    fn order_changes_no_bit(
        prepared in prepared(8),
        numbers in prop::collection::vec(-3.0..3.0f64, 0..4),
        steps in steps(KINDS, 900),
        given in prop::collection::vec(-2.0..2.0f64, PREPARED + 5 * POINTS),
    ) {
        let mut compiled = car();
        let states: Vec<Symbol> = compiled.vectors.states.iter().map(|state| state.symbol).collect();
        let inputs: Vec<Symbol> = compiled.vectors.inputs.iter().map(|input| input.symbol).collect();
        let symbols = [&states[..], &inputs].concat();
        let program = program(&symbols, &prepared, &numbers, &steps, 1);
        compiled.programs.derivative = program.clone();
        let evaluator = Evaluator::new(&compiled);

        let (constants, rows) = given.split_at(PREPARED);
        let (x, u) = rows.split_at(states.len() * POINTS);
        let mut together = vec![0.0; program.outputs.len() * POINTS];
        evaluator.derivative_at(constants, &Points { count: POINTS, x, u }, &mut together);
        for point in 0..POINTS {
            let at = |rows: &[f64]| -> Vec<f64> { rows.chunks_exact(POINTS).map(|row| row[point]).collect() };
            let want = plainly(&program, |op| match op {
                Op::Prepared(place) => constants[place as usize],
                _ => rows[POINTS * symbols.iter().position(|&symbol| op == Op::Input(symbol)).unwrap() + point],
            });
            let mut alone = vec![0.0; want.len()];
            evaluator.derivative(constants, &at(x), &at(u), &mut alone);
            for (output, &want) in want.iter().enumerate() {
                let got = [alone[output], together[output * POINTS + point]];
                prop_assert!(got.iter().all(|&got| same(got, want)), "{got:?}, want {want} of {:?}", program.outputs[output]);
            }
        }
    }
}
