//! Code around the operations of a program: arguments, stack frame, and the loop over points.
//!
//! Six arguments are passed in registers, by the convention of the System V ABI for AMD64 (section 3.2). For one point
//! or for sets they are the addresses of up to four parts, of the results, and of the constants; for many points, the
//! address of the shared part, those of the rows that are read and written, the offsets of the first point and of the
//! end, and the constants.

use crate::assemble::{Assembler, Memory, Pointer, Width};
use crate::call::Call;
use crate::shape::Shape;
use crate::translate::Wide;
use qcar_model::LANES;

/// Bytes of a number.
const NUMBER_BYTES: usize = 8;
/// Bytes of the widest register.
const VECTOR_BYTES: usize = size_of::<Wide>();
/// Bytes of a page: the system maps the stack page by page, and each must be accessed in turn.
const PAGE: usize = 4096;
/// Largest stack frame of a call.
const MAX_FRAME_BYTES: usize = 64 * PAGE;

const ARGUMENTS: [Pointer; 6] = [
    Pointer::RDI,
    Pointer::RSI,
    Pointer::RDX,
    Pointer::RCX,
    Pointer::R8,
    Pointer::R9,
];
/// Registers that a function must preserve.
const PRESERVED: [Pointer; 6] = [
    Pointer::RBX,
    Pointer::RBP,
    Pointer::R12,
    Pointer::R13,
    Pointer::R14,
    Pointer::R15,
];
/// Arguments of a program at many points, by position.
const ROWS: usize = 1;
const ROWS_WRITTEN: usize = 2;
const OFFSET: usize = 3;
const END: usize = 4;
/// Arguments of the other shapes.
const RESULTS: usize = 4;
/// The last argument of both.
const CONSTANTS: usize = 5;

/// Memory operand of a value.
pub enum Place {
    /// All numbers of a vector, which an instruction can read directly.
    Vector(Memory),
    /// One number that all points share; it is loaded into every lane.
    Broadcast(Memory),
}

/// Largest number of parts that a program can read entry by entry.
pub fn parts(shape: Shape) -> usize {
    match shape {
        Shape::Single | Shape::Sets => RESULTS,
        Shape::Points(_) => ROWS,
    }
}

/// Locations of all data while a program runs.
pub struct Frame {
    shape: Shape,
    /// Registers of the arguments.
    arguments: [Pointer; 6],
    calls: bool,
    /// Number of values in a vector.
    pub width: Width,
    /// Position of the arguments of calls on the stack.
    call_arguments: usize,
}

impl Frame {
    /// The frame of a program with these calls.
    pub fn new(shape: Shape, width: Width, calls: &[Call]) -> Self {
        Frame {
            shape,
            width,
            arguments: if calls.is_empty() { ARGUMENTS } else { PRESERVED },
            calls: !calls.is_empty(),
            call_arguments: calls.iter().map(Call::arguments).max().unwrap_or(0),
        }
    }

    /// An entry of a part.
    pub fn entry(&self, part: usize, entry: usize) -> Place {
        let own = self.arguments[part];
        match self.shape {
            Shape::Single => Place::Vector(at(own, NUMBER_BYTES * entry)),
            Shape::Sets => Place::Vector(at(own, LANES * NUMBER_BYTES * entry)),
            Shape::Points(_) => Place::Broadcast(at(own, NUMBER_BYTES * entry)),
        }
    }

    /// The points of a row.
    pub fn row(&self, body: &mut Assembler, row: usize) -> Memory {
        self.points(body, ROWS, row)
    }

    /// Destination of a result.
    pub fn output(&self, body: &mut Assembler, place: usize) -> Memory {
        match self.shape {
            Shape::Single => at(self.arguments[RESULTS], NUMBER_BYTES * place),
            Shape::Sets => at(self.arguments[RESULTS], LANES * NUMBER_BYTES * place),
            Shape::Points(_) => self.points(body, ROWS_WRITTEN, place),
        }
    }

    fn points(&self, body: &mut Assembler, rows: usize, row: usize) -> Memory {
        body.load_pointer(Pointer::RAX, at(self.arguments[rows], NUMBER_BYTES * row));
        Memory {
            base: Pointer::RAX,
            index: Some(self.arguments[OFFSET]),
            offset: 0,
        }
    }

    /// A constant of the program.
    pub fn constant(&self, place: usize) -> Memory {
        at(self.arguments[CONSTANTS], VECTOR_BYTES * place)
    }

    /// Position of an argument of a call on the stack, after the previous stack pointer.
    pub fn argument(&self, place: usize) -> Memory {
        at(Pointer::RSP, VECTOR_BYTES * (1 + place))
    }

    /// Result of a call.
    pub fn result(&self) -> Memory {
        self.argument(self.call_arguments)
    }

    /// A spilled value.
    pub fn slot(&self, slot: u32) -> Memory {
        at(
            Pointer::RSP,
            VECTOR_BYTES * (2 + self.call_arguments) + self.width.bytes() * slot as usize,
        )
    }

    /// After the last operation: continues with the next points, at `start`.
    pub fn repeat(&self, body: &mut Assembler, start: usize) {
        if let Shape::Points(_) = self.shape {
            body.add(self.arguments[OFFSET], self.width.bytes() as i32);
            body.jump_back_while_below(self.arguments[OFFSET], self.arguments[END], start);
        }
    }

    /// The complete function; `None` if it would need too much stack.
    pub fn finish(&self, body: Assembler, slots: u32) -> Option<Vec<u8>> {
        let needs_stack = self.calls || slots > 0;
        let bytes = VECTOR_BYTES * (2 + self.call_arguments) + self.width.bytes() * slots as usize;
        if bytes > MAX_FRAME_BYTES {
            return None;
        }
        let mut before = Assembler::default();
        if self.calls {
            PRESERVED.iter().for_each(|&own| before.push(own));
            self.arguments
                .iter()
                .zip(ARGUMENTS)
                .for_each(|(&to, from)| before.copy(to, from));
        }
        if needs_stack {
            enter(&mut before, bytes);
        }
        let mut after = Assembler::default();
        if needs_stack {
            after.load_pointer(Pointer::RSP, at(Pointer::RSP, 0));
        }
        if self.calls {
            PRESERVED.iter().rev().for_each(|&own| after.pop(own));
        }
        if self.width != Width::One {
            after.zero_upper();
        }
        after.ret();
        Some([before, body, after].map(Assembler::into_bytes).concat())
    }
}

/// Allocates stack at an address aligned to vectors, with the previous stack pointer at its lower end.
fn enter(before: &mut Assembler, bytes: usize) {
    before.copy(Pointer::RAX, Pointer::RSP);
    for _ in 0..bytes / PAGE {
        before.add(Pointer::RSP, -(PAGE as i32));
        before.probe(at(Pointer::RSP, 0));
    }
    before.add(Pointer::RSP, -((bytes % PAGE) as i32));
    before.and(Pointer::RSP, -(VECTOR_BYTES as i8));
    before.store_pointer(Pointer::RAX, at(Pointer::RSP, 0));
}

fn at(base: Pointer, offset: usize) -> Memory {
    Memory {
        base,
        index: None,
        offset: offset as i32,
    }
}
