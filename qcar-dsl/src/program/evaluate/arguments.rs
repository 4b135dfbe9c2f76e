//! The arguments of a program, from which its leaves are read.

use std::collections::BTreeSet;
use std::ops::Range;

use crate::derive::vectors::Vectors;
use crate::expr::Symbol;
use crate::program::{Op, Program};

/// An argument of a program.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Part {
    /// Parameters.
    Parameters,
    /// Constants, which were prepared from the parameters.
    Constants,
    /// `x`
    States,
    /// `u`
    Inputs,
    /// Stretch, rate and forces of a rolling tyre: m, m/s, N.
    Contact,
    /// rad/s
    Frequency,
}

/// The arguments of a program, from which its leaves are read: the entries of each part, empty unless set.
#[derive(Clone, Copy, Default)]
pub struct Arguments<'a>([&'a [f64]; 6]);

impl<'a> Arguments<'a> {
    /// The same arguments with another part.
    #[inline]
    pub fn with(mut self, part: Part, entries: &'a [f64]) -> Self {
        self.0[part as usize] = entries;
        self
    }

    /// The entries of a part.
    #[inline]
    pub fn part(&self, part: Part) -> &'a [f64] {
        self.0[part as usize]
    }
}

/// The arguments of a program that reads prepared constants.
#[inline]
pub fn prepared<'a>(constants: &'a [f64], x: &'a [f64], u: &'a [f64]) -> Arguments<'a> {
    moving(x, u).with(Part::Constants, constants)
}

/// The arguments of a program that reads the parameters themselves.
#[inline]
pub fn unprepared<'a>(p: &'a [f64], x: &'a [f64], u: &'a [f64]) -> Arguments<'a> {
    moving(x, u).with(Part::Parameters, p)
}

#[inline]
fn moving<'a>(x: &'a [f64], u: &'a [f64]) -> Arguments<'a> {
    Arguments::default().with(Part::States, x).with(Part::Inputs, u)
}

/// The entries of a part that a program reads, in order. They occupy consecutive registers from `first`.
#[derive(Clone, Debug)]
pub struct ReadEntries {
    /// The part.
    pub part: Part,
    /// Positions of the entries in the part.
    pub entries: Vec<usize>,
    /// The register of the first entry.
    pub first: usize,
}

impl ReadEntries {
    /// The registers of these entries.
    pub fn registers(&self) -> Range<usize> {
        self.first..self.first + self.entries.len()
    }

    /// The register of an entry, if it is among these.
    fn register(&self, (part, entry): (Part, usize)) -> Option<usize> {
        let place = self.entries.binary_search(&entry).ok()?;
        (self.part == part).then_some(self.first + place)
    }
}

/// The entries that a program reads, part by part, in registers from 0.
pub fn reads(vectors: &Vectors, program: &Program) -> Vec<ReadEntries> {
    let leaves = program.ops.iter().filter_map(|op| place(vectors, op));
    let leaves: Vec<(Part, usize)> = leaves.collect::<BTreeSet<_>>().into_iter().collect();
    let mut first = 0;
    let parts = leaves.chunk_by(|one, next| one.0 == next.0).map(|leaves| {
        first += leaves.len();
        ReadEntries {
            part: leaves[0].0,
            entries: leaves.iter().map(|leaf| leaf.1).collect(),
            first: first - leaves.len(),
        }
    });
    parts.collect()
}

/// The register of a leaf; `None` for a number or an operation.
pub fn register(vectors: &Vectors, reads: &[ReadEntries], op: &Op) -> Option<usize> {
    let place = place(vectors, op)?;
    reads.iter().find_map(|read| read.register(place))
}

/// The part and the position of a leaf in the arguments; `None` for a number or an operation.
pub fn place(vectors: &Vectors, op: &Op) -> Option<(Part, usize)> {
    match *op {
        Op::Prepared(place) => Some((Part::Constants, place as usize)),
        Op::Input(symbol) => place_of(vectors, symbol),
        _ => None,
    }
}

/// The part and the position of a symbol in the arguments.
fn place_of(vectors: &Vectors, symbol: Symbol) -> Option<(Part, usize)> {
    match symbol {
        Symbol::Frequency => Some((Part::Frequency, 0)),
        Symbol::Parameter(p) => Some((Part::Parameters, p.into())),
        Symbol::Stretch(_) => Some((Part::Contact, 0)),
        Symbol::Rate(_) => Some((Part::Contact, 1)),
        Symbol::ContactForce(axis) => Some((Part::Contact, 2 + usize::from(axis))),
        _ => {
            let state = vectors.state(symbol).map(|place| (Part::States, place));
            state.or_else(|| Some((Part::Inputs, vectors.input(symbol)?)))
        }
    }
}
