//! Encoding of x86-64 instructions.
//!
//! Intel 64 and IA-32 Architectures Software Developer's Manual, volume 2: chapter 2 has the forms of an instruction
//! (ModRM, SIB, REX, VEX and EVEX), chapters 3 to 5 its opcode. One or four numbers need AVX, eight AVX-512 with its
//! part DQ. No multiplication is fused with an addition.

/// A register for addresses, by number.
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

/// A register for numbers, by number.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Register(pub u8);

/// An address in memory.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Memory {
    pub base: Pointer,
    /// Index register, added to the base.
    pub index: Option<Pointer>,
    /// Displacement, bytes.
    pub offset: i32,
}

/// Last operand of an instruction: a register or memory.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Operand {
    Register(Register),
    Memory(Memory),
}

/// Number of values in a vector.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Width {
    One = 1,
    Four = 4,
    Eight = 8,
}

impl Width {
    /// As a number.
    pub fn numbers(self) -> usize {
        self as usize
    }

    /// Bytes of a vector.
    pub fn bytes(self) -> usize {
        size_of::<f64>() * self.numbers()
    }
}

/// Arithmetic on numbers, by its opcode.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Arithmetic {
    Sqrt = 0x51,
    Add = 0x58,
    Mul = 0x59,
    Sub = 0x5c,
    /// Minimum; the second operand if one is NaN, or if both are zero.
    Min = 0x5d,
    Div = 0x5e,
    /// As `Min`.
    Max = 0x5f,
}

/// Bit operations, by opcode.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Bits {
    And = 0x54,
    Or = 0x56,
    Xor = 0x57,
}

/// Comparisons, by their predicate; none of them traps.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Comparison {
    /// True if one operand is NaN.
    Unordered = 0x03,
    EqualOrUnordered = 0x08,
    Greater = 0x1e,
}

/// Prefix of an instruction in VEX or EVEX form.
#[derive(Clone, Copy)]
enum Prefix {
    P66 = 1,
    F2 = 3,
}

/// Opcode map.
#[derive(Clone, Copy, PartialEq)]
enum Map {
    M0F = 1,
    M0F38 = 2,
    M0F3A = 3,
}

/// Mask register for comparisons of eight numbers.
const MASK: u8 = 1;
/// No mask.
const ALL: u8 = 0;

/// A sequence of instructions.
#[derive(Default)]
pub struct Assembler {
    bytes: Vec<u8>,
}

impl Assembler {
    /// The bytes.
    pub fn into_bytes(self) -> Vec<u8> {
        self.bytes
    }

    /// Position of the next instruction.
    pub fn here(&self) -> usize {
        self.bytes.len()
    }

    /// Loads numbers from memory; a single one is followed by zeros.
    pub fn load(&mut self, width: Width, to: Register, from: Memory) {
        self.vector(
            width,
            one_or_more(width),
            (Map::M0F, 0x10),
            to,
            None,
            Operand::Memory(from),
        );
    }

    /// Stores numbers to memory.
    pub fn store(&mut self, width: Width, from: Register, to: Memory) {
        self.vector(
            width,
            one_or_more(width),
            (Map::M0F, 0x11),
            from,
            None,
            Operand::Memory(to),
        );
    }

    /// Loads one number from memory into four or eight lanes.
    pub fn broadcast(&mut self, width: Width, to: Register, from: Memory) {
        let (opcode, from) = ((Map::M0F38, 0x19), Operand::Memory(from));
        match width {
            Width::Eight => self.evex(Width::One, ALL, opcode, to, None, from),
            Width::One | Width::Four => self.vex(Width::Four, Prefix::P66, opcode, to, None, from),
        }
    }

    /// `to = a ∘ b`
    pub fn arithmetic(&mut self, what: Arithmetic, width: Width, to: Register, a: Register, b: Operand) {
        // The square root of a vector has only one operand.
        let a = (what != Arithmetic::Sqrt || width == Width::One).then_some(a);
        self.vector(width, one_or_more(width), (Map::M0F, what as u8), to, a, b);
    }

    /// `to = a ∘ b`, bitwise; a memory operand is read as a whole register.
    pub fn bits(&mut self, what: Bits, width: Width, to: Register, a: Register, b: Operand) {
        self.vector(width, Prefix::P66, (Map::M0F, what as u8), to, Some(a), b);
    }

    /// Sets all bits of lanes in which the comparison of `a` and `b` holds, none elsewhere. For eight numbers the
    /// result is in the [`MASK`] instead of in `to`.
    pub fn compare(&mut self, what: Comparison, width: Width, to: Register, a: Register, b: Operand) {
        let to = if width == Width::Eight { Register(MASK) } else { to };
        self.vector(width, one_or_more(width), (Map::M0F, 0xc2), to, Some(a), b);
        self.bytes.push(what as u8);
    }

    /// `b` in lanes where `test` has its first bit set, otherwise `a`; for eight numbers the test is the last
    /// comparison.
    pub fn blend(&mut self, width: Width, to: Register, a: Register, b: Register, test: Register) {
        let b = Operand::Register(b);
        if width == Width::Eight {
            return self.evex(width, MASK, (Map::M0F38, 0x65), to, Some(a), b);
        }
        self.vex(width, Prefix::P66, (Map::M0F3A, 0x4b), to, Some(a), b);
        self.bytes.push(test.0 << 4);
    }

    /// VZEROUPPER: clears the upper parts of the vector registers, which would slow down SSE code after the function.
    pub fn zero_upper(&mut self) {
        self.bytes.extend([0xc5, 0xf8, 0x77]);
    }

    /// `to = from`
    pub fn copy(&mut self, to: Pointer, from: Pointer) {
        self.rex(0x89, from.0, Operand::Register(Register(to.0)));
    }

    /// Loads a pointer.
    pub fn load_pointer(&mut self, to: Pointer, from: Memory) {
        self.rex(0x8b, to.0, Operand::Memory(from));
    }

    /// Stores a pointer.
    pub fn store_pointer(&mut self, from: Pointer, to: Memory) {
        self.rex(0x89, from.0, Operand::Memory(to));
    }

    /// The address of a memory operand.
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

    /// Pushes a register.
    pub fn push(&mut self, from: Pointer) {
        self.bytes.extend([0x40 | from.0 >> 3, 0x50 | from.0 & 7]);
    }

    /// Pops a register.
    pub fn pop(&mut self, to: Pointer) {
        self.bytes.extend([0x40 | to.0 >> 3, 0x58 | to.0 & 7]);
    }

    /// Reads and writes a memory word unchanged, so that the system maps its page.
    pub fn probe(&mut self, place: Memory) {
        self.rex(0x83, 1, Operand::Memory(place));
        self.bytes.push(0);
    }

    /// Jumps back to an earlier position while `a < b`.
    pub fn jump_back_while_below(&mut self, a: Pointer, b: Pointer, from: usize) {
        self.rex(0x39, b.0, Operand::Register(Register(a.0)));
        self.bytes.extend([0x0f, 0x82]);
        let back = from as i64 - (self.here() as i64 + 4);
        self.bytes.extend((back as i32).to_le_bytes());
    }

    /// Calls the function that a register points to.
    pub fn call(&mut self, target: Pointer) {
        self.bytes.extend([0x40 | target.0 >> 3, 0xff, 0xd0 | target.0 & 7]);
    }

    /// Returns to the caller.
    pub fn ret(&mut self) {
        self.bytes.push(0xc3);
    }

    /// An instruction on numbers.
    fn vector(
        &mut self,
        width: Width,
        prefix: Prefix,
        opcode: (Map, u8),
        reg: Register,
        a: Option<Register>,
        b: Operand,
    ) {
        match width {
            Width::One | Width::Four => self.vex(width, prefix, opcode, reg, a, b),
            Width::Eight => self.evex(width, ALL, opcode, reg, a, b),
        }
    }

    fn vex(
        &mut self,
        width: Width,
        prefix: Prefix,
        (map, opcode): (Map, u8),
        reg: Register,
        a: Option<Register>,
        b: Operand,
    ) {
        let (index, base) = high_bits(b);
        // The fields of registers are inverted.
        let inverted = !a.map_or(0, |a| a.0) & 15;
        let last = inverted << 3 | u8::from(width == Width::Four) << 2 | prefix as u8;
        let reg_bit = (!reg.0 >> 3 & 1) << 7;
        if map == Map::M0F && index == 0 && base == 0 {
            self.bytes.extend([0xc5, reg_bit | last, opcode]);
        } else {
            let first = reg_bit | (index ^ 1) << 6 | (base ^ 1) << 5 | map as u8;
            self.bytes.extend([0xc4, first, last, opcode]);
        }
        self.operands(reg.0, b, 1);
    }

    /// An instruction on those numbers of a wide register that the mask selects; the memory operand has this many
    /// numbers.
    fn evex(
        &mut self,
        memory: Width,
        mask: u8,
        (map, opcode): (Map, u8),
        reg: Register,
        a: Option<Register>,
        b: Operand,
    ) {
        let (index, base) = high_bits(b);
        // The fifth bit of the last register is in the field that otherwise belongs to an index.
        let index = match b {
            Operand::Register(Register(b)) => b >> 4,
            Operand::Memory(_) => index,
        };
        let a = a.map_or(0, |a| a.0);
        let inverted = (reg.0 >> 3 & 1) << 7 | index << 6 | base << 5 | (reg.0 >> 4) << 4;
        let first = inverted ^ 0xf0 | map as u8;
        let second = 1 << 7 | (!a & 15) << 3 | 1 << 2 | Prefix::P66 as u8;
        let third = 2 << 5 | (!a >> 4 & 1) << 3 | mask;
        self.bytes.extend([0x62, first, second, third, opcode]);
        self.operands(reg.0, b, memory.bytes() as i32);
    }

    /// An instruction on pointers.
    fn rex(&mut self, opcode: u8, reg: u8, b: Operand) {
        let (index, base) = high_bits(b);
        self.bytes.extend([0x48 | reg >> 3 << 2 | index << 1 | base, opcode]);
        self.operands(reg, b, 1);
    }

    /// ModRM, SIB and displacement; a displacement of one byte counts in units of this many bytes.
    fn operands(&mut self, reg: u8, b: Operand, unit: i32) {
        let reg = (reg & 7) << 3;
        let memory = match b {
            Operand::Register(Register(b)) => return self.bytes.push(0xc0 | reg | b & 7),
            Operand::Memory(memory) => memory,
        };
        let units = (memory.offset % unit == 0).then_some(memory.offset / unit);
        let short = units.and_then(|units| i8::try_from(units).ok());
        let form = if short.is_some() { 0x40 } else { 0x80 };
        let base = memory.base.0 & 7;
        // In these fields, the stack pointer and R12 mean "SIB byte follows", and in SIB "no index".
        match memory.index {
            None if base != 4 => self.bytes.push(form | reg | base),
            index => {
                let index = index.map_or(4, |index| index.0 & 7);
                self.bytes.extend([form | reg | 4, index << 3 | base]);
            }
        }
        match short {
            Some(short) => self.bytes.push(short as u8),
            None => self.bytes.extend(memory.offset.to_le_bytes()),
        }
    }
}

/// The fourth bits of index and base.
fn high_bits(b: Operand) -> (u8, u8) {
    match b {
        Operand::Register(Register(b)) => (0, b >> 3 & 1),
        Operand::Memory(memory) => (memory.index.map_or(0, |index| index.0 >> 3), memory.base.0 >> 3),
    }
}

fn one_or_more(width: Width) -> Prefix {
    match width {
        Width::One => Prefix::F2,
        Width::Four | Width::Eight => Prefix::P66,
    }
}
