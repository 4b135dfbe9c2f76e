//! The equations of motion and their matrices are those that M, C and K assembled by numbers give.

use std::collections::HashMap;

use nalgebra::{Complex, ComplexField};
use proptest::prelude::*;
use qcar_dsl::check::Checked;
use qcar_dsl::compile::derive;
use qcar_dsl::derive::vectors::Vectors;
use qcar_dsl::evaluate::Evaluator;
use qcar_dsl::expr::Symbol;
use qcar_model::{Entry, Matrix, Model as _};

use super::common::random::plan;
use super::common::reference::Reference;
use super::common::{self, assert_close, axle_d};

/// f and h by the reference.
fn equations<T: ComplexField<RealField = f64> + Copy>(
    model: &Checked,
    vectors: &Vectors,
    p: &[T],
    x: &[T],
    u: &[T],
) -> (Vec<T>, Vec<T>) {
    let given: HashMap<Symbol, T> = vectors
        .states
        .iter()
        .map(|state| state.symbol)
        .chain(vectors.inputs.iter().map(|input| input.symbol))
        .zip(x.iter().chain(u).copied())
        .collect();
    let reference = Reference::new(model, p);
    let instant = reference.at(model, &|symbol| given.get(&symbol).copied().unwrap_or(T::zero()));
    let rates = vectors
        .states
        .iter()
        .map(|state| instant.rate(state.symbol, &reference.inner))
        .collect();
    (
        rates,
        model
            .outputs
            .iter()
            .map(|output| instant.signal(&output.signal, &reference.points))
            .collect(),
    )
}

/// The entries of all four matrices by the reference: a linear model's columns are its equations at unit vectors.
fn matrices<T: ComplexField<RealField = f64> + Copy>(model: &Checked, vectors: &Vectors, p: &[T]) -> HashMap<Entry, T> {
    let (n, m) = (vectors.states.len(), vectors.inputs.len());
    let mut entries = HashMap::new();
    for column in 0..n + m {
        let mut unit = vec![T::zero(); n + m];
        unit[column] = T::one();
        let (rates, outputs) = equations(model, vectors, p, &unit[..n], &unit[n..]);
        let (of_rates, of_outputs, column) = if column < n {
            (Matrix::A, Matrix::C, column)
        } else {
            (Matrix::B, Matrix::D, column - n)
        };
        for (matrix, rows) in [(of_rates, rates), (of_outputs, outputs)] {
            for (row, value) in rows.into_iter().enumerate() {
                entries.insert(
                    Entry {
                        matrix,
                        row: row as u16,
                        column: column as u16,
                    },
                    value,
                );
            }
        }
    }
    entries
}

const STEP: f64 = 1e-30;

/// Parameters of random models are about 1, so that rounding errors are well below this times the tolerance.
const FLOOR: f64 = 1e-4;

/// Parameters with a complex step in one of them.
fn stepped(p: &[f64], which: usize) -> Vec<Complex<f64>> {
    p.iter()
        .enumerate()
        .map(|(i, &p)| Complex::new(p, if i == which { STEP } else { 0.0 }))
        .collect()
}

fn judge(model: Checked, p: &[f64]) {
    let compiled = derive(model.clone());
    let evaluator = Evaluator::new(&compiled);
    let about = evaluator.about();
    assert!(about.linear);
    let x: Vec<f64> = (0..about.states.len()).map(|i| (1.0 + i as f64).sin()).collect();
    let u: Vec<f64> = (0..about.inputs.len()).map(|i| (2.0 + 3.0 * i as f64).cos()).collect();
    let mut constants = vec![0.0; about.constants];
    let (mut dx, mut y) = (vec![0.0; x.len()], vec![0.0; about.outputs.len()]);
    evaluator.prepare(p, &mut constants);
    evaluator.derivative(&constants, &x, &u, &mut dx);
    evaluator.outputs(&constants, &x, &u, &mut y);
    let (rates, outputs) = equations(&model, &compiled.vectors, p, &x, &u);
    assert_close("f", &dx, &rates, 1e-9, FLOOR);
    assert_close("h", &y, &outputs, 1e-9, FLOOR);

    let mut nonzeros = vec![0.0; about.matrices.len()];
    evaluator.matrices(p, &x, &u, &mut nonzeros);
    let mut want = matrices(&model, &compiled.vectors, p);
    let listed: Vec<f64> = about.matrices.iter().map(|entry| want.remove(entry).unwrap()).collect();
    assert_close("A, B, C, D", &nonzeros, &listed, 1e-9, FLOOR);
    assert_close(
        "what is not listed",
        &vec![0.0; want.len()],
        &want.into_values().collect::<Vec<_>>(),
        1e-9,
        FLOOR,
    );

    judge_sensitivities(&model, &compiled.vectors, &evaluator, p, &x, &u);
}

fn judge_sensitivities(model: &Checked, vectors: &Vectors, evaluator: &Evaluator, p: &[f64], x: &[f64], u: &[f64]) {
    let about = evaluator.about();
    let mut of_matrices = vec![0.0; about.sensitivities.len()];
    let mut of_equations = vec![0.0; about.parameter_jacobian.len()];
    evaluator.sensitivities(p, x, u, &mut of_matrices);
    evaluator.parameter_jacobian(p, x, u, &mut of_equations);
    let complex = |v: &[f64]| v.iter().map(|&v| Complex::new(v, 0.0)).collect::<Vec<_>>();
    for which in 0..p.len() {
        let p = stepped(p, which);
        let changes = matrices(model, vectors, &p);
        let listed = about
            .sensitivities
            .iter()
            .zip(&of_matrices)
            .filter(|((_, p), _)| usize::from(*p) == which);
        let got: HashMap<Entry, f64> = listed.map(|((entry, _), &value)| (*entry, value)).collect();
        let entries: Vec<Entry> = changes.keys().copied().collect();
        let got: Vec<f64> = entries
            .iter()
            .map(|entry| got.get(entry).copied().unwrap_or(0.0))
            .collect();
        let want: Vec<f64> = entries.iter().map(|entry| changes[entry].im / STEP).collect();
        assert_close("dA, dB, dC, dD", &got, &want, 1e-9, FLOOR);

        let (rates, outputs) = equations(model, vectors, &p, &complex(x), &complex(u));
        let mut got = vec![0.0; rates.len() + outputs.len()];
        for (&(is_output, row, p), &value) in about.parameter_jacobian.iter().zip(&of_equations) {
            if usize::from(p) == which {
                got[usize::from(row) + if is_output { rates.len() } else { 0 }] = value;
            }
        }
        let want: Vec<f64> = rates.iter().chain(&outputs).map(|value| value.im / STEP).collect();
        assert_close("df/dp, dh/dp", &got, &want, 1e-9, FLOOR);
    }
}

#[test]
fn a_whole_axle_is_its_matrices() {
    let p = [
        586.1, 33.1, 5.1, 24.1, 53.4, 55300.0, 4140.0, 0.625, 0.672, 535e3, 843.0, 644e3, 842.0, 390e3, 561.0, 250e3,
        200.0,
    ];
    judge(axle_d(), &p);
}

proptest! {
    #![proptest_config(common::cases(64))]

    #[test]
    fn random_models_are_their_matrices(plan in plan()) {
        let (model, p) = plan.build();
        judge(model, &p);
    }
}
