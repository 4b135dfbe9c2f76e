//! Programs interpreted at run time: the operations of the generated code, reordered for speed.

// The arguments of a program.
pub mod arguments;
// The order in which operations are evaluated.
mod order;
// A program prepared for evaluation.
mod code;

use qcar_model::{About, Contact, Contacts, LANES, Lanes, Model, Points, ResponseMut};

use crate::program::schedule::Compiled;
use arguments::{Arguments, Part, prepared, unprepared};
use code::Code;

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
    /// Single links on a dynamometer, each with its position in `About::links`.
    alone: Vec<(usize, Evaluator)>,
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

/// Runs a program at several points.
fn sweep(code: &Code, given: &Arguments, count: usize, into: &mut [f64]) {
    code.sweep(given, &[Part::States, Part::Inputs], count, &mut [into]);
}

impl Evaluator {
    /// Binds the programs of a model to its vectors.
    pub fn new(compiled: &Compiled) -> Self {
        let programs = &compiled.programs;
        let code = |program| Code::new(&compiled.vectors, program);
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
            alone: Vec::new(),
            about: compiled.about.clone(),
        }
    }

    /// The same evaluator with the model of a single link on a dynamometer.
    pub fn with_alone(mut self, axis: &str, link: &str, compiled: &Compiled) -> Self {
        let mut links = self.about.links.iter();
        let place = links.position(|own| own.axis == axis && own.name == link);
        self.alone.extend(place.map(|place| (place, Evaluator::new(compiled))));
        self
    }
}

impl Model for Evaluator {
    fn about(&self) -> &About {
        &self.about
    }

    fn prepare(&self, p: &[f64], constants: &mut [f64]) {
        self.prepare
            .run(&Arguments::default().with(Part::Parameters, p), constants);
    }

    fn derivative(&self, constants: &[f64], x: &[f64], u: &[f64], dx: &mut [f64]) {
        self.derivative.run(&prepared(constants, x, u), dx);
    }

    fn derivative_at(&self, constants: &[f64], at: &Points, dx: &mut [f64]) {
        sweep(&self.derivative, &prepared(constants, at.x, at.u), at.count, dx);
    }

    fn outputs(&self, constants: &[f64], x: &[f64], u: &[f64], y: &mut [f64]) {
        self.outputs.run(&prepared(constants, x, u), y);
    }

    fn outputs_at(&self, constants: &[f64], at: &Points, y: &mut [f64]) {
        sweep(&self.outputs, &prepared(constants, at.x, at.u), at.count, y);
    }

    fn matrices(&self, p: &[f64], x: &[f64], u: &[f64], nonzeros: &mut [f64]) {
        self.matrices.run(&unprepared(p, x, u), nonzeros);
    }

    fn matrices_at(&self, p: &[f64], at: &Points, nonzeros: &mut [f64]) {
        sweep(&self.matrices, &unprepared(p, at.x, at.u), at.count, nonzeros);
    }

    fn sensitivities(&self, p: &[f64], x: &[f64], u: &[f64], nonzeros: &mut [f64]) {
        self.sensitivities.run(&unprepared(p, x, u), nonzeros);
    }

    fn parameter_jacobian(&self, p: &[f64], x: &[f64], u: &[f64], nonzeros: &mut [f64]) {
        self.parameter_jacobian.run(&unprepared(p, x, u), nonzeros);
    }

    fn parameter_jacobian_at(&self, p: &[f64], at: &Points, nonzeros: &mut [f64]) {
        sweep(&self.parameter_jacobian, &unprepared(p, at.x, at.u), at.count, nonzeros);
    }

    fn prepare_sets(&self, p: &[Lanes], constants: &mut [Lanes]) {
        self.prepare.sets(&[(Part::Parameters, p)], constants);
    }

    fn derivative_sets(&self, constants: &[Lanes], x: &[Lanes], u: &[Lanes], dx: &mut [Lanes]) {
        self.derivative.sets(&prepared_sets(constants, x, u), dx);
    }

    fn outputs_sets(&self, constants: &[Lanes], x: &[Lanes], u: &[Lanes], y: &mut [Lanes]) {
        self.outputs.sets(&prepared_sets(constants, x, u), y);
    }

    fn matrices_sets(&self, p: &[Lanes], x: &[Lanes], u: &[Lanes], nonzeros: &mut [Lanes]) {
        self.matrices.sets(&unprepared_sets(p, x, u), nonzeros);
    }

    fn sensitivities_sets(&self, p: &[Lanes], x: &[Lanes], u: &[Lanes], nonzeros: &mut [Lanes]) {
        self.sensitivities.sets(&unprepared_sets(p, x, u), nonzeros);
    }

    fn response(&self, excitation: usize, constants: &[f64], omega: &[f64], into: ResponseMut<'_>) {
        let Some(response) = self.responses.get(excitation) else {
            return;
        };
        let given = Arguments::default()
            .with(Part::Constants, constants)
            .with(Part::Frequency, omega);
        let sweep = |code: &Code, into: &mut [&mut [f64]]| code.sweep(&given, &[Part::Frequency], omega.len(), into);
        let ResponseMut { re, im, jacobian } = into;
        match jacobian {
            None => sweep(&response.value, &mut [re, im]),
            Some((d_re, d_im)) => sweep(&response.with_jacobian, &mut [re, im, d_re, d_im]),
        }
    }

    fn line_sets(&self, excitation: usize, constants: &[Lanes], omega: f64, with_jacobian: bool, into: &mut [Lanes]) {
        let Some(response) = self.responses.get(excitation) else {
            return;
        };
        let code = match with_jacobian {
            false => &response.value,
            true => &response.with_jacobian,
        };
        let frequency = [[omega; LANES]];
        code.sets(&[(Part::Constants, constants), (Part::Frequency, &frequency)], into);
    }

    fn contact_force(&self, constants: &[f64], x: &[f64], s: f64, v: f64) -> f64 {
        let mut force = [0.0];
        if let Some(rolling) = &self.rolling {
            let contact = [s, v];
            let given = prepared(constants, x, &[]).with(Part::Contact, &contact);
            rolling.contact_force.run(&given, &mut force);
        }
        force[0]
    }

    fn rolling_derivative(&self, constants: &[f64], x: &[f64], u: &[f64], contact: &Contact, dx: &mut [f64]) {
        let rolling = self.rolling.as_ref().map(|rolling| &rolling.derivative);
        let contact = contact.entries();
        let given = prepared(constants, x, u).with(Part::Contact, &contact);
        rolling.unwrap_or(&self.derivative).run(&given, dx);
    }

    fn contact_force_sets(&self, constants: &[Lanes], x: &[Lanes], s: &Lanes, v: &Lanes) -> Lanes {
        let mut force = [[0.0; LANES]];
        if let Some(rolling) = &self.rolling {
            let [constants, x, _] = prepared_sets(constants, x, &[]);
            let given = [constants, x, (Part::Contact, &[*s, *v])];
            rolling.contact_force.sets(&given, &mut force);
        }
        force[0]
    }

    fn rolling_derivative_sets(
        &self,
        constants: &[Lanes],
        x: &[Lanes],
        u: &[Lanes],
        contacts: &Contacts,
        dx: &mut [Lanes],
    ) {
        let rolling = self.rolling.as_ref().map(|rolling| &rolling.derivative);
        let contact = [contacts.s, contacts.v, contacts.force[0], contacts.force[1]];
        let [constants, x, u] = prepared_sets(constants, x, u);
        let given = [constants, x, u, (Part::Contact, &contact)];
        rolling.unwrap_or(&self.derivative).sets(&given, dx);
    }

    fn alone(&self, link: usize) -> Option<&dyn Model> {
        let found = self.alone.iter().find(|(place, _)| *place == link);
        found.map(|(_, own)| own as &dyn Model)
    }

    fn rolling_outputs(&self, constants: &[f64], x: &[f64], u: &[f64], contact: &Contact, y: &mut [f64]) {
        let rolling = self.rolling.as_ref().map(|rolling| &rolling.outputs);
        let contact = contact.entries();
        let given = prepared(constants, x, u).with(Part::Contact, &contact);
        rolling.unwrap_or(&self.outputs).run(&given, y);
    }
}

type ArgumentSets<'a> = [(Part, &'a [Lanes]); 3];

/// As [`prepared`], for several parameter sets.
fn prepared_sets<'a>(constants: &'a [Lanes], x: &'a [Lanes], u: &'a [Lanes]) -> ArgumentSets<'a> {
    [(Part::Constants, constants), (Part::States, x), (Part::Inputs, u)]
}

/// As [`unprepared`], for several parameter sets.
fn unprepared_sets<'a>(p: &'a [Lanes], x: &'a [Lanes], u: &'a [Lanes]) -> ArgumentSets<'a> {
    [(Part::Parameters, p), (Part::States, x), (Part::Inputs, u)]
}
