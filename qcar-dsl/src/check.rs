//! The structure: what is held, what is solvable, what can be seen.

use std::ops::Deref;

use crate::model::Model;

/// A model that has passed every rule. Every later stage takes one, and none of them fails.
#[derive(Clone, Debug)]
pub struct Checked(Model);

impl Checked {
    /// Takes a model on trust.
    ///
    /// For models that a program built and knows to be sound. Later stages do not panic on an unsound one, but what
    /// they compute from it means nothing.
    pub fn trust(model: Model) -> Self {
        Checked(model)
    }
}

impl Deref for Checked {
    type Target = Model;

    fn deref(&self) -> &Model {
        &self.0
    }
}
