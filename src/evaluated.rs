//! The compiler's evaluator behind the runtime's trait, so that a model file runs without a Rust toolchain.

mod about;

use qcar_dsl::evaluate::{self, Evaluator};
use qcar_dsl::schedule::Compiled;
use qcar_runtime::model::{About, Contact, Model, Points, ResponseMut};

/// A compiled model that is interpreted.
pub struct Evaluated {
    about: About,
    evaluator: Evaluator,
}

impl Evaluated {
    /// Makes a compiled model ready to run.
    pub fn new(compiled: &Compiled) -> Self {
        Evaluated {
            about: about::about(&compiled.about),
            evaluator: Evaluator::new(compiled),
        }
    }
}

fn contact(of: &Contact) -> evaluate::Contact {
    evaluate::Contact {
        s: of.s,
        v: of.v,
        force: of.force,
    }
}

fn points<'a>(of: &Points<'a>) -> evaluate::Points<'a> {
    evaluate::Points {
        count: of.count,
        x: of.x,
        u: of.u,
    }
}

impl Model for Evaluated {
    fn about(&self) -> &About {
        &self.about
    }

    fn prepare(&self, p: &[f64], constants: &mut [f64]) {
        self.evaluator.prepare(p, constants);
    }

    fn derivative(&self, constants: &[f64], x: &[f64], u: &[f64], dx: &mut [f64]) {
        self.evaluator.derivative(constants, x, u, dx);
    }

    fn outputs(&self, constants: &[f64], x: &[f64], u: &[f64], y: &mut [f64]) {
        self.evaluator.outputs(constants, x, u, y);
    }

    fn matrices(&self, p: &[f64], x: &[f64], u: &[f64], nonzeros: &mut [f64]) {
        self.evaluator.matrices(p, x, u, nonzeros);
    }

    fn sensitivities(&self, p: &[f64], x: &[f64], u: &[f64], nonzeros: &mut [f64]) {
        self.evaluator.sensitivities(p, x, u, nonzeros);
    }

    fn parameter_jacobian(&self, p: &[f64], x: &[f64], u: &[f64], nonzeros: &mut [f64]) {
        self.evaluator.parameter_jacobian(p, x, u, nonzeros);
    }

    fn derivative_at(&self, constants: &[f64], at: &Points, dx: &mut [f64]) {
        self.evaluator.derivative_at(constants, &points(at), dx);
    }

    fn outputs_at(&self, constants: &[f64], at: &Points, y: &mut [f64]) {
        self.evaluator.outputs_at(constants, &points(at), y);
    }

    fn matrices_at(&self, p: &[f64], at: &Points, nonzeros: &mut [f64]) {
        self.evaluator.matrices_at(p, &points(at), nonzeros);
    }

    fn parameter_jacobian_at(&self, p: &[f64], at: &Points, nonzeros: &mut [f64]) {
        self.evaluator.parameter_jacobian_at(p, &points(at), nonzeros);
    }

    fn response(&self, excitation: usize, constants: &[f64], omega: &[f64], into: ResponseMut<'_>) {
        self.evaluator
            .response(excitation, constants, omega, into.re, into.im, into.jacobian);
    }

    fn contact_force(&self, constants: &[f64], x: &[f64], s: f64, v: f64) -> f64 {
        self.evaluator.contact_force(constants, x, s, v)
    }

    fn rolling_derivative(&self, constants: &[f64], x: &[f64], u: &[f64], of: &Contact, dx: &mut [f64]) {
        self.evaluator.rolling_derivative(constants, x, u, &contact(of), dx);
    }

    fn rolling_outputs(&self, constants: &[f64], x: &[f64], u: &[f64], of: &Contact, y: &mut [f64]) {
        self.evaluator.rolling_outputs(constants, x, u, &contact(of), y);
    }
}
