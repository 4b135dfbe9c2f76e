//! Generated code and the run-time evaluator give the same bits, on random parameters, states and inputs.

use std::path::Path;
use std::sync::LazyLock;

use proptest::prelude::*;
use qcar_dsl::disk::compile_file;
use qcar_dsl::evaluate::Evaluator;
use qcar_runtime::model::{Contact, Contacts, LANES, Lanes, Model, Points, ResponseMut};

/// Models other than axles: every operation of the language, nodes, inner states, levers and rotation.
mod zoo {
    qcar_derive::axle_file!("tests/zoo/coupled.axle");
    qcar_derive::axle_file!("tests/zoo/forces.axle");
    qcar_derive::axle_file!("tests/zoo/laws.axle");
    qcar_derive::axle_file!("tests/zoo/mechanisms.axle");
    qcar_derive::axle_file!("tests/zoo/names.axle");
    // A model with an effect.
    qcar_derive::axle_file!("tests/zoo/axle_b_with_coulomb_friction.axle");
    qcar_derive::axle_file!("tests/zoo/axle_c_with_suspended_mass.axle");
    qcar_derive::axle_file!("tests/zoo/axle_c_with_tire_dynamic_stiffness.axle");
}

/// Every compiled model with the file it comes from.
fn all() -> Vec<(String, &'static dyn Model)> {
    let shipped = models::all()
        .iter()
        .map(|shipped| (shipped.file.to_string(), shipped.model));
    let zoo: [(&str, &'static dyn Model); 8] = [
        ("tests/zoo/coupled.axle", &zoo::coupled::Coupled),
        ("tests/zoo/forces.axle", &zoo::forces::Forces),
        ("tests/zoo/laws.axle", &zoo::laws::Laws),
        ("tests/zoo/mechanisms.axle", &zoo::mechanisms::Mechanisms),
        ("tests/zoo/names.axle", &zoo::names::Names),
        (
            "tests/zoo/axle_b_with_coulomb_friction.axle",
            &zoo::axle_b_with_coulomb_friction::AxleBWithCoulombFriction,
        ),
        (
            "tests/zoo/axle_c_with_suspended_mass.axle",
            &zoo::axle_c_with_suspended_mass::AxleCWithSuspendedMass,
        ),
        (
            "tests/zoo/axle_c_with_tire_dynamic_stiffness.axle",
            &zoo::axle_c_with_tire_dynamic_stiffness::AxleCWithTireDynamicStiffness,
        ),
    ];
    shipped
        .chain(zoo.map(|(file, model)| (file.to_string(), model)))
        .collect()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    #[test]
    fn generated_and_interpreted_are_equal(numbers in prop::collection::vec(-1.0..1.0f64, 256)) {
        PAIRS.iter().for_each(|pair| pair.compare(&numbers));
    }
}

/// Every model, compiled once for all cases.
static PAIRS: LazyLock<Vec<Pair>> = LazyLock::new(|| {
    let pair = |(file, model): (String, &'static dyn Model)| {
        let compiled = compile_file(Path::new(""), &file).unwrap().compiled.unwrap();
        Pair {
            model,
            evaluator: Evaluator::new(&compiled),
        }
    };
    all().into_iter().map(pair).collect()
});

/// Both ways to run one model.
struct Pair {
    model: &'static dyn Model,
    evaluator: Evaluator,
}

impl Pair {
    fn compare(&self, numbers: &[f64]) {
        let about = self.model.about();
        // Positive parameters, any state and input.
        let p: Vec<f64> = numbers
            .iter()
            .take(about.parameters.len())
            .map(|n| 10f64.powf(2.0 * n))
            .collect();
        let x: Vec<f64> = numbers.iter().rev().take(about.states.len()).copied().collect();
        let u: Vec<f64> = numbers.iter().skip(60).take(about.inputs.len()).copied().collect();
        let (generated, interpreted) = (self.model, &self.evaluator);
        let constants = equal(
            about.constants,
            |to| generated.prepare(&p, to),
            |to| interpreted.prepare(&p, to),
        );
        let (c, states, outputs) = (&constants, about.states.len(), about.outputs.len());
        equal(
            states,
            |to| generated.derivative(c, &x, &u, to),
            |to| interpreted.derivative(c, &x, &u, to),
        );
        equal(
            outputs,
            |to| generated.outputs(c, &x, &u, to),
            |to| interpreted.outputs(c, &x, &u, to),
        );
        equal(
            about.matrices.len(),
            |to| generated.matrices(&p, &x, &u, to),
            |to| interpreted.matrices(&p, &x, &u, to),
        );
        equal(
            about.sensitivities.len(),
            |to| generated.sensitivities(&p, &x, &u, to),
            |to| interpreted.sensitivities(&p, &x, &u, to),
        );
        equal(
            about.parameter_jacobian.len(),
            |to| generated.parameter_jacobian(&p, &x, &u, to),
            |to| interpreted.parameter_jacobian(&p, &x, &u, to),
        );
        self.compare_points(c, &p, numbers);
        self.compare_sets(self.model, &p, &x, &u);
        self.compare_sets(&self.evaluator, &p, &x, &u);
        self.compare_responses(c, numbers);
        self.compare_rolling(c, &x, &u, numbers);
    }

    /// Several parameter sets at once, each with its own state and input, give the results of each set alone.
    fn compare_sets(&self, sets: &dyn Model, p: &[f64], x: &[f64], u: &[f64]) {
        let about = self.model.about();
        let row = |(place, value): (usize, &f64)| -> Lanes {
            std::array::from_fn(|set| value * (1.0 + 0.01 * (set * (place + 1)) as f64))
        };
        let rows = |of: &[f64]| -> Vec<Lanes> { of.iter().enumerate().map(row).collect() };
        let room = |rows: usize| vec![[0.0; LANES]; rows];
        let (ps, xs, us) = (rows(p), rows(x), rows(u));
        let alone = &self.evaluator;
        let mut constants = room(about.constants);
        sets.prepare_sets(&ps, &mut constants);
        sets_equal(&constants, [&ps, &[], &[]], |[p, _, _], to| alone.prepare(p, to));
        self.compare_responses_of_sets(sets, &constants);
        let mut rates = room(about.states.len());
        sets.derivative_sets(&constants, &xs, &us, &mut rates);
        sets_equal(&rates, [&constants, &xs, &us], |[c, x, u], to| {
            alone.derivative(c, x, u, to)
        });
        let mut outputs = room(about.outputs.len());
        sets.outputs_sets(&constants, &xs, &us, &mut outputs);
        sets_equal(&outputs, [&constants, &xs, &us], |[c, x, u], to| {
            alone.outputs(c, x, u, to)
        });
        let mut matrices = room(about.matrices.len());
        sets.matrices_sets(&ps, &xs, &us, &mut matrices);
        sets_equal(&matrices, [&ps, &xs, &us], |[p, x, u], to| alone.matrices(p, x, u, to));
        let mut sensitivities = room(about.sensitivities.len());
        sets.sensitivities_sets(&ps, &xs, &us, &mut sensitivities);
        sets_equal(&sensitivities, [&ps, &xs, &us], |[p, x, u], to| {
            alone.sensitivities(p, x, u, to)
        });
        self.compare_rolling_sets(sets, &constants, &xs, &us);
    }

    fn compare_rolling_sets(&self, sets: &dyn Model, constants: &[Lanes], x: &[Lanes], u: &[Lanes]) {
        let alone = &self.evaluator;
        let row = |from: f64, by: f64| -> Lanes { std::array::from_fn(|set| from + by * set as f64) };
        let contacts = Contacts {
            s: row(-0.04, 0.01),
            v: row(-1.0, 0.3),
            force: [row(4000.0, 170.0), row(-300.0, 90.0)],
        };
        let given = [contacts.s, contacts.v, contacts.force[0], contacts.force[1]];
        let force = sets.contact_force_sets(constants, x, &contacts.s, &contacts.v);
        sets_equal(&[force], [constants, x, &given], |[c, x, given], to| {
            to[0] = alone.contact_force(c, x, given[0], given[1]);
        });
        let mut rates = vec![[0.0; LANES]; self.model.about().states.len()];
        sets.rolling_derivative_sets(constants, x, u, &contacts, &mut rates);
        for set in 0..LANES {
            let alone_in = |rows: &[Lanes]| -> Vec<f64> { rows.iter().map(|row| row[set]).collect() };
            let (c, x, u) = (alone_in(constants), alone_in(x), alone_in(u));
            let mut expected = vec![0.0; rates.len()];
            alone.rolling_derivative(&c, &x, &u, &contacts.get(set), &mut expected);
            let found = alone_in(&rates);
            let mut pairs = found.iter().zip(&expected);
            let same = |(a, b): (&f64, &f64)| a.to_bits() == b.to_bits() || (a.is_nan() && b.is_nan());
            assert!(pairs.all(same), "set {set}: {found:?} and {expected:?}");
        }
    }

    /// Thirty-five points: whole blocks and a remainder. Generated code computes them one by one.
    fn compare_points(&self, constants: &[f64], p: &[f64], numbers: &[f64]) {
        const COUNT: usize = 35;
        let (about, generated, interpreted) = (self.model.about(), self.model, &self.evaluator);
        let rows = |from: usize, entries: usize| -> Vec<f64> {
            let numbers = numbers.iter().cycle().skip(from);
            numbers.take(entries * COUNT).copied().collect()
        };
        let (x, u) = (&rows(0, about.states.len())[..], &rows(97, about.inputs.len())[..]);
        let at = Points { count: COUNT, x, u };
        equal(
            COUNT * about.states.len(),
            |to| generated.derivative_at(constants, &at, to),
            |to| interpreted.derivative_at(constants, &at, to),
        );
        equal(
            COUNT * about.outputs.len(),
            |to| generated.outputs_at(constants, &at, to),
            |to| interpreted.outputs_at(constants, &at, to),
        );
        equal(
            COUNT * about.matrices.len(),
            |to| generated.matrices_at(p, &at, to),
            |to| interpreted.matrices_at(p, &at, to),
        );
        equal(
            COUNT * about.parameter_jacobian.len(),
            |to| generated.parameter_jacobian_at(p, &at, to),
            |to| interpreted.parameter_jacobian_at(p, &at, to),
        );
    }

    /// Eleven lines: less than a block.
    fn compare_responses(&self, constants: &[f64], numbers: &[f64]) {
        // Fewer lines than a vector holds, as many, and some that fill no second one.
        for lines in [3, LANES, 11] {
            let omega: Vec<f64> = numbers[..lines].iter().map(|n| 50.0 + 49.0 * n).collect();
            for (excitation, layout) in self.model.about().responses.iter().enumerate() {
                let (n, m) = (lines * layout.outputs.len(), lines * layout.jacobian.len());
                for jacobian in [false, true] {
                    let of = |model: &dyn Model, to: &mut [f64]| {
                        let (re, im, slopes) = split(to, n, m);
                        let jacobian = jacobian.then_some(slopes);
                        model.response(excitation, constants, &omega, ResponseMut { re, im, jacobian });
                    };
                    equal(2 * n + 2 * m, |to| of(self.model, to), |to| of(&self.evaluator, to));
                }
            }
        }
    }

    /// At one line, which is what each set has alone.
    fn compare_responses_of_sets(&self, sets: &dyn Model, constants: &[Lanes]) {
        for (excitation, layout) in self.model.about().responses.iter().enumerate() {
            for with_jacobian in [false, true] {
                let (n, m) = (layout.outputs.len(), layout.slopes(with_jacobian));
                let mut rows = vec![[0.0; LANES]; layout.rows(with_jacobian)];
                sets.response_sets(excitation, constants, &[60.0], with_jacobian, &mut rows);
                sets_equal(&rows, [constants, &[], &[]], |[constants, _, _], to| {
                    let (re, im, slopes) = split(to, n, m);
                    let jacobian = with_jacobian.then_some(slopes);
                    let into = ResponseMut { re, im, jacobian };
                    self.evaluator.response(excitation, constants, &[60.0], into);
                });
            }
        }
    }

    fn compare_rolling(&self, constants: &[f64], x: &[f64], u: &[f64], numbers: &[f64]) {
        let about = self.model.about();
        let [s, v, fz, fx] = [numbers[0], numbers[1], numbers[2], numbers[3]];
        let contact = Contact { s, v, force: [fz, fx] };
        equal(
            1,
            |to| to[0] = self.model.contact_force(constants, x, s, v),
            |to| to[0] = self.evaluator.contact_force(constants, x, s, v),
        );
        equal(
            about.states.len(),
            |to| self.model.rolling_derivative(constants, x, u, &contact, to),
            |to| self.evaluator.rolling_derivative(constants, x, u, &contact, to),
        );
        equal(
            about.outputs.len(),
            |to| self.model.rolling_outputs(constants, x, u, &contact, to),
            |to| self.evaluator.rolling_outputs(constants, x, u, &contact, to),
        );
    }
}

/// Real parts, imaginary parts, and both of the Jacobian.
type Parts<'a> = (&'a mut [f64], &'a mut [f64], (&'a mut [f64], &'a mut [f64]));

fn split(to: &mut [f64], n: usize, m: usize) -> Parts<'_> {
    let (re, rest) = to.split_at_mut(n);
    let (im, rest) = rest.split_at_mut(n);
    (re, im, rest.split_at_mut(m))
}

/// Compares both results bit by bit; all NaN count as equal.
fn equal(length: usize, generated: impl Fn(&mut [f64]), interpreted: impl Fn(&mut [f64])) -> Vec<f64> {
    let [mut one, mut other] = [vec![0.0; length], vec![0.0; length]];
    generated(&mut one);
    interpreted(&mut other);
    for (place, (a, b)) in one.iter().zip(&other).enumerate() {
        assert!(
            a.to_bits() == b.to_bits() || (a.is_nan() && b.is_nan()),
            "value {place}: {a:e} and {b:e}"
        );
    }
    one
}

/// The rows of all sets are those that `alone` gives for each of them, bit by bit.
fn sets_equal(rows: &[Lanes], from: [&[Lanes]; 3], alone: impl Fn([&[f64]; 3], &mut [f64])) {
    for set in 0..LANES {
        let own = from.map(|rows| rows.iter().map(|row| row[set]).collect::<Vec<f64>>());
        let mut expected = vec![0.0; rows.len()];
        alone([&own[0], &own[1], &own[2]], &mut expected);
        for (place, (row, expected)) in rows.iter().zip(&expected).enumerate() {
            let same = row[set].to_bits() == expected.to_bits() || (row[set].is_nan() && expected.is_nan());
            assert!(same, "set {set}, row {place}: {:e} and {expected:e}", row[set]);
        }
    }
}
