//! Translates a straight-line program into machine code: each operation as its instruction, in order.

// Entry, exit and stack frame of a function.
mod frame;

use qcar_dsl::expr::Function;
use qcar_dsl::program::{Op, Program, Value};

use crate::assemble::{Arithmetic, Assembler, Bits, Comparison, Operand, Pointer, Register, Width};
use crate::call::Call;
use crate::reads::{Leaf, Reads};
use crate::shape::Shape;
use crate::values::{SCRATCH, Values};
use frame::{Frame, Place};

/// A constant as wide as the widest register; narrower registers read its beginning.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
pub struct Wide(pub [f64; 8]);

/// Constants that operations need, stored before those of the program.
const FIXED_CONSTANTS: [f64; 4] = [-0.0, f64::from_bits(!SIGN), 1.0, 0.0];
const SIGN: u64 = 1 << 63;
const SIGN_BIT: usize = 0;
const ALL_BUT_SIGN: usize = 1;
const ONE: usize = 2;
const ZERO: usize = 3;

/// The code of a program with the data that it uses.
#[derive(Debug)]
pub struct Translated {
    /// The instructions.
    pub code: Vec<u8>,
    /// Calls; the code contains the address of each.
    pub calls: Box<[Call]>,
    /// Constants of the program.
    pub constants: Box<[Wide]>,
}

/// Translates a program. `compute_call` is the address of the function that computes a [`Call`].
///
/// `None` if the program reads more parts than there are registers for addresses, or needs too much stack.
pub fn translate(
    program: &Program,
    reads: &Reads,
    (shape, width): (Shape, Width),
    compute_call: usize,
) -> Option<Translated> {
    if reads.parts.len() > frame::parts(shape) {
        return None;
    }
    let calls: Box<[Call]> = program.ops.iter().filter_map(|&op| Call::of(program, op)).collect();
    let mut writer = Writer::new(program, reads, (shape, width), &calls, compute_call);
    writer.program();
    let code = writer.frame.finish(writer.body, writer.values.slots())?;
    Some(Translated {
        code,
        constants: writer.constants.into(),
        calls,
    })
}

/// Writes the code of one program.
struct Writer<'a> {
    program: &'a Program,
    reads: &'a Reads,
    frame: Frame,
    values: Values,
    body: Assembler,
    constants: Vec<Wide>,
    /// Position of the constant of each value of the program.
    constant: Vec<Option<usize>>,
    /// Results, as sorted pairs of value and position.
    results: Vec<(Value, usize)>,
    calls: std::slice::Iter<'a, Call>,
    compute_call: usize,
}

impl<'a> Writer<'a> {
    fn new(
        program: &'a Program,
        reads: &'a Reads,
        (shape, width): (Shape, Width),
        calls: &'a [Call],
        compute_call: usize,
    ) -> Self {
        let mut constants: Vec<Wide> = FIXED_CONSTANTS.map(|number| Wide([number; 8])).into();
        let constant = program.ops.iter().map(|op| match *op {
            Op::Constant(number) => {
                constants.push(Wide([number; 8]));
                Some(constants.len() - 1)
            }
            _ => None,
        });
        let constant = constant.collect();
        let results = program.outputs.iter().enumerate();
        let mut results: Vec<(Value, usize)> = results.map(|(place, &value)| (value, place)).collect();
        results.sort_unstable();
        Writer {
            program,
            reads,
            frame: Frame::new(shape, width, calls),
            values: Values::new(program, width),
            body: Assembler::default(),
            constants,
            constant,
            results,
            calls: calls.iter(),
            compute_call,
        }
    }

    /// Writes all operations, for each group of points.
    fn program(&mut self) {
        let start = self.body.here();
        for (place, &op) in self.program.ops.iter().enumerate() {
            let value = Value(place as u32);
            self.operation(value, op);
            self.store_results(value);
            self.program
                .arguments(op)
                .chain([value])
                .for_each(|done| self.values.release(done));
        }
        self.values.evict_all().for_each(drop);
        self.frame.repeat(&mut self.body, start);
    }

    fn operation(&mut self, value: Value, op: Op) {
        match op {
            Op::Constant(_) | Op::Input(_) | Op::Prepared(_) => {}
            Op::Add(a, b) => self.commutative(Arithmetic::Add, value, a, b),
            Op::Mul(a, b) => self.commutative(Arithmetic::Mul, value, a, b),
            Op::Sub(a, b) => self.arithmetic(Arithmetic::Sub, value, a, b),
            Op::Div(a, b) => self.arithmetic(Arithmetic::Div, value, a, b),
            Op::Min(a, b) => self.min_or_max(Arithmetic::Min, value, a, b),
            Op::Max(a, b) => self.min_or_max(Arithmetic::Max, value, a, b),
            Op::Neg(a) => self.bits(Bits::Xor, value, a, SIGN_BIT),
            Op::Call(Function::Abs, a) => self.bits(Bits::And, value, a, ALL_BUT_SIGN),
            Op::Call(Function::Sign, a) => self.sign(value, a),
            Op::Call(Function::Sqrt, a) => self.square_root(value, a),
            Op::Select(test, a, b) => self.select(value, test, a, b),
            Op::Call(..) | Op::Pow(..) | Op::Table(..) => self.call(value, op),
        }
    }

    /// An operation with interchangeable operands.
    fn commutative(&mut self, what: Arithmetic, value: Value, a: Value, b: Value) {
        let swap = self.values.register(a).is_none() && self.values.register(b).is_some();
        let (a, b) = if swap { (b, a) } else { (a, b) };
        self.arithmetic(what, value, a, b);
    }

    fn arithmetic(&mut self, what: Arithmetic, value: Value, a: Value, b: Value) {
        let first = self.in_register(a);
        let second = self.operand(b);
        self.values.consume(a);
        self.values.consume(b);
        let to = self.allocate(value);
        self.body.arithmetic(what, self.width(), to, first, second);
    }

    fn square_root(&mut self, value: Value, a: Value) {
        let from = self.in_register(a);
        self.values.consume(a);
        let to = self.allocate(value);
        self.body
            .arithmetic(Arithmetic::Sqrt, self.width(), to, from, Operand::Register(from));
    }

    fn bits(&mut self, what: Bits, value: Value, a: Value, number: usize) {
        let from = self.in_register(a);
        self.values.consume(a);
        let to = self.allocate(value);
        let number = self.fixed_constant(number);
        self.body.bits(what, self.width(), to, from, number);
    }

    /// Minimum or maximum as in Rust: the other operand if one is NaN, the first if both are zero.
    fn min_or_max(&mut self, what: Arithmetic, value: Value, a: Value, b: Value) {
        let ([a, b], to) = self.with_separate_result(value, [a, b]);
        let width = self.width();
        self.body.arithmetic(what, width, to, b, Operand::Register(a));
        self.body
            .compare(Comparison::Unordered, width, SCRATCH, a, Operand::Register(a));
        self.body.blend(width, to, to, b, SCRATCH);
    }

    /// 1 with the sign of `a`; zero and NaN are unchanged.
    fn sign(&mut self, value: Value, argument: Value) {
        let a = self.in_register(argument);
        let (to, width) = (self.allocate(value), self.width());
        let [sign_bit, one, zero] = [SIGN_BIT, ONE, ZERO].map(|number| self.fixed_constant(number));
        self.body.bits(Bits::And, width, SCRATCH, a, sign_bit);
        self.body.bits(Bits::Or, width, SCRATCH, SCRATCH, one);
        self.body.compare(Comparison::EqualOrUnordered, width, to, a, zero);
        self.body.blend(width, to, SCRATCH, a, to);
        self.values.consume(argument);
    }

    fn select(&mut self, value: Value, test: Value, a: Value, b: Value) {
        let test_register = self.in_register(test);
        let zero = self.fixed_constant(ZERO);
        self.body
            .compare(Comparison::Greater, self.width(), SCRATCH, test_register, zero);
        self.values.consume(test);
        let ([a, b], to) = self.with_separate_result(value, [a, b]);
        self.body.blend(self.width(), to, b, a, SCRATCH);
    }

    /// Two operands in registers, and a register for the result that differs from both.
    fn with_separate_result(&mut self, value: Value, arguments: [Value; 2]) -> ([Register; 2], Register) {
        let registers = arguments.map(|argument| self.in_register(argument));
        let to = self.allocate(value);
        arguments.iter().for_each(|&argument| self.values.consume(argument));
        (registers, to)
    }

    /// Stores the arguments as a row in memory, and all values that are needed later.
    fn call(&mut self, value: Value, op: Op) {
        let width = self.width();
        let arguments: Vec<Value> = self.program.arguments(op).collect();
        for (place, &argument) in arguments.iter().enumerate() {
            let register = self.values.register(argument);
            let register = register.unwrap_or_else(|| self.load(argument, SCRATCH));
            self.body.store(width, register, self.frame.argument(place));
        }
        arguments.iter().for_each(|&argument| self.values.consume(argument));
        for (register, evicted) in self.values.evict_all() {
            self.spill(register, evicted);
        }
        let own = self.calls.next().map_or(0, |call| std::ptr::from_ref(call) as u64);
        self.body.set(Pointer::RDI, own);
        self.body.address(Pointer::RSI, self.frame.argument(0));
        self.body.address(Pointer::RDX, self.frame.result());
        self.body.set(Pointer::RAX, self.compute_call as u64);
        if width != Width::One {
            self.body.zero_upper();
        }
        self.body.call(Pointer::RAX);
        let to = self.allocate(value);
        self.body.load(width, to, self.frame.result());
    }

    fn store_results(&mut self, value: Value) {
        let first = self.results.partition_point(|result| result.0 < value);
        let own = self.results[first..].iter().take_while(|result| result.0 == value);
        let places: Vec<usize> = own.map(|result| result.1).collect();
        for place in places {
            let register = self.values.register(value);
            let register = register.unwrap_or_else(|| self.load(value, SCRATCH));
            let to = self.frame.output(&mut self.body, place);
            self.body.store(self.width(), register, to);
        }
    }

    fn width(&self) -> Width {
        self.frame.width
    }

    /// A register for a result or a load. Its former value, if computed and still needed, is stored in memory.
    fn allocate(&mut self, value: Value) -> Register {
        let (register, evicted) = self.values.allocate(value);
        if let Some(evicted) = evicted {
            self.spill(register, evicted);
        }
        register
    }

    /// Stores a computed value that leaves its register; a leaf is in memory already.
    fn spill(&mut self, register: Register, value: Value) {
        let is_leaf = self.program.ops[value.0 as usize].is_leaf();
        if !is_leaf && self.values.slot(value).is_none() {
            let slot = self.values.spill(value);
            self.body.store(self.width(), register, self.frame.slot(slot));
        }
    }

    fn in_register(&mut self, value: Value) -> Register {
        match self.values.register(value) {
            Some(register) => register,
            None => {
                let register = self.allocate(value);
                self.load(value, register)
            }
        }
    }

    /// An operand is read from memory if this is its last use, or if no register is free.
    fn operand(&mut self, value: Value) -> Operand {
        let is_in_memory = self.values.register(value).is_none();
        if is_in_memory
            && (self.values.is_last(value) || !self.values.has_free_register())
            && let Place::Vector(place) = self.place(value)
        {
            return Operand::Memory(place);
        }
        Operand::Register(self.in_register(value))
    }

    fn load(&mut self, value: Value, to: Register) -> Register {
        let width = self.width();
        match self.place(value) {
            Place::Vector(place) => self.body.load(width, to, place),
            Place::Broadcast(place) => self.body.broadcast(width, to, place),
        }
        to
    }

    /// Memory operand of a value that is in no register.
    fn place(&mut self, value: Value) -> Place {
        if let Some(slot) = self.values.slot(value) {
            return Place::Vector(self.frame.slot(slot));
        }
        if let Some(constant) = self.constant[value.0 as usize] {
            return Place::Vector(self.frame.constant(constant));
        }
        match self.reads.of(value) {
            Some(Leaf::Row(row)) => Place::Vector(self.frame.row(&mut self.body, row)),
            Some(Leaf::Entry { part, entry }) => self.frame.entry(part, entry),
            None => unreachable!("{value:?} is no leaf, and was not spilled"),
        }
    }

    fn fixed_constant(&self, number: usize) -> Operand {
        Operand::Memory(self.frame.constant(number))
    }
}
