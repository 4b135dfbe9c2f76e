//! Programs interpreted at run time: the operations of the generated code, in its order.
//!
//! A frequency response is computed for a block of lines at once, so that the interpretation of an operation is paid
//! once a block. Nothing is allocated in a call but a thread's scratch space, once.

use std::cell::RefCell;

use crate::about::About;
use crate::expr::Symbol;
use crate::program::{Op, Program, Value};
use crate::schedule::Compiled;

/// Lines of a frequency response that are computed together: enough to hide the interpretation of an operation, and few
/// enough that the values of a whole program stay close to the processor.
const BLOCK: usize = 16;

thread_local! {
    static SCRATCH: RefCell<Vec<f64>> = const { RefCell::new(Vec::new()) };
}

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
        self.prepare.run(&Given { p, ..Given::default() }, constants);
    }

    /// `dx = f(x, u)`
    pub fn derivative(&self, constants: &[f64], x: &[f64], u: &[f64], dx: &mut [f64]) {
        self.derivative.run(
            &Given {
                constants,
                x,
                u,
                ..Given::default()
            },
            dx,
        );
    }

    /// `y = h(x, u)`
    pub fn outputs(&self, constants: &[f64], x: &[f64], u: &[f64], y: &mut [f64]) {
        self.outputs.run(
            &Given {
                constants,
                x,
                u,
                ..Given::default()
            },
            y,
        );
    }

    /// Nonzeros of A, B, C and D.
    pub fn matrices(&self, p: &[f64], x: &[f64], u: &[f64], nonzeros: &mut [f64]) {
        self.matrices.run(
            &Given {
                p,
                x,
                u,
                ..Given::default()
            },
            nonzeros,
        );
    }

    /// Nonzeros of the parameter Jacobians of A, B, C and D.
    pub fn sensitivities(&self, p: &[f64], x: &[f64], u: &[f64], nonzeros: &mut [f64]) {
        self.sensitivities.run(
            &Given {
                p,
                x,
                u,
                ..Given::default()
            },
            nonzeros,
        );
    }

    /// Nonzeros of ∂f/∂p and ∂h/∂p.
    pub fn parameter_jacobian(&self, p: &[f64], x: &[f64], u: &[f64], nonzeros: &mut [f64]) {
        self.parameter_jacobian.run(
            &Given {
                p,
                x,
                u,
                ..Given::default()
            },
            nonzeros,
        );
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
        let given = Given {
            constants,
            ..Given::default()
        };
        match jacobian {
            None => response.value.sweep(&given, omega, &mut [re, im]),
            Some((d_re, d_im)) => response.with_jacobian.sweep(&given, omega, &mut [re, im, d_re, d_im]),
        }
    }

    /// The resisting force of a rolling tyre, N; zero where no tyre can roll.
    pub fn contact_force(&self, constants: &[f64], x: &[f64], s: f64, v: f64) -> f64 {
        let mut force = [0.0];
        if let Some(rolling) = &self.rolling {
            let contact = Contact {
                s,
                v,
                ..Contact::default()
            };
            rolling.contact_force.run(
                &Given {
                    constants,
                    x,
                    contact,
                    ..Given::default()
                },
                &mut force,
            );
        }
        force[0]
    }

    /// The equations of motion while the tyre rolls; those of the standing model where no tyre can.
    pub fn rolling_derivative(&self, constants: &[f64], x: &[f64], u: &[f64], contact: &Contact, dx: &mut [f64]) {
        let code = self
            .rolling
            .as_ref()
            .map_or(&self.derivative, |rolling| &rolling.derivative);
        code.run(
            &Given {
                constants,
                x,
                u,
                contact: *contact,
                ..Given::default()
            },
            dx,
        );
    }

    /// The outputs while the tyre rolls; those of the standing model where no tyre can.
    pub fn rolling_outputs(&self, constants: &[f64], x: &[f64], u: &[f64], contact: &Contact, y: &mut [f64]) {
        let code = self.rolling.as_ref().map_or(&self.outputs, |rolling| &rolling.outputs);
        code.run(
            &Given {
                constants,
                x,
                u,
                contact: *contact,
                ..Given::default()
            },
            y,
        );
    }
}

/// What the leaves of a program are read from.
#[derive(Clone, Copy, Default)]
struct Given<'a> {
    p: &'a [f64],
    constants: &'a [f64],
    x: &'a [f64],
    u: &'a [f64],
    contact: Contact,
}

/// What is given to a program, in the order in which it stands in the registers.
#[derive(Clone, Copy, Debug)]
enum Part {
    Parameters,
    Constants,
    States,
    Inputs,
    Contact,
}

impl Given<'_> {
    /// All parts, in the order of [`Part`].
    fn with_parts(&self, mut take: impl FnMut(Part, &[f64])) {
        let Contact { s, v, force } = self.contact;
        take(Part::Parameters, self.p);
        take(Part::Constants, self.constants);
        take(Part::States, self.x);
        take(Part::Inputs, self.u);
        take(Part::Contact, &[s, v, force[0], force[1]]);
    }
}

/// Number of the variants of [`Part`].
const PARTS: usize = 5;

/// The part and place of a symbol in what is given; `None` for the frequency, which differs from line to line.
fn place_of(about: &About, symbol: Symbol) -> Option<(Part, usize)> {
    let state = || about.states.iter().position(|state| state.symbol == symbol);
    let input = || about.inputs.iter().position(|input| input.symbol == symbol);
    match symbol {
        Symbol::Parameter(p) => Some((Part::Parameters, p.into())),
        Symbol::Stretch(_) => Some((Part::Contact, 0)),
        Symbol::Rate(_) => Some((Part::Contact, 1)),
        Symbol::ContactForce(axis) => Some((Part::Contact, 2 + usize::from(axis))),
        _ => {
            let state = state().map(|place| (Part::States, place));
            state.or_else(|| Some((Part::Inputs, input()?)))
        }
    }
}

/// A program whose values have registers: first its numbers, then each part that it reads as a whole, since copying a
/// part costs less than looking for its entries, then the frequency, then the results in the order of the operations.
#[derive(Clone, Debug)]
struct Code {
    numbers: Vec<f64>,
    /// Where each part begins, and its length; zero for one that is not read.
    parts: [(usize, usize); PARTS],
    frequency: usize,
    operations: Vec<Op>,
    outputs: Vec<Value>,
}

impl Code {
    fn new(about: &About, program: &Program) -> Self {
        let mut lengths = [0; PARTS];
        let numbers = program.ops.iter().filter_map(|op| match op {
            Op::Constant(value) => Some(*value),
            _ => None,
        });
        let numbers: Vec<f64> = numbers.collect();
        for (part, place) in program.ops.iter().filter_map(|op| given(about, op)) {
            lengths[part as usize] = lengths[part as usize].max(place + 1);
        }
        let mut frequency = numbers.len();
        let parts = lengths.map(|length| {
            frequency += length;
            (frequency - length, length)
        });
        let mut next_number = 0..numbers.len();
        let (mut registers, mut operations) = (Vec::new(), Vec::new());
        for op in &program.ops {
            let register = match op {
                Op::Constant(_) => next_number.next().unwrap_or_default(),
                Op::Input(_) | Op::Prepared(_) => {
                    given(about, op).map_or(frequency, |(part, place)| parts[part as usize].0 + place)
                }
                _ => {
                    operations.push(op.renumbered(|value| registers[value.0 as usize]));
                    frequency + operations.len()
                }
            };
            registers.push(Value(register as u32));
        }
        let outputs = program.outputs.iter().map(|value| registers[value.0 as usize]);
        Code {
            outputs: outputs.collect(),
            numbers,
            parts,
            frequency,
            operations,
        }
    }

    /// Runs once, outputs in a row.
    fn run(&self, given: &Given, into: &mut [f64]) {
        self.with_registers::<1>(|registers| {
            self.load(given, registers);
            self.operate(registers);
            for (output, value) in into[..self.outputs.len()].iter_mut().zip(&self.outputs) {
                *output = registers[value.0 as usize][0];
            }
        });
    }

    /// Runs for every frequency. The outputs fill the slices one after the other, a row of lines each.
    fn sweep(&self, given: &Given, omega: &[f64], into: &mut [&mut [f64]]) {
        let lines = omega.len();
        self.with_registers::<BLOCK>(|registers| {
            self.load(given, registers);
            for first in (0..lines).step_by(BLOCK) {
                let block = &omega[first..lines.min(first + BLOCK)];
                registers[self.frequency] = std::array::from_fn(|lane| block[lane.min(block.len() - 1)]);
                self.operate(registers);
                let rows = into.iter_mut().flat_map(|part| part.chunks_exact_mut(lines));
                for (row, value) in rows.zip(&self.outputs) {
                    row[first..first + block.len()].copy_from_slice(&registers[value.0 as usize][..block.len()]);
                }
            }
        });
    }

    fn with_registers<const N: usize>(&self, work: impl FnOnce(&mut [[f64; N]])) {
        let registers = self.frequency + 1 + self.operations.len();
        SCRATCH.with_borrow_mut(|scratch| {
            if scratch.len() < registers * N {
                scratch.resize(registers * N, 0.0);
            }
            work(&mut scratch.as_chunks_mut::<N>().0[..registers]);
        });
    }

    fn load<const N: usize>(&self, given: &Given, registers: &mut [[f64; N]]) {
        let mut copy = |from: usize, values: &[f64]| {
            for (register, value) in registers[from..][..values.len()].iter_mut().zip(values) {
                *register = [*value; N];
            }
        };
        copy(0, &self.numbers);
        given.with_parts(|part, values| {
            let (from, length) = self.parts[part as usize];
            copy(from, &values[..length]);
        });
    }

    fn operate<const N: usize>(&self, registers: &mut [[f64; N]]) {
        for (place, &op) in self.operations.iter().enumerate() {
            let (earlier, rest) = registers.split_at_mut(self.frequency + 1 + place);
            operate(op, earlier, &mut rest[0]);
        }
    }
}

/// The part and place of a leaf in what is given.
fn given(about: &About, op: &Op) -> Option<(Part, usize)> {
    match *op {
        Op::Prepared(place) => Some((Part::Constants, place as usize)),
        Op::Input(symbol) => place_of(about, symbol),
        _ => None,
    }
}

/// One operation on a block of lanes. Leaves are loaded already.
fn operate<const N: usize>(op: Op, earlier: &[[f64; N]], into: &mut [f64; N]) {
    let of = |value: Value| &earlier[value.0 as usize];
    match op {
        Op::Constant(_) | Op::Input(_) | Op::Prepared(_) => {}
        Op::Neg(a) => one(of(a), into, |a| -a),
        Op::Call(function, a) => one(of(a), into, |a| function.value(a)),
        Op::Add(a, b) => two(of(a), of(b), into, |a, b| a + b),
        Op::Sub(a, b) => two(of(a), of(b), into, |a, b| a - b),
        Op::Mul(a, b) => two(of(a), of(b), into, |a, b| a * b),
        Op::Div(a, b) => two(of(a), of(b), into, |a, b| a / b),
        Op::Pow(a, b) => two(of(a), of(b), into, f64::powf),
        Op::Min(a, b) => two(of(a), of(b), into, f64::min),
        Op::Max(a, b) => two(of(a), of(b), into, f64::max),
        Op::Select(test, a, b) => {
            let (test, a, b) = (of(test), of(a), of(b));
            *into = std::array::from_fn(|lane| if test[lane] > 0.0 { a[lane] } else { b[lane] });
        }
    }
}

fn one<const N: usize>(a: &[f64; N], into: &mut [f64; N], f: impl Fn(f64) -> f64) {
    *into = std::array::from_fn(|lane| f(a[lane]));
}

fn two<const N: usize>(a: &[f64; N], b: &[f64; N], into: &mut [f64; N], f: impl Fn(f64, f64) -> f64) {
    *into = std::array::from_fn(|lane| f(a[lane], b[lane]));
}
