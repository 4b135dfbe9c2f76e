//! Where the code of a program finds the leaves, its inputs, in the arguments.

use qcar_dsl::evaluate::arguments::{Part, place};
use qcar_dsl::program::{Program, Value};

use crate::shape::Shape;
use qcar_dsl::derive::vectors::Vectors;

/// Position of a leaf.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Leaf {
    /// An entry of a part, by the position of the part in [`Reads::parts`].
    Entry { part: usize, entry: usize },
    /// A row of points, by its position in [`Reads::rows`].
    Row(usize),
}

/// Inputs of a program in a shape.
#[derive(Debug)]
pub struct Reads {
    /// Parts that are read entry by entry, with the smallest number of entries.
    pub parts: Vec<(Part, usize)>,
    /// Entries of varying parts, which are read as rows.
    pub rows: Vec<(Part, usize)>,
    /// Leaf of each value of the program; `None` for a constant or an operation.
    leaves: Vec<Option<Leaf>>,
}

impl Reads {
    /// The positions of all leaves of a program.
    pub fn new(vectors: &Vectors, program: &Program, shape: Shape) -> Self {
        let mut reads = Reads {
            parts: Vec::new(),
            rows: Vec::new(),
            leaves: Vec::with_capacity(program.ops.len()),
        };
        for op in &program.ops {
            let leaf = place(vectors, op).map(|place| reads.leaf(place, shape));
            reads.leaves.push(leaf);
        }
        reads
    }

    /// Position of a value.
    pub fn of(&self, value: Value) -> Option<Leaf> {
        self.leaves[value.0 as usize]
    }

    fn leaf(&mut self, (part, entry): (Part, usize), shape: Shape) -> Leaf {
        if matches!(shape, Shape::Points(varying) if varying.contains(&part)) {
            self.rows.push((part, entry));
            return Leaf::Row(self.rows.len() - 1);
        }
        let known = self.parts.iter().position(|own| own.0 == part);
        let place = known.unwrap_or_else(|| {
            self.parts.push((part, 0));
            self.parts.len() - 1
        });
        let least = &mut self.parts[place].1;
        *least = (*least).max(entry + 1);
        Leaf::Entry { part: place, entry }
    }
}
