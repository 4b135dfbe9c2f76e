//! A model whose programs become machine code on first use.

use std::sync::OnceLock;

use qcar_dsl::derive::vectors::Vectors;
use qcar_dsl::evaluate::Evaluator;
use qcar_dsl::evaluate::arguments::{Arguments, Part, prepared, unprepared};
use qcar_dsl::program::{Program, Programs};
use qcar_dsl::schedule::Compiled;
use qcar_model::{About, Contact, Contacts, LANES, Lanes, Model, Points, ResponseMut};

#[cfg(target_arch = "x86_64")]
use crate::code::Code;
use crate::shape::{Shape, VectorWidth};
#[cfg(not(target_arch = "x86_64"))]
use crate::unsupported::Code;

/// A compiled model, its programs translated into machine code.
///
/// Slices have the lengths that [`About`] states; a shorter one panics.
#[derive(Debug)]
pub struct Machine {
    vector_width: VectorWidth,
    /// The interpreter, for programs without machine code.
    interpreter: Evaluator,
    vectors: Vectors,
    programs: Programs,
    prepare: Routine,
    derivative: Routine,
    outputs: Routine,
    matrices: Routine,
    sensitivities: Routine,
    parameter_jacobian: Routine,
    /// The response to each excitation, without and with its Jacobian.
    responses: Vec<[Routine; 2]>,
    contact_force: Routine,
    rolling_derivative: Routine,
    rolling_outputs: Routine,
    /// Models of single links, by their positions.
    alone: Vec<(usize, Machine)>,
}

/// The code of a program in each shape, translated on first use; `None` if there is none.
#[derive(Debug, Default)]
struct Routine {
    once: OnceLock<Option<Code>>,
    sets: OnceLock<Option<Code>>,
    points: OnceLock<Option<Code>>,
    /// For fewer points than the widest vectors hold.
    few: OnceLock<Option<Code>>,
}

/// Points with their own states and inputs.
const SAMPLES: Shape = Shape::Points(&[Part::States, Part::Inputs]);
/// Lines of a frequency response.
const LINES: Shape = Shape::Points(&[Part::Frequency]);

impl Machine {
    /// The machine code of a compiled model, with the widest vectors of this processor. Each program is translated on
    /// first use.
    pub fn new(compiled: &Compiled) -> Self {
        Self::with(compiled, VectorWidth::widest())
    }

    /// The same with vectors of four numbers (AVX) even if the processor has AVX-512. Results have the same bits.
    pub fn with_avx(compiled: &Compiled) -> Self {
        Self::with(compiled, VectorWidth::Four)
    }

    fn with(compiled: &Compiled, vector_width: VectorWidth) -> Self {
        Machine {
            vector_width,
            interpreter: Evaluator::new(compiled),
            vectors: compiled.vectors.clone(),
            responses: compiled.programs.responses.iter().map(|_| Default::default()).collect(),
            programs: compiled.programs.clone(),
            prepare: Routine::default(),
            derivative: Routine::default(),
            outputs: Routine::default(),
            matrices: Routine::default(),
            sensitivities: Routine::default(),
            parameter_jacobian: Routine::default(),
            contact_force: Routine::default(),
            rolling_derivative: Routine::default(),
            rolling_outputs: Routine::default(),
            alone: Vec::new(),
        }
    }

    /// The same with the model of a single link in addition ([`Model::alone`]).
    pub fn with_alone(mut self, axis: &str, link: &str, compiled: &Compiled) -> Self {
        let mut links = self.about().links.iter();
        let place = links.position(|own| own.axis == axis && own.name == link);
        self.alone
            .extend(place.map(|place| (place, Machine::with(compiled, self.vector_width))));
        self
    }

    #[inline]
    fn code<'a>(&self, known: &'a OnceLock<Option<Code>>, program: &Program, shape: Shape) -> Option<&'a Code> {
        let new = || Code::new(&self.vectors, program, shape, self.vector_width);
        known.get_or_init(new).as_ref()
    }

    fn points<'a>(&self, routine: &'a Routine, program: &Program, shape: Shape, points: usize) -> Option<&'a Code> {
        if self.vector_width == VectorWidth::Four || points >= LANES {
            return self.code(&routine.points, program, shape);
        }
        let new = || Code::new(&self.vectors, program, shape, VectorWidth::Four);
        routine.few.get_or_init(new).as_ref()
    }

    #[inline]
    fn once<'a>(&self, routine: &'a Routine, program: &Program) -> Option<&'a Code> {
        self.code(&routine.once, program, Shape::Single)
    }

    #[inline]
    fn sets<'a>(&self, routine: &'a Routine, program: &Program) -> Option<&'a Code> {
        self.code(&routine.sets, program, Shape::Sets)
    }

    /// Evaluates a program at several points; false if there is no machine code for it.
    fn sweep(&self, routine: &Routine, program: &Program, given: &Arguments, points: usize, into: &mut [f64]) -> bool {
        let code = self.points(routine, program, SAMPLES, points);
        code.is_some_and(|code| code.sweep(given, points, &mut [into]))
    }
}

impl Model for Machine {
    fn about(&self) -> &About {
        self.interpreter.about()
    }

    fn prepare(&self, p: &[f64], constants: &mut [f64]) {
        match self.once(&self.prepare, &self.programs.prepare) {
            Some(code) => code.run(&Arguments::default().with(Part::Parameters, p), constants),
            None => self.interpreter.prepare(p, constants),
        }
    }

    fn derivative(&self, constants: &[f64], x: &[f64], u: &[f64], dx: &mut [f64]) {
        match self.once(&self.derivative, &self.programs.derivative) {
            Some(code) => code.run(&prepared(constants, x, u), dx),
            None => self.interpreter.derivative(constants, x, u, dx),
        }
    }

    fn derivative_at(&self, constants: &[f64], at: &Points, dx: &mut [f64]) {
        let (routine, program) = (&self.derivative, &self.programs.derivative);
        if !self.sweep(routine, program, &prepared(constants, at.x, at.u), at.count, dx) {
            self.interpreter.derivative_at(constants, at, dx);
        }
    }

    fn outputs(&self, constants: &[f64], x: &[f64], u: &[f64], y: &mut [f64]) {
        match self.once(&self.outputs, &self.programs.outputs) {
            Some(code) => code.run(&prepared(constants, x, u), y),
            None => self.interpreter.outputs(constants, x, u, y),
        }
    }

    fn outputs_at(&self, constants: &[f64], at: &Points, y: &mut [f64]) {
        let (routine, program) = (&self.outputs, &self.programs.outputs);
        if !self.sweep(routine, program, &prepared(constants, at.x, at.u), at.count, y) {
            self.interpreter.outputs_at(constants, at, y);
        }
    }

    fn matrices(&self, p: &[f64], x: &[f64], u: &[f64], nonzeros: &mut [f64]) {
        match self.once(&self.matrices, &self.programs.matrices) {
            Some(code) => code.run(&unprepared(p, x, u), nonzeros),
            None => self.interpreter.matrices(p, x, u, nonzeros),
        }
    }

    fn matrices_at(&self, p: &[f64], at: &Points, nonzeros: &mut [f64]) {
        let (routine, program) = (&self.matrices, &self.programs.matrices);
        if !self.sweep(routine, program, &unprepared(p, at.x, at.u), at.count, nonzeros) {
            self.interpreter.matrices_at(p, at, nonzeros);
        }
    }

    fn sensitivities(&self, p: &[f64], x: &[f64], u: &[f64], nonzeros: &mut [f64]) {
        match self.once(&self.sensitivities, &self.programs.sensitivities) {
            Some(code) => code.run(&unprepared(p, x, u), nonzeros),
            None => self.interpreter.sensitivities(p, x, u, nonzeros),
        }
    }

    fn parameter_jacobian(&self, p: &[f64], x: &[f64], u: &[f64], nonzeros: &mut [f64]) {
        match self.once(&self.parameter_jacobian, &self.programs.parameter_jacobian) {
            Some(code) => code.run(&unprepared(p, x, u), nonzeros),
            None => self.interpreter.parameter_jacobian(p, x, u, nonzeros),
        }
    }

    fn parameter_jacobian_at(&self, p: &[f64], at: &Points, nonzeros: &mut [f64]) {
        let (routine, program) = (&self.parameter_jacobian, &self.programs.parameter_jacobian);
        if !self.sweep(routine, program, &unprepared(p, at.x, at.u), at.count, nonzeros) {
            self.interpreter.parameter_jacobian_at(p, at, nonzeros);
        }
    }

    fn prepare_sets(&self, p: &[Lanes], constants: &mut [Lanes]) {
        match self.sets(&self.prepare, &self.programs.prepare) {
            Some(code) => code.sets(&[(Part::Parameters, p)], constants),
            None => self.interpreter.prepare_sets(p, constants),
        }
    }

    fn derivative_sets(&self, constants: &[Lanes], x: &[Lanes], u: &[Lanes], dx: &mut [Lanes]) {
        match self.sets(&self.derivative, &self.programs.derivative) {
            Some(code) => code.sets(&state_sets((Part::Constants, constants), x, u), dx),
            None => self.interpreter.derivative_sets(constants, x, u, dx),
        }
    }

    fn outputs_sets(&self, constants: &[Lanes], x: &[Lanes], u: &[Lanes], y: &mut [Lanes]) {
        match self.sets(&self.outputs, &self.programs.outputs) {
            Some(code) => code.sets(&state_sets((Part::Constants, constants), x, u), y),
            None => self.interpreter.outputs_sets(constants, x, u, y),
        }
    }

    fn matrices_sets(&self, p: &[Lanes], x: &[Lanes], u: &[Lanes], nonzeros: &mut [Lanes]) {
        match self.sets(&self.matrices, &self.programs.matrices) {
            Some(code) => code.sets(&state_sets((Part::Parameters, p), x, u), nonzeros),
            None => self.interpreter.matrices_sets(p, x, u, nonzeros),
        }
    }

    fn sensitivities_sets(&self, p: &[Lanes], x: &[Lanes], u: &[Lanes], nonzeros: &mut [Lanes]) {
        match self.sets(&self.sensitivities, &self.programs.sensitivities) {
            Some(code) => code.sets(&state_sets((Part::Parameters, p), x, u), nonzeros),
            None => self.interpreter.sensitivities_sets(p, x, u, nonzeros),
        }
    }

    fn response(&self, excitation: usize, constants: &[f64], omega: &[f64], mut into: ResponseMut<'_>) {
        let given = Arguments::default()
            .with(Part::Constants, constants)
            .with(Part::Frequency, omega);
        let lines = omega.len();
        let known = self
            .responses
            .get(excitation)
            .zip(self.programs.responses.get(excitation));
        let is_done = known.is_some_and(|([value, with_jacobian], programs)| match &mut into.jacobian {
            None => {
                let code = self.points(value, &programs.value, LINES, lines);
                code.is_some_and(|code| code.sweep(&given, lines, &mut [into.re, into.im]))
            }
            Some((d_re, d_im)) => {
                let code = self.points(with_jacobian, &programs.with_jacobian, LINES, lines);
                code.is_some_and(|code| code.sweep(&given, lines, &mut [into.re, into.im, d_re, d_im]))
            }
        });
        if !is_done {
            self.interpreter.response(excitation, constants, omega, into);
        }
    }

    fn line_sets(&self, excitation: usize, constants: &[Lanes], omega: f64, with_jacobian: bool, into: &mut [Lanes]) {
        let known = self.responses.get(excitation);
        let known = known.zip(self.programs.responses.get(excitation));
        let code = known.and_then(|([value, whole], programs)| match with_jacobian {
            false => self.sets(value, &programs.value),
            true => self.sets(whole, &programs.with_jacobian),
        });
        let Some(code) = code else {
            return self
                .interpreter
                .line_sets(excitation, constants, omega, with_jacobian, into);
        };
        let frequency = [[omega; LANES]];
        code.sets(&[(Part::Constants, constants), (Part::Frequency, &frequency)], into);
    }

    fn contact_force(&self, constants: &[f64], x: &[f64], s: f64, v: f64) -> f64 {
        let rolling = self.programs.rolling.as_ref();
        let Some(code) = rolling.and_then(|rolling| self.once(&self.contact_force, &rolling.contact_force)) else {
            return self.interpreter.contact_force(constants, x, s, v);
        };
        let (mut force, contact) = ([0.0], [s, v]);
        code.run(&prepared(constants, x, &[]).with(Part::Contact, &contact), &mut force);
        force[0]
    }

    fn rolling_derivative(&self, constants: &[f64], x: &[f64], u: &[f64], contact: &Contact, dx: &mut [f64]) {
        let rolling = self.programs.rolling.as_ref();
        let Some(code) = rolling.and_then(|rolling| self.once(&self.rolling_derivative, &rolling.derivative)) else {
            return self.interpreter.rolling_derivative(constants, x, u, contact, dx);
        };
        code.run(&prepared(constants, x, u).with(Part::Contact, &contact.entries()), dx);
    }

    fn rolling_outputs(&self, constants: &[f64], x: &[f64], u: &[f64], contact: &Contact, y: &mut [f64]) {
        let rolling = self.programs.rolling.as_ref();
        let Some(code) = rolling.and_then(|rolling| self.once(&self.rolling_outputs, &rolling.outputs)) else {
            return self.interpreter.rolling_outputs(constants, x, u, contact, y);
        };
        code.run(&prepared(constants, x, u).with(Part::Contact, &contact.entries()), y);
    }

    fn contact_force_sets(&self, constants: &[Lanes], x: &[Lanes], s: &Lanes, v: &Lanes) -> Lanes {
        let rolling = self.programs.rolling.as_ref();
        let Some(code) = rolling.and_then(|rolling| self.sets(&self.contact_force, &rolling.contact_force)) else {
            return self.interpreter.contact_force_sets(constants, x, s, v);
        };
        let (mut force, contact) = ([[0.0; LANES]], [*s, *v]);
        let given = [
            (Part::Constants, constants),
            (Part::States, x),
            (Part::Contact, &contact),
        ];
        code.sets(&given, &mut force);
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
        let rolling = self.programs.rolling.as_ref();
        let Some(code) = rolling.and_then(|rolling| self.sets(&self.rolling_derivative, &rolling.derivative)) else {
            return self.interpreter.rolling_derivative_sets(constants, x, u, contacts, dx);
        };
        let [constants, x, u] = state_sets((Part::Constants, constants), x, u);
        code.sets(&[constants, x, u, (Part::Contact, &contacts.entries())], dx);
    }

    fn rolling_outputs_sets(
        &self,
        constants: &[Lanes],
        x: &[Lanes],
        u: &[Lanes],
        contacts: &Contacts,
        y: &mut [Lanes],
    ) {
        let rolling = self.programs.rolling.as_ref();
        let Some(code) = rolling.and_then(|rolling| self.sets(&self.rolling_outputs, &rolling.outputs)) else {
            return self.interpreter.rolling_outputs_sets(constants, x, u, contacts, y);
        };
        let [constants, x, u] = state_sets((Part::Constants, constants), x, u);
        code.sets(&[constants, x, u, (Part::Contact, &contacts.entries())], y);
    }

    fn alone(&self, link: usize) -> Option<&dyn Model> {
        let found = self.alone.iter().find(|(place, _)| *place == link);
        found.map(|(_, own)| own as &dyn Model)
    }
}

type ArgumentSets<'a> = [(Part, &'a [Lanes]); 3];

fn state_sets<'a>(of_set: (Part, &'a [Lanes]), x: &'a [Lanes], u: &'a [Lanes]) -> ArgumentSets<'a> {
    [of_set, (Part::States, x), (Part::Inputs, u)]
}
