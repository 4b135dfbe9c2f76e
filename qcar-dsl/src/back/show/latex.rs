//! Equations and matrices for a paper: a document that compiles with amsmath and nothing else.

use crate::back::equations::{Equation, Sheet};
use crate::back::notation::Notation;
use crate::program::schedule::Compiled;

use super::matrices::entries;

/// Number of terms in a line of an equation.
const TERMS_A_LINE: usize = 3;

/// A whole document.
pub fn latex(compiled: &Compiled) -> String {
    let mut text = format!("{HEAD}\\section*{{{}}}\n", escape(&compiled.model.name));
    if !compiled.model.doc.is_empty() {
        text += &format!("{}\n", escape(&compiled.model.doc));
    }
    for (heading, equations) in Sheet::new(&compiled.model, Notation::Latex).sections() {
        text += &format!("\n\\subsection*{{{heading}}}\n{}", align(&equations));
    }
    for (matrix, entries) in entries(compiled, Notation::Latex) {
        let entries: Vec<Equation> = entries
            .into_iter()
            .map(|(place, value)| Equation {
                left: format!("{matrix:?}{place}"),
                right: vec![value],
            })
            .collect();
        if !entries.is_empty() {
            text += &format!("\n\\subsection*{{Nonzeros of ${matrix:?}$}}\n{}", align(&entries));
        }
    }
    text + "\\end{document}\n"
}

const HEAD: &str = r"\documentclass{article}
\usepackage[margin=2cm]{geometry}
\usepackage{amsmath}
\allowdisplaybreaks
\begin{document}
";

fn align(equations: &[Equation]) -> String {
    let written: Vec<String> = equations.iter().map(equation).collect();
    format!("\\begin{{align*}}\n{}\n\\end{{align*}}\n", written.join(" \\\\\n"))
}

/// An equation in as many lines as it needs.
fn equation(equation: &Equation) -> String {
    let lines: Vec<String> = equation
        .right
        .chunks(TERMS_A_LINE)
        .map(|terms| terms.join(" "))
        .collect();
    format!("{} &= {}", equation.left, lines.join(" \\\\\n&\\quad "))
}

fn escape(text: &str) -> String {
    text.replace('\\', r"\textbackslash ")
        .replace('_', r"\_")
        .replace('&', r"\&")
        .replace('%', r"\%")
        .replace('#', r"\#")
}
