//! A program with its values in registers, interpreted at one point or at many.
//!
//! Operations of one kind are interpreted one after another, and points in blocks, so that each decision about what to
//! do serves many of them. A call allocates nothing, except the scratch space of a thread at its first call.

use std::cell::{Cell, RefCell};

use qcar_model::{LANES, Lanes};

use super::arguments::{self, Arguments, Part, ReadEntries};
use super::order;
use crate::derive::vectors::Vectors;
use crate::expr::Curve;
use crate::program::{Op, Program};

/// Number of points that are computed together: enough to make the cost of interpreting an operation small, and few
/// enough that the values of a whole program stay in the cache.
const BLOCK: usize = 16;

thread_local! {
    static SCRATCH: RefCell<Vec<f64>> = const { RefCell::new(Vec::new()) };
}

/// Operations of one kind, each given by the registers that it reads. They write to consecutive registers.
#[derive(Clone, Debug)]
struct Run {
    kind: Op,
    arguments: Vec<[u32; 3]>,
}

impl Run {
    fn new(run: &order::Run, program: &Program, registers: &[u32]) -> Self {
        let operations = run.places.iter().map(|&place| program.ops[place]);
        let arguments = operations.map(|op| {
            let mut registers = program.arguments(op).map(|value| registers[value.0 as usize]);
            // Operations with fewer than three arguments never read the other entries.
            std::array::from_fn(|_| registers.next().unwrap_or_default())
        });
        Run {
            kind: run.kind,
            arguments: arguments.collect(),
        }
    }
}

/// A program whose values have registers: first its leaves, then its numbers, then the results in the order in which
/// they are computed.
#[derive(Clone, Debug)]
pub struct Code {
    reads: Vec<ReadEntries>,
    numbers: Vec<f64>,
    /// The register of the first number.
    first_number: usize,
    runs: Vec<Run>,
    /// The curves of tables, by the registers of their entries.
    curves: Vec<Curve<u32>>,
    /// Number of registers.
    registers: usize,
    outputs: Vec<u32>,
}

impl Code {
    /// Assigns a register to every value of a program.
    pub fn new(vectors: &Vectors, program: &Program) -> Self {
        let reads = arguments::reads(vectors, program);
        let first_number = reads.last().map_or(0, |read| read.registers().end);
        let mut numbers = Vec::new();
        let leaves = program.ops.iter().map(|op| match *op {
            Op::Constant(number) => {
                numbers.push(number);
                first_number + numbers.len() - 1
            }
            _ => arguments::register(vectors, &reads, op).unwrap_or_default(),
        });
        let mut registers: Vec<u32> = leaves.map(|register| register as u32).collect();
        let runs = order::runs(program);
        let mut next = first_number + numbers.len();
        for &place in runs.iter().flat_map(|run| &run.places) {
            registers[place] = next as u32;
            next += 1;
        }
        let outputs = program.outputs.iter().map(|value| registers[value.0 as usize]);
        let curves = program.curves.iter();
        Code {
            curves: curves
                .map(|curve| curve.map(|value| registers[value.0 as usize]))
                .collect(),
            runs: runs.iter().map(|run| Run::new(run, program, &registers)).collect(),
            outputs: outputs.collect(),
            reads,
            numbers,
            first_number,
            registers: next,
        }
    }

    /// Runs the program once; `into` receives the outputs.
    pub fn run(&self, given: &Arguments, into: &mut [f64]) {
        self.with_registers::<1>(|registers| {
            self.load(given, &[], registers);
            self.operate(registers);
            for (output, &register) in into[..self.outputs.len()].iter_mut().zip(&self.outputs) {
                *output = registers[register as usize][0];
            }
        });
    }

    /// Runs the program at many points. The `varying` parts have a row of points for each of their entries; the other
    /// parts are the same at all points. The outputs fill the slices of `into` one after another, with a row of points
    /// each.
    ///
    /// In a block that is not full, the unused lanes contain old values. They are computed too, but their results are
    /// not read.
    pub fn sweep(&self, given: &Arguments, varying: &[Part], points: usize, into: &mut [&mut [f64]]) {
        self.with_registers::<BLOCK>(|registers| {
            self.load(given, varying, registers);
            for first in (0..points).step_by(BLOCK) {
                let block = BLOCK.min(points - first);
                for read in self.reads.iter().filter(|read| varying.contains(&read.part)) {
                    let rows = given.part(read.part);
                    for (register, &entry) in registers[read.registers()].iter_mut().zip(&read.entries) {
                        register[..block].copy_from_slice(&rows[entry * points + first..][..block]);
                    }
                }
                self.operate(registers);
                let rows = into.iter_mut().flat_map(|part| part.chunks_exact_mut(points));
                for (row, &register) in rows.zip(&self.outputs) {
                    row[first..first + block].copy_from_slice(&registers[register as usize][..block]);
                }
            }
        });
    }

    /// Runs the program for several parameter sets at once; each row has one value for each set.
    pub fn sets(&self, given: &[(Part, &[Lanes])], into: &mut [Lanes]) {
        self.with_registers::<LANES>(|registers| {
            for read in &self.reads {
                let rows = given
                    .iter()
                    .find(|(part, _)| *part == read.part)
                    .map_or(&[][..], |own| own.1);
                for (register, &entry) in registers[read.registers()].iter_mut().zip(&read.entries) {
                    *register = rows[entry];
                }
            }
            self.load_numbers(registers);
            self.operate(registers);
            for (output, &register) in into[..self.outputs.len()].iter_mut().zip(&self.outputs) {
                *output = registers[register as usize];
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

    /// Loads the numbers, and the parts that do not vary.
    fn load<const N: usize>(&self, given: &Arguments, varying: &[Part], registers: &mut [[f64; N]]) {
        for read in self.reads.iter().filter(|read| !varying.contains(&read.part)) {
            let values = given.part(read.part);
            for (register, &entry) in registers[read.registers()].iter_mut().zip(&read.entries) {
                *register = [values[entry]; N];
            }
        }
        self.load_numbers(registers);
    }

    fn load_numbers<const N: usize>(&self, registers: &mut [[f64; N]]) {
        for (register, &number) in registers[self.first_number..].iter_mut().zip(&self.numbers) {
            *register = [number; N];
        }
    }

    fn operate<const N: usize>(&self, registers: &mut [[f64; N]]) {
        // Cells, since an operation may read the result of an earlier one in the same run.
        let registers = Cell::from_mut(registers).as_slice_of_cells();
        let mut results = &registers[self.first_number + self.numbers.len()..];
        for run in &self.runs {
            let work = BlockRun {
                arguments: &run.arguments,
                registers,
                curves: &self.curves,
                results,
            };
            work.operate(run.kind);
            results = &results[run.arguments.len()..];
        }
    }
}

/// A run of operations, with the registers of a block of lanes.
struct BlockRun<'a, const N: usize> {
    arguments: &'a [[u32; 3]],
    registers: &'a [Cell<[f64; N]>],
    curves: &'a [Curve<u32>],
    /// The registers from the first result on.
    results: &'a [Cell<[f64; N]>],
}

impl<const N: usize> BlockRun<'_, N> {
    fn operate(self, kind: Op) {
        match kind {
            Op::Constant(_) | Op::Input(_) | Op::Prepared(_) => {}
            Op::Neg(_) => self.one(|a| -a),
            Op::Call(function, _) => self.one(|a| function.value(a)),
            Op::Add(..) => self.two(|a, b| a + b),
            Op::Sub(..) => self.two(|a, b| a - b),
            Op::Mul(..) => self.two(|a, b| a * b),
            Op::Div(..) => self.two(|a, b| a / b),
            Op::Pow(..) => self.two(f64::powf),
            Op::Min(..) => self.two(f64::min),
            Op::Max(..) => self.two(f64::max),
            Op::Select(..) => self.three(|test, a, b| if test > 0.0 { a } else { b }),
            Op::Table(order, _, curve) => self.table(order, &self.curves[curve as usize]),
        }
    }

    fn table(&self, order: u8, curve: &Curve<u32>) {
        for (result, &[x, ..]) in self.results.iter().zip(self.arguments) {
            let x = self.register(x);
            result.set(std::array::from_fn(|lane| {
                curve.at(order, x[lane], |&entry| self.register(entry)[lane])
            }));
        }
    }

    fn one(self, f: impl Fn(f64) -> f64) {
        for (result, &[a, ..]) in self.results.iter().zip(self.arguments) {
            let a = self.register(a);
            result.set(std::array::from_fn(|lane| f(a[lane])));
        }
    }

    fn two(self, f: impl Fn(f64, f64) -> f64) {
        for (result, &[a, b, _]) in self.results.iter().zip(self.arguments) {
            let (a, b) = (self.register(a), self.register(b));
            result.set(std::array::from_fn(|lane| f(a[lane], b[lane])));
        }
    }

    fn three(self, f: impl Fn(f64, f64, f64) -> f64) {
        for (result, &[a, b, c]) in self.results.iter().zip(self.arguments) {
            let (a, b, c) = (self.register(a), self.register(b), self.register(c));
            result.set(std::array::from_fn(|lane| f(a[lane], b[lane], c[lane])));
        }
    }

    fn register(&self, place: u32) -> [f64; N] {
        self.registers[place as usize].get()
    }
}
