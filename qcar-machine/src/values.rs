//! Register allocation: which values are in registers, and which in memory.
//!
//! In a straight-line program the next use of each value is known, so the register with the farthest next use is taken
//! (Belády, L. A.: A study of replacement algorithms for a virtual-storage computer, IBM Systems Journal 5, 1966).

use qcar_dsl::program::{Program, Value};

use crate::assemble::{Register, Width};

/// The register for intermediate results of an operation.
pub const SCRATCH: Register = Register(15);

/// Register and memory slot of each value of a program while its code is written.
pub struct Values {
    /// Positions of the operations that use a value, value by value.
    uses: Vec<u32>,
    /// The remaining uses of each value, as a range of `uses`.
    remaining: Vec<(u32, u32)>,
    /// Value in each register.
    registers: Vec<Option<Value>>,
    register: Vec<Option<Register>>,
    slot: Vec<Option<u32>>,
    free_slots: Vec<u32>,
    slots: u32,
}

impl Values {
    /// Before the first operation: no value has a register or a slot.
    pub fn new(program: &Program, width: Width) -> Self {
        let count = program.ops.len();
        let mut remaining = vec![(0, 0); count + 1];
        for &op in &program.ops {
            for value in program.arguments(op) {
                remaining[value.0 as usize + 1].0 += 1;
            }
        }
        for value in 0..count {
            remaining[value + 1].0 += remaining[value].0;
            remaining[value].1 = remaining[value].0;
        }
        let mut uses = vec![0; remaining[count].0 as usize];
        for (place, &op) in program.ops.iter().enumerate() {
            for value in program.arguments(op) {
                let end = &mut remaining[value.0 as usize].1;
                uses[*end as usize] = place as u32;
                *end += 1;
            }
        }
        Values {
            uses,
            remaining,
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
    pub fn has_free_register(&self) -> bool {
        self.registers.iter().any(Option::is_none)
    }

    /// True if the present operation is the last use of a value.
    pub fn is_last(&self, value: Value) -> bool {
        let (next, end) = self.remaining[value.0 as usize];
        let remaining = &self.uses[next as usize..end as usize];
        remaining.first() == remaining.last()
    }

    /// Counts a use of a value. After the last one its register is free, so the result may get it.
    pub fn consume(&mut self, value: Value) {
        self.remaining[value.0 as usize].0 += 1;
        if self.next(value).is_none() {
            self.free_register(value);
        }
    }

    /// Frees register and slot of a value without further uses, after an operation is complete.
    pub fn release(&mut self, value: Value) {
        if self.next(value).is_none() {
            self.free_register(value);
            self.free_slots.extend(self.slot[value.0 as usize].take());
        }
    }

    fn free_register(&mut self, value: Value) {
        if let Some(register) = self.register[value.0 as usize].take() {
            self.registers[place_of(register)] = None;
        }
    }

    /// Assigns a register to a value; returns it with the value that is evicted from it.
    pub fn allocate(&mut self, value: Value) -> (Register, Option<Value>) {
        let free = self.registers.iter().position(Option::is_none);
        let place = free.unwrap_or_else(|| self.farthest_use());
        let register = register_at(place);
        let evicted = self.registers[place].replace(value);
        if let Some(evicted) = evicted {
            self.register[evicted.0 as usize] = None;
        }
        self.register[value.0 as usize] = Some(register);
        (register, evicted)
    }

    /// Assigns a memory slot to a value that leaves its register.
    pub fn spill(&mut self, value: Value) -> u32 {
        let slot = self.free_slots.pop().unwrap_or_else(|| {
            self.slots += 1;
            self.slots - 1
        });
        self.slot[value.0 as usize] = Some(slot);
        slot
    }

    /// Frees all registers, and returns their values.
    pub fn evict_all(&mut self) -> impl Iterator<Item = (Register, Value)> + use<> {
        let none = vec![None; self.registers.len()];
        let registers = std::mem::replace(&mut self.registers, none);
        for value in registers.iter().flatten() {
            self.register[value.0 as usize] = None;
        }
        let evicted = registers.into_iter().enumerate();
        evicted.filter_map(|(place, value)| Some((register_at(place), value?)))
    }

    fn next(&self, value: Value) -> Option<u32> {
        let (next, end) = self.remaining[value.0 as usize];
        (next < end).then(|| self.uses[next as usize])
    }

    fn farthest_use(&self) -> usize {
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

/// All registers but [`SCRATCH`].
fn register_at(place: usize) -> Register {
    let place = place as u8;
    Register(place + u8::from(place >= SCRATCH.0))
}

fn place_of(register: Register) -> usize {
    usize::from(register.0 - u8::from(register.0 > SCRATCH.0))
}
