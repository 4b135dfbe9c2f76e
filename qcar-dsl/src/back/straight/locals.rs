//! Names of local variables, all different and none a keyword of the language.

use super::{Function, Leaf, Local, Pieces};
use crate::hash::{HashMap, HashSet};
use crate::program::Value;

/// The names that a function already uses.
pub struct Names(HashSet<String>);

impl Names {
    /// Starts with these names.
    pub fn beside<'a>(used: impl IntoIterator<Item = &'a str>) -> Names {
        Names(used.into_iter().map(String::from).collect())
    }

    /// Returns the name `wish`, with as many `_` appended as make it unique. Dots, as in the state of an element, are
    /// replaced.
    pub fn take(&mut self, wish: &str) -> String {
        let mut name = wish.replace('.', "_");
        while self.0.contains(&name) {
            name.push('_');
        }
        self.0.insert(name.clone());
        name
    }
}

/// The local variables of one piece of a program.
#[derive(Default)]
pub struct Locals {
    /// The variable of each value that the piece reads, inherits or computes.
    names: HashMap<Value, String>,
}

impl Locals {
    /// Names the values of a piece; `read` gives the name of a leaf.
    pub fn new(function: &Function, cut: &Pieces, piece: usize, mut free: Names, read: &dyn Fn(Leaf) -> Local) -> Self {
        let mut locals = Locals::default();
        for (leaf, value) in cut.read(piece) {
            locals.name_it(value, free.take(&read(leaf).name));
        }
        for value in cut
            .inherited(piece)
            .into_iter()
            .chain(cut.pieces[piece].iter().copied())
        {
            let label = function.labels.get(&value).cloned();
            locals.name_it(value, free.take(&label.unwrap_or_else(|| format!("v{}", value.0))));
        }
        locals
    }

    /// Sets the variable of a value.
    pub fn name_it(&mut self, value: Value, name: String) {
        self.names.insert(value, name);
    }

    /// The variable of a value.
    pub fn name(&self, value: Value) -> &str {
        &self.names[&value]
    }
}
