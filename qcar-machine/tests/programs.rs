//! Random programs with every operation of the language, and those that have no translation.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;

use proptest::prelude::*;
use qcar_dsl::expr::{Function, Symbol};
use qcar_dsl::program::{Op, Program, Value};
use qcar_dsl::schedule::Compiled;
use qcar_machine::Machine;
use qcar_model::{LANES, Lanes, Model, Points};

use super::comparison::Comparison;
use super::models::compiled;
use super::random::{KINDS, PREPARED, prepared, program, steps};

const POINTS: usize = 13;

/// A mass on a tyre, with another program for its equations of motion.
fn with_derivative(program: impl FnOnce(&[Symbol]) -> Program) -> Compiled {
    let mut compiled = compiled(Path::new("../models/axles/quarter_car.axle"));
    let (states, inputs) = (&compiled.vectors.states, &compiled.vectors.inputs);
    let symbols: Vec<Symbol> = states.iter().chain(inputs).map(|component| component.symbol).collect();
    compiled.programs.derivative = program(&symbols);
    compiled
}

/// Compares the derivative at one point, at several, and for sets.
fn compare(compiled: &Compiled, given: &[f64]) {
    let both = Comparison::new(compiled);
    let results = compiled.programs.derivative.outputs.len();
    let (states, inputs) = (compiled.vectors.states.len(), compiled.vectors.inputs.len());
    let (constants, rest) = given.split_at(PREPARED);
    let (x, u) = (&rest[..states * POINTS], &rest[states * POINTS..][..inputs * POINTS]);
    both.same(results, |model, to| model.derivative(constants, x, u, to));
    for count in [1, 4, POINTS] {
        let points = &Points {
            count,
            x: &x[..states * count],
            u: &u[..inputs * count],
        };
        both.same(results * count, |model, to| model.derivative_at(constants, points, to));
    }
    let row = |value: &f64| -> Lanes { std::array::from_fn(|set| if set < 3 { *value } else { value * set as f64 }) };
    let [constants, x, u] = [constants, &x[..states], &u[..inputs]].map(|of| of.iter().map(row).collect::<Vec<_>>());
    both.same(LANES * results, |model, to| {
        model.derivative_sets(&constants, &x, &u, to.as_chunks_mut().0);
    });
}

fn given() -> impl Strategy<Value = Vec<f64>> {
    let special = prop::sample::select(vec![
        0.0,
        -0.0,
        1.0,
        f64::INFINITY,
        f64::NEG_INFINITY,
        f64::NAN,
        1e-310,
        1e300,
    ]);
    prop::collection::vec(prop_oneof![6 => -2.0..2.0f64, 1 => special], PREPARED + 12 * POINTS)
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(96) })]

    #[test]
    fn every_operation_has_the_bits_of_the_interpreter(
        prepared in prepared(20),
        numbers in prop::collection::vec(-3.0..3.0f64, 0..4),
        steps in steps(KINDS, 400),
        given in given(),
    ) {
        let compiled = with_derivative(|symbols| program(symbols, &prepared, &numbers, &steps, 3));
        compare(&compiled, &given);
    }

    /// Every call evicts all registers; without calls they stay full.
    #[test]
    fn arithmetic_without_calls_has_the_bits_of_the_interpreter(
        prepared in prepared(20),
        steps in steps(5, 900),
        given in given(),
    ) {
        let compiled = with_derivative(|symbols| program(symbols, &prepared, &[2.5], &steps, 3));
        compare(&compiled, &given);
    }
}

/// A program with this many products that are all used in a sum at its end, after a call if `called`.
fn long_lived_values(symbols: &[Symbol], count: u32, called: bool) -> Program {
    let mut ops: Vec<Op> = symbols.iter().copied().map(Op::Input).collect();
    let first = ops.len() as u32;
    let mut last = Value(0);
    for place in 0..count {
        let prepared = Value(ops.len() as u32);
        ops.push(Op::Prepared(place % PREPARED as u32));
        ops.push(Op::Mul(last, prepared));
        last = Value(prepared.0 + 1);
    }
    if called {
        ops.push(Op::Call(Function::Tanh, last));
        last = Value(ops.len() as u32 - 1);
    }
    for place in 0..count {
        ops.push(Op::Add(last, Value(first + 2 * place + 1)));
        last = Value(ops.len() as u32 - 1);
    }
    Program {
        ops,
        outputs: vec![last],
        curves: Vec::new(),
    }
}

/// Less than a page of stack, several pages, and more than a frame may have.
#[test]
fn many_values_are_spilled_to_the_stack() {
    let given: Vec<f64> = (0..PREPARED + 12 * POINTS)
        .map(|place| 1.0 + 1e-3 * place as f64)
        .collect();
    for count in [10, 120, 1000, 7000, 20_000] {
        for called in [false, true] {
            compare(
                &with_derivative(|symbols| long_lived_values(symbols, count, called)),
                &given,
            );
        }
    }
}

/// Machine code does not check lengths, so its caller must.
#[test]
fn slices_that_are_too_short_panic() {
    let compiled = compiled(Path::new("../models/axles/axle_d.axle"));
    let machine = Machine::new(&compiled);
    let about = machine.about();
    let [constants, x, u, dx] = [
        about.constants,
        about.states.len(),
        about.inputs.len(),
        about.states.len(),
    ];
    let runs = |constants: usize, x: usize, u: usize, dx: usize| {
        let [constants, x, u, mut dx] = [constants, x, u, dx].map(|length| vec![1.0; length]);
        catch_unwind(AssertUnwindSafe(|| machine.derivative(&constants, &x, &u, &mut dx))).is_ok()
    };
    assert!(runs(constants, x, u, dx));
    assert!(!runs(1, x, u, dx) && !runs(constants, x - 1, u, dx));
    assert!(!runs(constants, x, 0, dx) && !runs(constants, x, u, dx - 1));
    let sets = |x: usize, dx: usize| {
        let [constants, x, u, mut dx] = [constants, x, u, dx].map(|rows| vec![[1.0; LANES]; rows]);
        catch_unwind(AssertUnwindSafe(|| {
            machine.derivative_sets(&constants, &x, &u, &mut dx)
        }))
        .is_ok()
    };
    assert!(sets(x, dx) && !sets(x - 1, dx) && !sets(x, dx - 1));
    let points = |x: usize, dx: usize| {
        let (constants, x, u) = (vec![1.0; constants], vec![1.0; 9 * x], vec![1.0; 9 * u]);
        let (points, mut dx) = (Points { count: 9, x: &x, u: &u }, vec![1.0; 9 * dx]);
        catch_unwind(AssertUnwindSafe(|| machine.derivative_at(&constants, &points, &mut dx))).is_ok()
    };
    assert!(points(x, dx) && !points(x - 1, dx) && !points(x, dx - 1));
}
