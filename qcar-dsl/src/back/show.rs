//! Each stage of a model as text, for people.

// Masses and links as a graph.
mod dot;
// Nonzeros row by row.
mod matrices;
// Equations and matrices for a paper.
mod latex;

use crate::back::equations::{Equation, Sheet};
use crate::back::notation::Notation;
use crate::back::rust;
use crate::program::schedule::Compiled;

/// A stage that can be shown.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Stage {
    /// The model as a file of its own, with its options chosen. The file gives the same model again.
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

    /// Its name on the command line.
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
        Stage::Model => compiled.model.text().to_string(),
        Stage::Equations => equations(compiled),
        Stage::Matrices => matrices::matrices(compiled),
        Stage::Rust => rust::module(compiled),
        Stage::Latex => latex::latex(compiled),
        Stage::Dot => dot::dot(&compiled.model),
    }
}

/// Largest width of a line of equations, characters.
const WIDTH: usize = 110;

fn equations(compiled: &Compiled) -> String {
    let section = |(heading, equations): (String, Vec<Equation>)| {
        format!("{heading}\n\n{}", equations.iter().map(equation).collect::<String>())
    };
    let sections = Sheet::new(&compiled.model, Notation::Text).sections();
    sections.into_iter().map(section).collect::<Vec<_>>().join("\n")
}

/// An equation, broken between terms into as many lines as it needs.
fn equation(equation: &Equation) -> String {
    let mut lines = vec![format!("    {} =", equation.left)];
    for term in &equation.right {
        match lines.last_mut() {
            Some(line) if line.chars().count() + term.chars().count() < WIDTH => *line += &format!(" {term}"),
            _ => lines.push(format!("            {term}")),
        }
    }
    lines.join("\n") + "\n"
}
