//! Instructions of x86-64 as bytes.
//!
//! Intel 64 and IA-32 Architectures Software Developer's Manual, volume 2: chapter 2 has the forms of an instruction (ModRM, SIB, REX
//! and VEX), chapters 3 to 5 its opcode. Nothing beyond AVX is used, and no multiplication is fused with an addition.

/// A register for addresses, by its number.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Pointer(u8);

impl Pointer {
    pub const RAX: Pointer = Pointer(0);
    pub const RCX: Pointer = Pointer(1);
    pub const RDX: Pointer = Pointer(2);
    pub const RBX: Pointer = Pointer(3);
    pub const RSP: Pointer = Pointer(4);
    pub const RBP: Pointer = Pointer(5);
    pub const RSI: Pointer = Pointer(6);
    pub const RDI: Pointer = Pointer(7);
    pub const R8: Pointer = Pointer(8);
    pub const R9: Pointer = Pointer(9);
    pub const R12: Pointer = Pointer(12);
    pub const R13: Pointer = Pointer(13);
    pub const R14: Pointer = Pointer(14);
    pub const R15: Pointer = Pointer(15);
}

/// A register for numbers, by its number.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Register(pub u8);

/// A place in memory.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Memory {
    pub base: Pointer,
    /// Added to the base.
    pub index: Option<Pointer>,
    /// In bytes.
    pub offset: i32,
}

/// What an instruction reads last: a register or memory.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Operand {
    Register(Register),
    Memory(Memory),
}

/// How many numbers an instruction works on: one, or four.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Width {
    One,
    Four,
}

/// Arithmetic on numbers, by its opcode.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Arithmetic {
    Sqrt = 0x51,
    Add = 0x58,
    Mul = 0x59,
    Sub = 0x5c,
    /// The second where one is not a number, or both are zero.
    Min = 0x5d,
    Div = 0x5e,
    /// As `Min`.
    Max = 0x5f,
}

/// What is done to bits, by its opcode.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Bits {
    And = 0x54,
    Or = 0x56,
    Xor = 0x57,
}

/// Comparisons, by their predicate; none of them traps.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Comparison {
    /// One of both is not a number.
    Unordered = 0x03,
    EqualOrUnordered = 0x08,
    Greater = 0x1e,
}

/// The prefix that a VEX stands for.
#[derive(Clone, Copy)]
enum Prefix {
    P66 = 1,
    F2 = 3,
}

/// The table that an opcode is from.
#[derive(Clone, Copy, PartialEq)]
enum Map {
    M0F = 1,
    M0F38 = 2,
    M0F3A = 3,
}

/// Instructions one after the other.
#[derive(Default)]
pub struct Assembler {
    bytes: Vec<u8>,
}

impl Assembler {
    /// All of them.
    pub fn into_bytes(self) -> Vec<u8> {
        self.bytes
    }

    /// Where the next one stands.
    pub fn here(&self) -> usize {
        self.bytes.len()
    }

    /// Numbers from memory; a single one is followed by zeros.
    pub fn load(&mut self, width: Width, to: Register, from: Memory) {
        let prefix = one_or_four(width);
        self.vex(width, prefix, Map::M0F, 0x10, to, None, Operand::Memory(from));
    }

    /// Numbers to memory.
    pub fn store(&mut self, width: Width, from: Register, to: Memory) {
        let prefix = one_or_four(width);
        self.vex(width, prefix, Map::M0F, 0x11, from, None, Operand::Memory(to));
    }

    /// One number from memory, four times.
    pub fn broadcast(&mut self, to: Register, from: Memory) {
        self.vex(
            Width::Four,
            Prefix::P66,
            Map::M0F38,
            0x19,
            to,
            None,
            Operand::Memory(from),
        );
    }

    /// `to = a ∘ b`
    pub fn arithmetic(&mut self, what: Arithmetic, width: Width, to: Register, a: Register, b: Operand) {
        // The root of four has one operand alone.
        let a = (what != Arithmetic::Sqrt || width == Width::One).then_some(a);
        self.vex(width, one_or_four(width), Map::M0F, what as u8, to, a, b);
    }

    /// `to = a ∘ b`, bit by bit; of memory, all of a register is read.
    pub fn bits(&mut self, what: Bits, width: Width, to: Register, a: Register, b: Operand) {
        self.vex(width, Prefix::P66, Map::M0F, what as u8, to, Some(a), b);
    }

    /// All bits where `a` compares with `b` so, else none.
    pub fn compare(&mut self, what: Comparison, width: Width, to: Register, a: Register, b: Operand) {
        self.vex(width, one_or_four(width), Map::M0F, 0xc2, to, Some(a), b);
        self.bytes.push(what as u8);
    }

    /// `b` where `test` has its first bit, else `a`.
    pub fn blend(&mut self, width: Width, to: Register, a: Register, b: Register, test: Register) {
        self.vex(width, Prefix::P66, Map::M0F3A, 0x4b, to, Some(a), Operand::Register(b));
        self.bytes.push(test.0 << 4);
    }

    /// Ends the use of wide registers, which would slow down what knows narrow ones alone.
    pub fn narrow(&mut self) {
        self.bytes.extend([0xc5, 0xf8, 0x77]);
    }

    /// `to = from`
    pub fn copy(&mut self, to: Pointer, from: Pointer) {
        self.rex(0x89, from.0, Operand::Register(Register(to.0)));
    }

    /// A pointer from memory.
    pub fn load_pointer(&mut self, to: Pointer, from: Memory) {
        self.rex(0x8b, to.0, Operand::Memory(from));
    }

    /// A pointer to memory.
    pub fn store_pointer(&mut self, from: Pointer, to: Memory) {
        self.rex(0x89, from.0, Operand::Memory(to));
    }

    /// Where a place in memory is.
    pub fn address(&mut self, to: Pointer, of: Memory) {
        self.rex(0x8d, to.0, Operand::Memory(of));
    }

    /// `to += number`
    pub fn add(&mut self, to: Pointer, number: i32) {
        self.address(
            to,
            Memory {
                base: to,
                index: None,
                offset: number,
            },
        );
    }

    /// `to &= number`
    pub fn and(&mut self, to: Pointer, number: i8) {
        self.rex(0x83, 4, Operand::Register(Register(to.0)));
        self.bytes.push(number as u8);
    }

    /// `to = number`
    pub fn set(&mut self, to: Pointer, number: u64) {
        self.bytes.extend([0x48 | to.0 >> 3, 0xb8 | to.0 & 7]);
        self.bytes.extend(number.to_le_bytes());
    }

    /// Puts a register on the stack.
    pub fn push(&mut self, from: Pointer) {
        self.bytes.extend([0x40 | from.0 >> 3, 0x50 | from.0 & 7]);
    }

    /// Takes one from there.
    pub fn pop(&mut self, to: Pointer) {
        self.bytes.extend([0x40 | to.0 >> 3, 0x58 | to.0 & 7]);
    }

    /// Writes to memory what stands there already, so that the system finds room for it.
    pub fn touch(&mut self, place: Memory) {
        self.rex(0x83, 1, Operand::Memory(place));
        self.bytes.push(0);
    }

    /// Goes on at an earlier place while `a < b`.
    pub fn repeat_while_below(&mut self, a: Pointer, b: Pointer, from: usize) {
        self.rex(0x39, b.0, Operand::Register(Register(a.0)));
        self.bytes.extend([0x0f, 0x82]);
        let back = from as i64 - (self.here() as i64 + 4);
        self.bytes.extend((back as i32).to_le_bytes());
    }

    /// Calls what a register points to.
    pub fn call(&mut self, target: Pointer) {
        self.bytes.extend([0x40 | target.0 >> 3, 0xff, 0xd0 | target.0 & 7]);
    }

    /// Goes back to the caller.
    pub fn ret(&mut self) {
        self.bytes.push(0xc3);
    }

    #[allow(clippy::too_many_arguments, reason = "these are the fields of the instruction")]
    fn vex(
        &mut self,
        width: Width,
        prefix: Prefix,
        map: Map,
        opcode: u8,
        reg: Register,
        a: Option<Register>,
        b: Operand,
    ) {
        let (index, base) = high_bits(b);
        // The fields of registers are kept inverted.
        let inverted = !a.map_or(0, |a| a.0) & 15;
        let last = inverted << 3 | u8::from(width == Width::Four) << 2 | prefix as u8;
        let reg_bit = (!reg.0 >> 3 & 1) << 7;
        if map == Map::M0F && index == 0 && base == 0 {
            self.bytes.extend([0xc5, reg_bit | last, opcode]);
        } else {
            let first = reg_bit | (index ^ 1) << 6 | (base ^ 1) << 5 | map as u8;
            self.bytes.extend([0xc4, first, last, opcode]);
        }
        self.operands(reg.0, b);
    }

    /// An instruction on pointers.
    fn rex(&mut self, opcode: u8, reg: u8, b: Operand) {
        let (index, base) = high_bits(b);
        self.bytes.extend([0x48 | reg >> 3 << 2 | index << 1 | base, opcode]);
        self.operands(reg, b);
    }

    /// ModRM, SIB and displacement.
    fn operands(&mut self, reg: u8, b: Operand) {
        let reg = (reg & 7) << 3;
        let memory = match b {
            Operand::Register(Register(b)) => return self.bytes.push(0xc0 | reg | b & 7),
            Operand::Memory(memory) => memory,
        };
        let short = i8::try_from(memory.offset);
        let form = if short.is_ok() { 0x40 } else { 0x80 };
        let base = memory.base.0 & 7;
        // The stack pointer and its neighbour R12 stand for "see the next byte", and there for "no index".
        match memory.index {
            None if base != 4 => self.bytes.push(form | reg | base),
            index => {
                let index = index.map_or(4, |index| index.0 & 7);
                self.bytes.extend([form | reg | 4, index << 3 | base]);
            }
        }
        match short {
            Ok(short) => self.bytes.push(short as u8),
            Err(_) => self.bytes.extend(memory.offset.to_le_bytes()),
        }
    }
}

/// The fourth bits of index and base.
fn high_bits(b: Operand) -> (u8, u8) {
    match b {
        Operand::Register(Register(b)) => (0, b >> 3),
        Operand::Memory(memory) => (memory.index.map_or(0, |index| index.0 >> 3), memory.base.0 >> 3),
    }
}

fn one_or_four(width: Width) -> Prefix {
    match width {
        Width::One => Prefix::F2,
        Width::Four => Prefix::P66,
    }
}
