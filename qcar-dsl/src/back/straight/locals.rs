//! Names of local variables: each free of a language's keywords and of the others.

use std::collections::BTreeMap;

use super::{Function, Leaf, Local, Pieces};
use crate::hash::HashSet;
use crate::program::Value;

/// The names that are taken in a function.
pub struct Names(HashSet<String>);

impl Names {
    /// Names beside these.
    pub fn beside<'a>(taken: impl IntoIterator<Item = &'a str>) -> Names {
        Names(taken.into_iter().map(String::from).collect())
    }

    /// The wished name, with as many `_` behind it as make it free. The state of an element has a dot in its name.
    pub fn take(&mut self, wish: &str) -> String {
        let mut name = wish.replace('.', "_");
        while self.0.contains(&name) {
            name.push('_');
        }
        self.0.insert(name.clone());
        name
    }
}

/// The local variables of one piece of a program, and where its values go.
pub struct Locals {
    /// The variable of each value that the piece reads, takes or computes; empty for the others.
    names: Vec<String>,
    /// The results to which each value goes.
    results: BTreeMap<Value, Vec<usize>>,
}

impl Locals {
    /// Names the values of a piece; `read` says what a reviewer calls a leaf.
    pub fn new(function: &Function, cut: &Pieces, piece: usize, mut free: Names, read: &dyn Fn(Leaf) -> Local) -> Self {
        let mut names = vec![String::new(); cut.program.ops.len()];
        for (leaf, value) in cut.read(piece) {
            names[value.0 as usize] = free.take(&read(leaf).name);
        }
        for value in cut.taken(piece).into_iter().chain(cut.pieces[piece].iter().copied()) {
            let label = function.labels.get(&value).cloned();
            names[value.0 as usize] = free.take(&label.unwrap_or_else(|| format!("v{}", value.0)));
        }
        let mut results: BTreeMap<Value, Vec<usize>> = BTreeMap::new();
        for (place, &value) in cut.program.outputs.iter().enumerate() {
            results.entry(value).or_default().push(place);
        }
        Locals { names, results }
    }

    /// No variables yet; none will be a result.
    pub fn none() -> Self {
        let (names, results) = (Vec::new(), BTreeMap::new());
        Locals { names, results }
    }

    /// What the next value is called.
    pub fn push(&mut self, name: String) {
        self.names.push(name);
    }

    /// The variable of a value.
    pub fn name(&self, value: Value) -> &str {
        &self.names[value.0 as usize]
    }

    /// The places of a value among the results.
    pub fn results(&self, value: Value) -> impl Iterator<Item = usize> {
        self.results.get(&value).into_iter().flatten().copied()
    }
}
