//! Which values stand in registers, and which wait in memory.
//!
//! A straight-line program says when each value is needed next, so that a register is taken from the value that is needed last
//! (Belády, L. A.: A study of replacement algorithms for a virtual-storage computer, IBM Systems Journal 5, 1966).

use qcar_dsl::program::{Program, Value};

use crate::assemble::{Register, Width};

/// Of no value's: left for what an operation keeps to itself.
pub const OWN: Register = Register(15);

/// The values of a program while its code is written.
pub struct Values {
    /// Where the operations stand that need a value, those of each in a row.
    needed: Vec<u32>,
    /// Of each value the rest of its row: the operations that are still to come.
    rest: Vec<(u32, u32)>,
    /// What stands in each register.
    registers: Vec<Option<Value>>,
    register: Vec<Option<Register>>,
    slot: Vec<Option<u32>>,
    free_slots: Vec<u32>,
    slots: u32,
}

impl Values {
    /// None of them anywhere, with as many registers as instructions of this width have.
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

    /// How many places in memory there are.
    pub fn slots(&self) -> u32 {
        self.slots
    }

    /// The register in which a value stands.
    pub fn register(&self, value: Value) -> Option<Register> {
        self.register[value.0 as usize]
    }

    /// The place in memory where a value waits.
    pub fn slot(&self, value: Value) -> Option<u32> {
        self.slot[value.0 as usize]
    }

    /// True where nothing stands in some register.
    pub fn has_room(&self) -> bool {
        self.registers.iter().any(Option::is_none)
    }

    /// True where the operation that is written now is the last that needs a value.
    pub fn is_last(&self, value: Value) -> bool {
        let (next, end) = self.rest[value.0 as usize];
        let rest = &self.needed[next as usize..end as usize];
        rest.first() == rest.last()
    }

    /// An operation reads a value. Where no later one does, the result may have its register.
    pub fn consume(&mut self, value: Value) {
        self.rest[value.0 as usize].0 += 1;
        if self.next(value).is_none() {
            self.leave(value);
        }
    }

    /// Frees the places of a value that is needed no more, now that all of an operation is written.
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

    /// A register for a value, and which value it is taken from.
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

    /// A place in memory for a value.
    pub fn keep(&mut self, value: Value) -> u32 {
        let slot = self.free_slots.pop().unwrap_or_else(|| {
            self.slots += 1;
            self.slots - 1
        });
        self.slot[value.0 as usize] = Some(slot);
        slot
    }

    /// Empties all registers, and gives what stood in them.
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

/// All registers but [`OWN`] in a row.
fn register_at(place: usize) -> Register {
    let place = place as u8;
    Register(place + u8::from(place >= OWN.0))
}

fn place_of(register: Register) -> usize {
    usize::from(register.0 - u8::from(register.0 > OWN.0))
}
