//! Comparison of machine code with the interpreter.

use qcar_dsl::evaluate::Evaluator;
use qcar_dsl::schedule::Compiled;
use qcar_machine::Machine;
use qcar_model::{About, Contact, Contacts, LANES, Lanes, Model, Points, ResponseMut};

/// A compiled model in the interpreter, and as machine code with vectors of four and of eight numbers.
pub struct Comparison {
    interpreted: Evaluator,
    machines: [Machine; 2],
}

/// Arguments of a model: numbers that are repeated if there are too few.
pub struct At<'a>(pub &'a [f64]);

impl At<'_> {
    fn numbers(&self, from: usize, count: usize) -> Vec<f64> {
        self.0.iter().cycle().skip(from).take(count).copied().collect()
    }

    fn positive(&self, from: usize, count: usize) -> Vec<f64> {
        let numbers = self.numbers(from, count).into_iter();
        numbers.map(|number| 10f64.powf(2.0 * number)).collect()
    }
}

impl Comparison {
    pub fn new(compiled: &Compiled) -> Self {
        Comparison {
            interpreted: Evaluator::new(compiled),
            machines: [Machine::new(compiled), Machine::with_avx(compiled)],
        }
    }

    fn about(&self) -> &About {
        self.interpreted.about()
    }

    /// Compares every function of the trait for random arguments.
    pub fn compare(&self, at: &At) {
        let about = self.about();
        let p = at.positive(0, about.parameters.len());
        let constants = self.same(about.constants, |model, to| model.prepare(&p, to));
        self.compare_once(&p, &constants, at);
        self.compare_sets(&p, at);
        for count in [1, 3, 4, 5, 8, 35] {
            self.compare_points(&p, &constants, at, count);
            self.compare_responses(&constants, at, count);
        }
    }

    fn compare_once(&self, p: &[f64], constants: &[f64], at: &At) {
        let about = self.about();
        let (x, u) = (at.numbers(31, about.states.len()), at.numbers(7, about.inputs.len()));
        let (states, outputs) = (about.states.len(), about.outputs.len());
        self.same(states, |model, to| model.derivative(constants, &x, &u, to));
        self.same(outputs, |model, to| model.outputs(constants, &x, &u, to));
        self.same(about.matrices.len(), |model, to| model.matrices(p, &x, &u, to));
        self.same(about.sensitivities.len(), |model, to| {
            model.sensitivities(p, &x, &u, to)
        });
        self.same(about.parameter_jacobian.len(), |model, to| {
            model.parameter_jacobian(p, &x, &u, to)
        });
        let n = at.numbers(3, 4);
        let (s, v) = (n[0], n[1]);
        let contact = Contact {
            s,
            v,
            force: [n[2], n[3]],
        };
        self.same(1, |model, to| to[0] = model.contact_force(constants, &x, s, v));
        self.same(states, |model, to| {
            model.rolling_derivative(constants, &x, &u, &contact, to)
        });
        self.same(outputs, |model, to| {
            model.rolling_outputs(constants, &x, &u, &contact, to)
        });
    }

    fn compare_sets(&self, p: &[f64], at: &At) {
        let about = self.about();
        let spread = |(place, value): (usize, &f64)| -> Lanes {
            std::array::from_fn(|set| value * (1.0 + 0.01 * (set * (place + 1)) as f64))
        };
        let rows = |of: &[f64]| -> Vec<Lanes> { of.iter().enumerate().map(spread).collect() };
        let p = rows(p);
        let (x, u) = (
            &rows(&at.numbers(11, about.states.len())),
            &rows(&at.numbers(5, about.inputs.len())),
        );
        let constants = &self.same_rows(about.constants, |model, to| model.prepare_sets(&p, to));
        self.same_rows(about.states.len(), |model, to| {
            model.derivative_sets(constants, x, u, to)
        });
        self.same_rows(about.outputs.len(), |model, to| model.outputs_sets(constants, x, u, to));
        self.same_rows(about.matrices.len(), |model, to| model.matrices_sets(&p, x, u, to));
        self.same_rows(about.sensitivities.len(), |model, to| {
            model.sensitivities_sets(&p, x, u, to)
        });
        let contact: [Lanes; 4] = std::array::from_fn(|row| at.numbers(3 + row, LANES).try_into().expect("so many"));
        let [s, v, ..] = contact;
        let contacts = &Contacts {
            s,
            v,
            force: [contact[2], contact[3]],
        };
        self.same_rows(1, |model, to| to[0] = model.contact_force_sets(constants, x, &s, &v));
        self.same_rows(about.states.len(), |model, to| {
            model.rolling_derivative_sets(constants, x, u, contacts, to)
        });
        self.same_rows(about.outputs.len(), |model, to| {
            model.rolling_outputs_sets(constants, x, u, contacts, to)
        });
        self.compare_responses_of_sets(constants, &at.positive(19, 3));
    }

    /// Compares responses of sets also with the interpreter's response of each set alone.
    fn compare_responses_of_sets(&self, constants: &[Lanes], omega: &[f64]) {
        for (excitation, layout) in self.about().responses.iter().enumerate() {
            for wanted in [false, true] {
                let (n, m) = (layout.outputs.len(), layout.slopes(wanted));
                let rows = layout.rows(wanted);
                let found = self.same_rows(omega.len() * rows, |model, to| {
                    model.response_sets(excitation, constants, omega, wanted, to)
                });
                for set in 0..LANES {
                    let constants: Vec<f64> = constants.iter().map(|row| row[set]).collect();
                    let mut alone = [n, n, m, m].map(|rows| vec![0.5; rows * omega.len()]);
                    let [re, im, d_re, d_im] = &mut alone;
                    let jacobian = wanted.then_some((&mut d_re[..], &mut d_im[..]));
                    let into = ResponseMut { re, im, jacobian };
                    self.interpreted.response(excitation, &constants, omega, into);
                    let alone = alone.concat();
                    for (place, row) in found.iter().enumerate() {
                        let alone = alone[place % rows * omega.len() + place / rows];
                        let same = row[set].to_bits() == alone.to_bits() || row[set].is_nan() && alone.is_nan();
                        assert!(same, "row {place} of set {set}: {:e}, alone {alone:e}", row[set]);
                    }
                }
            }
        }
    }

    fn compare_points(&self, p: &[f64], constants: &[f64], at: &At, count: usize) {
        let about = self.about();
        let (x, u) = (
            &at.numbers(0, count * about.states.len())[..],
            &at.numbers(97, count * about.inputs.len())[..],
        );
        let points = &Points { count, x, u };
        self.same(count * about.states.len(), |model, to| {
            model.derivative_at(constants, points, to)
        });
        self.same(count * about.outputs.len(), |model, to| {
            model.outputs_at(constants, points, to)
        });
        self.same(count * about.matrices.len(), |model, to| {
            model.matrices_at(p, points, to)
        });
        self.same(count * about.parameter_jacobian.len(), |model, to| {
            model.parameter_jacobian_at(p, points, to)
        });
    }

    fn compare_responses(&self, constants: &[f64], at: &At, lines: usize) {
        let omega = at.positive(19, lines);
        for (excitation, layout) in self.about().responses.iter().enumerate() {
            let (n, m) = (lines * layout.outputs.len(), lines * layout.jacobian.len());
            for wanted in [false, true] {
                self.same(2 * (n + m), |model, to| {
                    let (re, rest) = to.split_at_mut(n);
                    let (im, rest) = rest.split_at_mut(n);
                    let jacobian = wanted.then_some(rest.split_at_mut(m));
                    model.response(excitation, constants, &omega, ResponseMut { re, im, jacobian });
                });
            }
        }
    }

    fn same_rows(&self, rows: usize, evaluate: impl Fn(&dyn Model, &mut [Lanes])) -> Vec<Lanes> {
        let flat = self.same(LANES * rows, |model, to| evaluate(model, to.as_chunks_mut().0));
        flat.as_chunks().0.to_vec()
    }

    /// The values of the interpreter, after a check that machine code gives the same bits, or NaN where that does.
    pub fn same(&self, length: usize, evaluate: impl Fn(&dyn Model, &mut [f64])) -> Vec<f64> {
        let mut expected = vec![0.5; length];
        evaluate(&self.interpreted, &mut expected);
        for machine in &self.machines {
            let mut got = vec![0.5; length];
            evaluate(machine, &mut got);
            for (place, (got, expected)) in got.iter().zip(&expected).enumerate() {
                let same = got.to_bits() == expected.to_bits() || got.is_nan() && expected.is_nan();
                assert!(same, "value {place} of {length}: {got:e}, interpreted {expected:e}");
            }
        }
        expected
    }
}
