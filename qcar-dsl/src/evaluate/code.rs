//! A program with its values in registers, interpreted at one point or at many.
//!
//! Many points are computed in blocks, so that the interpretation of an operation is paid once a block. Nothing is
//! allocated in a call but a thread's scratch space, once.

use std::cell::RefCell;

use crate::about::About;
use crate::expr::Symbol;
use crate::program::{Op, Program, Value};

/// Points that are computed together: enough to hide the interpretation of an operation, and few enough that the values
/// of a whole program stay close to the processor.
const BLOCK: usize = 16;

thread_local! {
    static SCRATCH: RefCell<Vec<f64>> = const { RefCell::new(Vec::new()) };
}

/// What the leaves of a program are read from.
#[derive(Clone, Copy, Default)]
pub struct Given<'a> {
    pub p: &'a [f64],
    pub constants: &'a [f64],
    pub x: &'a [f64],
    pub u: &'a [f64],
    /// Stretch, rate and forces of a rolling tyre.
    pub contact: &'a [f64],
    pub omega: &'a [f64],
}

/// What is given to a program, in the order in which it stands in the registers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Part {
    Parameters,
    Constants,
    States,
    Inputs,
    Contact,
    Frequency,
}

const PARTS: [Part; 6] = [
    Part::Parameters,
    Part::Constants,
    Part::States,
    Part::Inputs,
    Part::Contact,
    Part::Frequency,
];

impl<'a> Given<'a> {
    fn part(&self, part: Part) -> &'a [f64] {
        match part {
            Part::Parameters => self.p,
            Part::Constants => self.constants,
            Part::States => self.x,
            Part::Inputs => self.u,
            Part::Contact => self.contact,
            Part::Frequency => self.omega,
        }
    }
}

/// A part of what is given, of which a program reads `length` entries into the registers from `first`.
#[derive(Clone, Copy, Debug)]
struct Read {
    part: Part,
    first: usize,
    length: usize,
}

/// A program whose values have registers: first its numbers, then each part that it reads as a whole, since copying a
/// part costs less than looking for its entries, then the results in the order of the operations.
#[derive(Clone, Debug)]
pub struct Code {
    numbers: Vec<f64>,
    /// The parts that are read at all.
    reads: Vec<Read>,
    /// The register of the first result.
    results: usize,
    operations: Vec<Op>,
    outputs: Vec<Value>,
}

impl Code {
    /// Gives every value of a program its register.
    pub fn new(about: &About, program: &Program) -> Self {
        let numbers = program.ops.iter().filter_map(|op| match op {
            Op::Constant(value) => Some(*value),
            _ => None,
        });
        let numbers: Vec<f64> = numbers.collect();
        let mut results = numbers.len();
        let reads = PARTS.map(|part| {
            let leaves = program.ops.iter().filter_map(|op| given(about, op));
            let places = leaves.filter(|leaf| leaf.0 == part).map(|(_, place)| place + 1);
            let (first, length) = (results, places.max().unwrap_or(0));
            results += length;
            Read { part, first, length }
        });
        let mut next_number = 0..numbers.len();
        let (mut registers, mut operations) = (Vec::new(), Vec::new());
        for op in &program.ops {
            let register = match (op, given(about, op)) {
                (Op::Constant(_), _) => next_number.next().unwrap_or_default(),
                (_, Some((part, place))) => reads[part as usize].first + place,
                _ => {
                    operations.push(op.renumbered(|value| registers[value.0 as usize]));
                    results + operations.len() - 1
                }
            };
            registers.push(Value(register as u32));
        }
        let outputs = program.outputs.iter().map(|value| registers[value.0 as usize]);
        Code {
            outputs: outputs.collect(),
            numbers,
            reads: reads.into_iter().filter(|read| read.length > 0).collect(),
            results,
            operations,
        }
    }

    /// Runs once, outputs in a row.
    pub fn run(&self, given: &Given, into: &mut [f64]) {
        self.with_registers::<1>(|registers| {
            self.load(given, &[], registers);
            self.operate(registers);
            for (output, value) in into[..self.outputs.len()].iter_mut().zip(&self.outputs) {
                *output = registers[value.0 as usize][0];
            }
        });
    }

    /// Runs at many points, from one to the next of which some parts vary: these have a row of points for each of their
    /// entries. The outputs fill the slices one after the other, a row of points each.
    ///
    /// Where a block is not full, what earlier work left in its other lanes is computed along, and read by nobody.
    pub fn sweep(&self, given: &Given, varying: &[Part], points: usize, into: &mut [&mut [f64]]) {
        self.with_registers::<BLOCK>(|registers| {
            self.load(given, varying, registers);
            for first in (0..points).step_by(BLOCK) {
                let block = BLOCK.min(points - first);
                for read in self.reads.iter().filter(|read| varying.contains(&read.part)) {
                    let rows = given.part(read.part).chunks_exact(points);
                    for (register, row) in registers[read.first..][..read.length].iter_mut().zip(rows) {
                        register[..block].copy_from_slice(&row[first..first + block]);
                    }
                }
                self.operate(registers);
                let rows = into.iter_mut().flat_map(|part| part.chunks_exact_mut(points));
                for (row, value) in rows.zip(&self.outputs) {
                    row[first..first + block].copy_from_slice(&registers[value.0 as usize][..block]);
                }
            }
        });
    }

    fn with_registers<const N: usize>(&self, work: impl FnOnce(&mut [[f64; N]])) {
        let registers = self.results + self.operations.len();
        SCRATCH.with_borrow_mut(|scratch| {
            if scratch.len() < registers * N {
                scratch.resize(registers * N, 0.0);
            }
            work(&mut scratch.as_chunks_mut::<N>().0[..registers]);
        });
    }

    /// The numbers, and the parts that do not vary.
    fn load<const N: usize>(&self, given: &Given, varying: &[Part], registers: &mut [[f64; N]]) {
        let mut copy = |first: usize, values: &[f64]| {
            for (register, value) in registers[first..][..values.len()].iter_mut().zip(values) {
                *register = [*value; N];
            }
        };
        copy(0, &self.numbers);
        for read in self.reads.iter().filter(|read| !varying.contains(&read.part)) {
            copy(read.first, &given.part(read.part)[..read.length]);
        }
    }

    fn operate<const N: usize>(&self, registers: &mut [[f64; N]]) {
        for (place, &op) in self.operations.iter().enumerate() {
            let (earlier, rest) = registers.split_at_mut(self.results + place);
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

/// The part and place of a symbol in what is given.
fn place_of(about: &About, symbol: Symbol) -> Option<(Part, usize)> {
    let state = || about.states.iter().position(|state| state.symbol == symbol);
    let input = || about.inputs.iter().position(|input| input.symbol == symbol);
    match symbol {
        Symbol::Frequency => Some((Part::Frequency, 0)),
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
