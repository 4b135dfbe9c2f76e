//! Programs interpreted in another order than theirs give the same bits as in theirs.

use proptest::prelude::*;
use qcar_dsl::compile::derive;
use qcar_dsl::evaluate::Evaluator;
use qcar_dsl::expr::{Curve, Function, Graph, Symbol};
use qcar_dsl::model::{CoordinateKind, Term};
use qcar_dsl::program::{Op, Program, Value};
use qcar_dsl::schedule::Compiled;
use qcar_model::{Model as _, Points};

use super::common::{Builder, cases};

/// Constants that are prepared, of which a program reads some.
const PREPARED: usize = 50;
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

/// An operation by its kind, and by how far back in the program its arguments stand.
type Step = (u8, [prop::sample::Index; 3]);

/// Leaves and numbers, then operations of all kinds between each other, which share what they read; all are results.
fn program(symbols: &[Symbol], prepared: &[u32], numbers: &[f64], steps: &[Step]) -> Program {
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
            8 => Op::Call(Function::Abs, a),
            9 => Op::Call(Function::Tanh, a),
            10 => Op::Select(a, b, c),
            order => {
                curves.push(curve([b, c, a, c, a, b]));
                Op::Table(order - 11, a, curves.len() as u32 - 1)
            }
        });
    }
    let outputs = (0..ops.len() as u32).rev().map(Value).collect();
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
            Op::Call(Function::Abs, a) => of(a).abs(),
            Op::Call(Function::Tanh, a) => of(a).tanh(),
            Op::Call(..) => panic!("{op:?} is not among the steps"),
            Op::Select(test, a, _) if of(test) > 0.0 => of(a),
            Op::Select(_, _, b) => of(b),
            Op::Table(order, x, place) => program.curves[place as usize].at(order, of(x), |&entry| of(entry)),
        });
    }
    program.outputs.iter().map(|value| values[value.0 as usize]).collect()
}

/// Bit for bit, but that no two ways of computing need agree on which NaN is none.
fn same(got: f64, want: f64) -> bool {
    got.to_bits() == want.to_bits() || got.is_nan() && want.is_nan()
}

proptest! {
    #![proptest_config(cases(64))]

    #[test]
    fn order_changes_no_bit(
        prepared in prop::collection::vec(0..PREPARED as u32, 1..8),
        numbers in prop::collection::vec(-3.0..3.0f64, 0..4),
        steps in prop::collection::vec((0..15u8, any::<[prop::sample::Index; 3]>()), 1..900),
        given in prop::collection::vec(-2.0..2.0f64, PREPARED + 5 * POINTS),
    ) {
        let mut compiled = car();
        let states: Vec<Symbol> = compiled.vectors.states.iter().map(|state| state.symbol).collect();
        let inputs: Vec<Symbol> = compiled.vectors.inputs.iter().map(|input| input.symbol).collect();
        let symbols = [&states[..], &inputs].concat();
        let program = program(&symbols, &prepared, &numbers, &steps);
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
