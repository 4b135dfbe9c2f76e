//! What the compiler has understood, for people: each stage of a model as text.

mod dot;
mod file;
mod latex;
mod matrices;

use crate::equations::{Equation, Sheet};
use crate::notation::Notation;
use crate::rust;
use crate::schedule::Compiled;

/// A stage that people can look at.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Stage {
    /// The model as a file: options taken, elements expanded. It reads back as the same model.
    Model,
    /// The equations of motion.
    Equations,
    /// The nonzeros of A, B, C and D.
    Matrices,
    /// The generated module.
    Rust,
    /// Equations and matrices as a LaTeX document.
    Latex,
    /// Masses and links as a graph for Graphviz.
    Dot,
}

impl Stage {
    /// All stages, in the order of the data.
    pub const ALL: [Stage; 6] = [
        Stage::Model,
        Stage::Equations,
        Stage::Matrices,
        Stage::Rust,
        Stage::Latex,
        Stage::Dot,
    ];

    /// What a user calls it.
    pub fn name(self) -> &'static str {
        match self {
            Stage::Model => "model",
            Stage::Equations => "equations",
            Stage::Matrices => "matrices",
            Stage::Rust => "rust",
            Stage::Latex => "latex",
            Stage::Dot => "dot",
        }
    }

    /// The stage of a name.
    pub fn of_name(name: &str) -> Option<Stage> {
        Stage::ALL.into_iter().find(|stage| stage.name() == name)
    }
}

/// A stage of a model as text.
pub fn show(compiled: &Compiled, stage: Stage) -> String {
    match stage {
        Stage::Model => file::model(&compiled.model),
        Stage::Equations => equations(compiled),
        Stage::Matrices => matrices::matrices(compiled),
        Stage::Rust => rust::module(compiled),
        Stage::Latex => latex::latex(compiled),
        Stage::Dot => dot::dot(&compiled.model),
    }
}

fn equations(compiled: &Compiled) -> String {
    let section = |(heading, equations): (String, Vec<Equation>)| {
        let line = |e: &Equation| format!("    {} = {}\n", e.left, e.right.join(" "));
        format!("{heading}\n\n{}", equations.iter().map(line).collect::<String>())
    };
    let sections = Sheet::new(&compiled.model, Notation::Text).sections();
    sections.into_iter().map(section).collect::<Vec<_>>().join("\n")
}
