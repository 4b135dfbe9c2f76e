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

/// Where a leaf is read.
#[derive(Clone, Copy, Debug)]
enum Leaf {
    Number(f64),
    Parameter(usize),
    Constant(usize),
    State(usize),
    Input(usize),
    Stretch,
    Rate,
    ContactForce(usize),
}

impl Leaf {
    /// The place of a symbol in the vectors; `None` for the frequency, which differs from line to line.
    fn of(about: &About, symbol: Symbol) -> Option<Leaf> {
        let state = || {
            about
                .states
                .iter()
                .position(|state| state.symbol == symbol)
                .map(Leaf::State)
        };
        let input = || {
            about
                .inputs
                .iter()
                .position(|input| input.symbol == symbol)
                .map(Leaf::Input)
        };
        match symbol {
            Symbol::Parameter(p) => Some(Leaf::Parameter(p.into())),
            Symbol::Stretch(_) => Some(Leaf::Stretch),
            Symbol::Rate(_) => Some(Leaf::Rate),
            Symbol::ContactForce(axis) => Some(Leaf::ContactForce(axis.into())),
            _ => state().or_else(input),
        }
    }

    fn read(self, given: &Given) -> f64 {
        match self {
            Leaf::Number(value) => value,
            Leaf::Parameter(place) => given.p[place],
            Leaf::Constant(place) => given.constants[place],
            Leaf::State(place) => given.x[place],
            Leaf::Input(place) => given.u[place],
            Leaf::Stretch => given.contact.s,
            Leaf::Rate => given.contact.v,
            Leaf::ContactForce(axis) => given.contact.force[axis],
        }
    }
}

/// A program whose leaves know where they are read. A value stands in the register of its number.
#[derive(Clone, Debug)]
struct Code {
    leaves: Vec<(usize, Leaf)>,
    frequencies: Vec<usize>,
    operations: Vec<(usize, Op)>,
    outputs: Vec<Value>,
    registers: usize,
}

impl Code {
    fn new(about: &About, program: &Program) -> Self {
        let (mut leaves, mut frequencies, mut operations) = (Vec::new(), Vec::new(), Vec::new());
        for (register, &op) in program.ops.iter().enumerate() {
            match op {
                Op::Constant(value) => leaves.push((register, Leaf::Number(value))),
                Op::Prepared(place) => leaves.push((register, Leaf::Constant(place as usize))),
                Op::Input(symbol) => match Leaf::of(about, symbol) {
                    Some(leaf) => leaves.push((register, leaf)),
                    None => frequencies.push(register),
                },
                _ => operations.push((register, op)),
            }
        }
        let outputs = program.outputs.clone();
        Code {
            leaves,
            frequencies,
            operations,
            outputs,
            registers: program.ops.len(),
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
                for &register in &self.frequencies {
                    registers[register] = std::array::from_fn(|lane| block[lane.min(block.len() - 1)]);
                }
                self.operate(registers);
                let rows = into.iter_mut().flat_map(|part| part.chunks_exact_mut(lines));
                for (row, value) in rows.zip(&self.outputs) {
                    row[first..first + block.len()].copy_from_slice(&registers[value.0 as usize][..block.len()]);
                }
            }
        });
    }

    fn with_registers<const N: usize>(&self, work: impl FnOnce(&mut [[f64; N]])) {
        SCRATCH.with_borrow_mut(|scratch| {
            if scratch.len() < self.registers * N {
                scratch.resize(self.registers * N, 0.0);
            }
            work(&mut scratch.as_chunks_mut::<N>().0[..self.registers]);
        });
    }

    fn load<const N: usize>(&self, given: &Given, registers: &mut [[f64; N]]) {
        for &(register, leaf) in &self.leaves {
            registers[register] = [leaf.read(given); N];
        }
    }

    fn operate<const N: usize>(&self, registers: &mut [[f64; N]]) {
        for &(register, op) in &self.operations {
            let (earlier, rest) = registers.split_at_mut(register);
            operate(op, earlier, &mut rest[0]);
        }
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
