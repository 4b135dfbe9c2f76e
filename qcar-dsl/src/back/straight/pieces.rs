//! Splits a long program into pieces, since the time of a compiler's optimiser grows faster than the length of a
//! function.
//!
//! Values that later pieces need are passed in an array, `kept`.

use std::collections::{BTreeMap, BTreeSet};

use crate::expr::Symbol;
use crate::hash::HashMap;
use crate::program::{Op, Program, Value};

/// The longest piece, in operations.
const LONGEST: usize = 1000;

/// A program and its pieces.
pub struct Pieces<'a> {
    /// The whole program.
    pub program: &'a Program,
    /// The computed values of each piece, in order; one piece at least.
    pub pieces: Vec<Vec<Value>>,
    /// The values that a later piece needs, with their positions in `kept`.
    pub kept: BTreeMap<Value, usize>,
    /// The positions of each value among the results of the program.
    results: HashMap<Value, Vec<usize>>,
}

/// A value that a program reads from its arguments.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Debug)]
pub enum Leaf {
    /// A prepared constant.
    Prepared(u32),
    /// A symbol of the equations.
    Symbol(Symbol),
}

impl<'a> Pieces<'a> {
    /// Cuts a program into pieces of about equal length.
    pub fn cut(program: &'a Program) -> Pieces<'a> {
        let computed: Vec<Value> = computed(program).collect();
        let count = computed.len().div_ceil(LONGEST).max(1);
        let length = computed.len().div_ceil(count).max(1);
        let mut pieces: Vec<Vec<Value>> = computed.chunks(length).map(<[Value]>::to_vec).collect();
        if pieces.is_empty() {
            pieces.push(Vec::new());
        }
        let mut cut = Pieces {
            program,
            pieces,
            kept: BTreeMap::new(),
            results: results(program),
        };
        let crossing: BTreeSet<Value> = (0..cut.pieces.len()).flat_map(|piece| cut.inherited(piece)).collect();
        cut.kept = crossing.into_iter().zip(0..).collect();
        cut
    }

    /// The whole program as one piece, for languages without an optimiser.
    pub fn whole(program: &'a Program) -> Pieces<'a> {
        Pieces {
            program,
            pieces: vec![computed(program).collect()],
            kept: BTreeMap::new(),
            results: results(program),
        }
    }

    /// The values that a piece gets from earlier ones.
    pub fn inherited(&self, piece: usize) -> BTreeSet<Value> {
        let values = &self.pieces[piece];
        let used = values
            .iter()
            .flat_map(|&value| self.program.arguments(op(self.program, value)));
        used.filter(|&value| is_computed(self.program, value) && value < values[0])
            .collect()
    }

    /// The leaves that a piece reads, in the order of their positions.
    pub fn read(&self, piece: usize) -> BTreeMap<Leaf, Value> {
        let used = self.pieces[piece]
            .iter()
            .flat_map(|&value| self.program.arguments(op(self.program, value)));
        let stored = self.stored(piece).into_iter().map(|(_, value)| value);
        used.chain(stored)
            .filter_map(|value| Some((as_leaf(self.program, value)?, value)))
            .collect()
    }

    /// The results that are numbers or leaves, with their positions; the first piece stores them.
    pub fn stored(&self, piece: usize) -> Vec<(usize, Value)> {
        // A long program has many pieces and many results, so no other piece looks at them.
        if piece > 0 {
            return Vec::new();
        }
        let results = self.program.outputs.iter().copied().enumerate();
        results
            .filter(|&(_, value)| !is_computed(self.program, value))
            .collect()
    }

    /// The positions of a value among the results.
    pub fn results(&self, value: Value) -> &[usize] {
        self.results.get(&value).map_or(&[], Vec::as_slice)
    }
}

fn results(program: &Program) -> HashMap<Value, Vec<usize>> {
    let mut results: HashMap<Value, Vec<usize>> = HashMap::default();
    for (place, &value) in program.outputs.iter().enumerate() {
        results.entry(value).or_default().push(place);
    }
    results
}

/// The operation of a value.
fn op(program: &Program, value: Value) -> Op {
    program.ops[value.0 as usize]
}

/// The leaf that a value reads; `None` for a number or an operation.
fn as_leaf(program: &Program, value: Value) -> Option<Leaf> {
    match op(program, value) {
        Op::Input(symbol) => Some(Leaf::Symbol(symbol)),
        Op::Prepared(place) => Some(Leaf::Prepared(place)),
        _ => None,
    }
}

/// The values of a program that are results of operations, in order.
pub fn computed(program: &Program) -> impl Iterator<Item = Value> {
    (0..program.ops.len() as u32)
        .map(Value)
        .filter(|&value| is_computed(program, value))
}

fn is_computed(program: &Program, value: Value) -> bool {
    !op(program, value).is_leaf()
}
