//! Programs interpreted at run time: the operations of the generated code, in an order of their own.

// What it reads.
mod given;
// Which operation comes after which.
mod order;
// One program.
mod code;

use crate::derive::about::About;
use crate::program::schedule::Compiled;
use code::Code;
use given::{Given, Part};

/// A compiled model, ready to be evaluated.
///
/// Slices have the lengths that [`About`] states; a shorter one panics.
#[derive(Clone, Debug)]
pub struct Evaluator {
    about: About,
    prepare: Code,
    derivative: Code,
    outputs: Code,
    matrices: Code,
    sensitivities: Code,
    parameter_jacobian: Code,
    responses: Vec<ResponseCode>,
    rolling: Option<RollingCode>,
}

#[derive(Clone, Debug)]
struct ResponseCode {
    value: Code,
    with_jacobian: Code,
}

#[derive(Clone, Debug)]
struct RollingCode {
    contact_force: Code,
    derivative: Code,
    outputs: Code,
}

/// What a tyre that rolls over a profile gives to its model.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Contact {
    /// Equivalent stretch, m.
    pub s: f64,
    /// Its rate, m/s.
    pub v: f64,
    /// The force on the wheel along the axes of the contact, N.
    pub force: [f64; 2],
}

impl Contact {
    /// In the order of the part that programs read.
    fn entries(&self) -> [f64; 4] {
        [self.s, self.v, self.force[0], self.force[1]]
    }
}

/// States and inputs at several points.
#[derive(Clone, Copy, Debug)]
pub struct Points<'a> {
    /// How many.
    pub count: usize,
    /// A row of points for each state.
    pub x: &'a [f64],
    /// A row of points for each input.
    pub u: &'a [f64],
}

impl Points<'_> {
    fn sweep(&self, code: &Code, given: &Given, into: &mut [f64]) {
        code.sweep(given, &[Part::States, Part::Inputs], self.count, &mut [into]);
    }
}

impl Evaluator {
    /// Binds the programs of a model to its vectors.
    pub fn new(compiled: &Compiled) -> Self {
        let about = compiled.about.clone();
        let programs = &compiled.programs;
        let code = |program| Code::new(&about, program);
        let responses = programs.responses.iter();
        Evaluator {
            prepare: code(&programs.prepare),
            derivative: code(&programs.derivative),
            outputs: code(&programs.outputs),
            matrices: code(&programs.matrices),
            sensitivities: code(&programs.sensitivities),
            parameter_jacobian: code(&programs.parameter_jacobian),
            responses: responses
                .map(|response| ResponseCode {
                    value: code(&response.value),
                    with_jacobian: code(&response.with_jacobian),
                })
                .collect(),
            rolling: programs.rolling.as_ref().map(|rolling| RollingCode {
                contact_force: code(&rolling.contact_force),
                derivative: code(&rolling.derivative),
                outputs: code(&rolling.outputs),
            }),
            about,
        }
    }

    /// Names, places and sparsity.
    pub fn about(&self) -> &About {
        &self.about
    }

    /// Computes once what depends on the parameters alone.
    pub fn prepare(&self, p: &[f64], constants: &mut [f64]) {
        self.prepare.run(&Given::default().with(Part::Parameters, p), constants);
    }

    /// `dx = f(x, u)`
    pub fn derivative(&self, constants: &[f64], x: &[f64], u: &[f64], dx: &mut [f64]) {
        self.derivative.run(&prepared(constants, x, u), dx);
    }

    /// The same at several points, a row of them for each entry of `dx`.
    pub fn derivative_at(&self, constants: &[f64], at: &Points, dx: &mut [f64]) {
        at.sweep(&self.derivative, &prepared(constants, at.x, at.u), dx);
    }

    /// `y = h(x, u)`
    pub fn outputs(&self, constants: &[f64], x: &[f64], u: &[f64], y: &mut [f64]) {
        self.outputs.run(&prepared(constants, x, u), y);
    }

    /// The same at several points, a row of them for each entry of `y`.
    pub fn outputs_at(&self, constants: &[f64], at: &Points, y: &mut [f64]) {
        at.sweep(&self.outputs, &prepared(constants, at.x, at.u), y);
    }

    /// Nonzeros of A, B, C and D.
    pub fn matrices(&self, p: &[f64], x: &[f64], u: &[f64], nonzeros: &mut [f64]) {
        self.matrices.run(&unprepared(p, x, u), nonzeros);
    }

    /// The same at several points, a row of them for each nonzero.
    pub fn matrices_at(&self, p: &[f64], at: &Points, nonzeros: &mut [f64]) {
        at.sweep(&self.matrices, &unprepared(p, at.x, at.u), nonzeros);
    }

    /// Nonzeros of the parameter Jacobians of A, B, C and D.
    pub fn sensitivities(&self, p: &[f64], x: &[f64], u: &[f64], nonzeros: &mut [f64]) {
        self.sensitivities.run(&unprepared(p, x, u), nonzeros);
    }

    /// Nonzeros of ∂f/∂p and ∂h/∂p.
    pub fn parameter_jacobian(&self, p: &[f64], x: &[f64], u: &[f64], nonzeros: &mut [f64]) {
        self.parameter_jacobian.run(&unprepared(p, x, u), nonzeros);
    }

    /// The same at several points, a row of them for each nonzero.
    pub fn parameter_jacobian_at(&self, p: &[f64], at: &Points, nonzeros: &mut [f64]) {
        at.sweep(&self.parameter_jacobian, &unprepared(p, at.x, at.u), nonzeros);
    }

    /// The frequency response to one excitation at each of the angular frequencies `omega` (rad/s): a row of lines for
    /// each output of the layout in `re` and `im`, and for each entry of its Jacobian in the pair `jacobian`.
    pub fn response(
        &self,
        excitation: usize,
        constants: &[f64],
        omega: &[f64],
        re: &mut [f64],
        im: &mut [f64],
        jacobian: Option<(&mut [f64], &mut [f64])>,
    ) {
        let Some(response) = self.responses.get(excitation) else {
            return;
        };
        let given = Given::default()
            .with(Part::Constants, constants)
            .with(Part::Frequency, omega);
        let sweep = |code: &Code, into: &mut [&mut [f64]]| code.sweep(&given, &[Part::Frequency], omega.len(), into);
        match jacobian {
            None => sweep(&response.value, &mut [re, im]),
            Some((d_re, d_im)) => sweep(&response.with_jacobian, &mut [re, im, d_re, d_im]),
        }
    }

    /// The resisting force of a rolling tyre, N; zero where no tyre can roll.
    pub fn contact_force(&self, constants: &[f64], x: &[f64], s: f64, v: f64) -> f64 {
        let mut force = [0.0];
        if let Some(rolling) = &self.rolling {
            let contact = [s, v];
            let given = prepared(constants, x, &[]).with(Part::Contact, &contact);
            rolling.contact_force.run(&given, &mut force);
        }
        force[0]
    }

    /// The equations of motion while the tyre rolls; those of the standing model where no tyre can.
    pub fn rolling_derivative(&self, constants: &[f64], x: &[f64], u: &[f64], contact: &Contact, dx: &mut [f64]) {
        let rolling = self.rolling.as_ref().map(|rolling| &rolling.derivative);
        let contact = contact.entries();
        let given = prepared(constants, x, u).with(Part::Contact, &contact);
        rolling.unwrap_or(&self.derivative).run(&given, dx);
    }

    /// The outputs while the tyre rolls; those of the standing model where no tyre can.
    pub fn rolling_outputs(&self, constants: &[f64], x: &[f64], u: &[f64], contact: &Contact, y: &mut [f64]) {
        let rolling = self.rolling.as_ref().map(|rolling| &rolling.outputs);
        let contact = contact.entries();
        let given = prepared(constants, x, u).with(Part::Contact, &contact);
        rolling.unwrap_or(&self.outputs).run(&given, y);
    }
}

/// What a program reads that sees the parameters through what was prepared of them.
fn prepared<'a>(constants: &'a [f64], x: &'a [f64], u: &'a [f64]) -> Given<'a> {
    moving(x, u).with(Part::Constants, constants)
}

/// What a program reads that sees the parameters themselves.
fn unprepared<'a>(p: &'a [f64], x: &'a [f64], u: &'a [f64]) -> Given<'a> {
    moving(x, u).with(Part::Parameters, p)
}

fn moving<'a>(x: &'a [f64], u: &'a [f64]) -> Given<'a> {
    Given::default().with(Part::States, x).with(Part::Inputs, u)
}
