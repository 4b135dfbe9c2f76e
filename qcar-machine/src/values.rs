//! Register allocation: which values are in registers, and which in memory.
//!
//! In a straight-line program the next use of each value is known, so the register with the farthest next use is taken
//! (Belády, L. A.: A study of replacement algorithms for a virtual-storage computer, IBM Systems Journal 5, 1966).

use qcar_dsl::program::{Program, Value};

use crate::assemble::{Register, Width};

/// Registers reserved for the temporaries of an operation.
pub const OWN: Register = Register(15);

/// Locations of the values of a program while its code is written.
pub struct Values {
    /// Positions of the operations that use a value, value by value.
    needed: Vec<u32>,
    /// Remaining uses of each value, as a range of these.
    rest: Vec<(u32, u32)>,
    /// Value in each register.
    registers: Vec<Option<Value>>,
    register: Vec<Option<Register>>,
    slot: Vec<Option<u32>>,
    free_slots: Vec<u32>,
    slots: u32,
}

impl Values {
    /// No value anywhere, with the number of registers for this width.
    pub fn new(program: &Program, width: Width) -> Self {
        let count = program.ops.len();
        let mut rest = vec![(0, 0); count + 1];
        for &op in &program.ops {
            for value in program.arguments(op) {
                rest[value.0 as usize + 1].0 += 1;
            }
        }
        for value in 0..count {
            rest[value + 1].0 += rest[value].0;
            rest[value].1 = rest[value].0;
        }
        let mut needed = vec![0; rest[count].0 as usize];
        for (place, &op) in program.ops.iter().enumerate() {
            for value in program.arguments(op) {
                let end = &mut rest[value.0 as usize].1;
                needed[*end as usize] = place as u32;
                *end += 1;
            }
        }
        Values {
            needed,
            rest,
            registers: vec![None; registers(width) - 1],
            register: vec![None; count],
            slot: vec![None; count],
            free_slots: Vec::new(),
            slots: 0,
        }
    }

    /// Number of memory slots in use.
    pub fn slots(&self) -> u32 {
        self.slots
    }

    /// Register of a value.
    pub fn register(&self, value: Value) -> Option<Register> {
        self.register[value.0 as usize]
    }

    /// Memory slot of a value.
    pub fn slot(&self, value: Value) -> Option<u32> {
        self.slot[value.0 as usize]
    }

    /// True if a register is free.
    pub fn has_room(&self) -> bool {
        self.registers.iter().any(Option::is_none)
    }

    /// True if the present operation is the last use of a value.
    pub fn is_last(&self, value: Value) -> bool {
        let (next, end) = self.rest[value.0 as usize];
        let rest = &self.needed[next as usize..end as usize];
        rest.first() == rest.last()
    }

    /// An operation uses a value. If it is the last one, the result may get its register.
    pub fn consume(&mut self, value: Value) {
        self.rest[value.0 as usize].0 += 1;
        if self.next(value).is_none() {
            self.leave(value);
        }
    }

    /// Frees the locations of a value without further uses, after an operation is complete.
    pub fn release(&mut self, value: Value) {
        if self.next(value).is_none() {
            self.leave(value);
            self.free_slots.extend(self.slot[value.0 as usize].take());
        }
    }

    fn leave(&mut self, value: Value) {
        if let Some(register) = self.register[value.0 as usize].take() {
            self.registers[place_of(register)] = None;
        }
    }

    /// A register for a value, and the value that it is taken from.
    pub fn allocate(&mut self, value: Value) -> (Register, Option<Value>) {
        let free = self.registers.iter().position(Option::is_none);
        let place = free.unwrap_or_else(|| self.last_needed());
        let register = register_at(place);
        let evicted = self.registers[place].replace(value);
        if let Some(evicted) = evicted {
            self.register[evicted.0 as usize] = None;
        }
        self.register[value.0 as usize] = Some(register);
        (register, evicted)
    }

    /// A memory slot for a value.
    pub fn keep(&mut self, value: Value) -> u32 {
        let slot = self.free_slots.pop().unwrap_or_else(|| {
            self.slots += 1;
            self.slots - 1
        });
        self.slot[value.0 as usize] = Some(slot);
        slot
    }

    /// Frees all registers, and returns their values.
    pub fn clear(&mut self) -> impl Iterator<Item = (Register, Value)> + use<> {
        let none = vec![None; self.registers.len()];
        let registers = std::mem::replace(&mut self.registers, none);
        for value in registers.iter().flatten() {
            self.register[value.0 as usize] = None;
        }
        let stood = registers.into_iter().enumerate();
        stood.filter_map(|(place, value)| Some((register_at(place), value?)))
    }

    fn next(&self, value: Value) -> Option<u32> {
        let (next, end) = self.rest[value.0 as usize];
        (next < end).then(|| self.needed[next as usize])
    }

    fn last_needed(&self) -> usize {
        let next = |place: &usize| self.registers[*place].map(|value| self.next(value));
        (0..self.registers.len()).max_by_key(next).unwrap_or_default()
    }
}

fn registers(width: Width) -> usize {
    match width {
        Width::One | Width::Four => 16,
        Width::Eight => 32,
    }
}

/// All registers but [`OWN`].
fn register_at(place: usize) -> Register {
    let place = place as u8;
    Register(place + u8::from(place >= OWN.0))
}

fn place_of(register: Register) -> usize {
    usize::from(register.0 - u8::from(register.0 > OWN.0))
}
