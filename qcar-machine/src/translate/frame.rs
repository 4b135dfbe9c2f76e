//! What stands around the operations of a program: where its arguments are, its place on the stack, and the loop over points.
//!
//! Six arguments come in registers, by the convention of the System V ABI for AMD64 (section 3.2): of a program at one point or for sets
//! the addresses of up to four parts, of the results, and of the numbers; of one at many points the address of the part that they share,
//! those of the rows that are read and written, the offset of the first point and that of the end, and the numbers.

use crate::assemble::{Assembler, Memory, Pointer, Width};
use crate::call::Call;
use crate::shape::Shape;
use crate::translate::Wide;
use qcar_model::LANES;

/// Bytes of a number, and of as many as the widest register holds.
const NUMBER: usize = 8;
const ROOM: usize = size_of::<Wide>();
/// Bytes of a page: the system gives the stack page by page, and each must be touched in turn.
const PAGE: usize = 4096;
/// Of the stack in a call, at most.
const LARGEST: usize = 64 * PAGE;

const GIVEN: [Pointer; 6] = [
    Pointer::RDI,
    Pointer::RSI,
    Pointer::RDX,
    Pointer::RCX,
    Pointer::R8,
    Pointer::R9,
];
/// Those that a function gives back as it found them.
const PRESERVED: [Pointer; 6] = [
    Pointer::RBX,
    Pointer::RBP,
    Pointer::R12,
    Pointer::R13,
    Pointer::R14,
    Pointer::R15,
];
/// The arguments of a program at many points, by their places.
const ROWS: usize = 1;
const ROWS_WRITTEN: usize = 2;
const OFFSET: usize = 3;
const END: usize = 4;
/// Those of the others.
const RESULTS: usize = 4;
/// The last one of both.
const NUMBERS: usize = 5;

/// Where a value stands in memory.
pub enum Place {
    /// As many numbers as an instruction works on, so that it can take them from there.
    Whole(Memory),
    /// One number that all points share.
    Shared(Memory),
}

/// How many parts a program can read by entry.
pub fn parts(shape: Shape) -> usize {
    match shape {
        Shape::Once | Shape::Sets => RESULTS,
        Shape::Points(_) => ROWS,
    }
}

/// Where everything is while a program runs.
pub struct Frame {
    shape: Shape,
    /// Where its arguments are kept.
    given: [Pointer; 6],
    calls: bool,
    /// How many numbers its instructions work on.
    pub width: Width,
    /// Of the row of arguments of its calls.
    arguments: usize,
}

impl Frame {
    /// Of a program with these calls.
    pub fn new(shape: Shape, width: Width, calls: &[Call]) -> Self {
        Frame {
            shape,
            width,
            given: if calls.is_empty() { GIVEN } else { PRESERVED },
            calls: !calls.is_empty(),
            arguments: calls.iter().map(Call::arguments).max().unwrap_or(0),
        }
    }

    /// The entry of a part.
    pub fn entry(&self, part: usize, entry: usize) -> Place {
        let own = self.given[part];
        match self.shape {
            Shape::Once => Place::Whole(at(own, NUMBER * entry)),
            Shape::Sets => Place::Whole(at(own, LANES * NUMBER * entry)),
            Shape::Points(_) => Place::Shared(at(own, NUMBER * entry)),
        }
    }

    /// The points of a row that is read.
    pub fn row(&self, body: &mut Assembler, row: usize) -> Memory {
        self.points(body, ROWS, row)
    }

    /// Where a result goes.
    pub fn output(&self, body: &mut Assembler, place: usize) -> Memory {
        match self.shape {
            Shape::Once => at(self.given[RESULTS], NUMBER * place),
            Shape::Sets => at(self.given[RESULTS], LANES * NUMBER * place),
            Shape::Points(_) => self.points(body, ROWS_WRITTEN, place),
        }
    }

    fn points(&self, body: &mut Assembler, rows: usize, row: usize) -> Memory {
        body.load_pointer(Pointer::RAX, at(self.given[rows], NUMBER * row));
        Memory {
            base: Pointer::RAX,
            index: Some(self.given[OFFSET]),
            offset: 0,
        }
    }

    /// A number of the program.
    pub fn number(&self, number: usize) -> Memory {
        at(self.given[NUMBERS], ROOM * number)
    }

    /// On the stack an argument of a call, behind the stack pointer of before.
    pub fn argument(&self, place: usize) -> Memory {
        at(Pointer::RSP, ROOM * (1 + place))
    }

    /// What a call gives.
    pub fn result(&self) -> Memory {
        self.argument(self.arguments)
    }

    /// A value that waits.
    pub fn slot(&self, slot: u32) -> Memory {
        at(
            Pointer::RSP,
            ROOM * (2 + self.arguments) + self.width.bytes() * slot as usize,
        )
    }

    /// After the last operation: again for the next points, from `start` on.
    pub fn repeat(&self, body: &mut Assembler, start: usize) {
        if let Shape::Points(_) = self.shape {
            body.add(self.given[OFFSET], self.width.bytes() as i32);
            body.repeat_while_below(self.given[OFFSET], self.given[END], start);
        }
    }

    /// The whole function; `None` where it would need too much of the stack.
    pub fn around(&self, body: Assembler, slots: u32) -> Option<Vec<u8>> {
        let needs_stack = self.calls || slots > 0;
        let bytes = ROOM * (2 + self.arguments) + self.width.bytes() * slots as usize;
        if bytes > LARGEST {
            return None;
        }
        let mut before = Assembler::default();
        if self.calls {
            PRESERVED.iter().for_each(|&own| before.push(own));
            self.given
                .iter()
                .zip(GIVEN)
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
            after.narrow();
        }
        after.ret();
        Some([before, body, after].map(Assembler::into_bytes).concat())
    }
}

/// Takes so much of the stack, at an address of whole vectors, with the stack pointer of before at its foot.
fn enter(before: &mut Assembler, bytes: usize) {
    before.copy(Pointer::RAX, Pointer::RSP);
    for _ in 0..bytes / PAGE {
        before.add(Pointer::RSP, -(PAGE as i32));
        before.touch(at(Pointer::RSP, 0));
    }
    before.add(Pointer::RSP, -((bytes % PAGE) as i32));
    before.and(Pointer::RSP, -(ROOM as i8));
    before.store_pointer(Pointer::RAX, at(Pointer::RSP, 0));
}

fn at(base: Pointer, offset: usize) -> Memory {
    Memory {
        base,
        index: None,
        offset: offset as i32,
    }
}
