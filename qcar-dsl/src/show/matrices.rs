//! The nonzero entries of A, B, C and D in the names of the model.

use crate::about::{About, Entry, Matrix};
use crate::equations::named_quantities;
use crate::expr::Expr;
use crate::notation::{Notation, Writer};
use crate::schedule::Compiled;

/// What the matrices are over, then their nonzeros row by row.
pub fn matrices(compiled: &Compiled) -> String {
    let about = &compiled.about;
    let mut text = format!(
        "dx/dt = A x + B u,  y = C x + D u{}\n\nx = [{}]\nu = [{}]\ny = [{}]\n",
        if about.linear {
            ""
        } else {
            "  (linearised where x and u stand)"
        },
        about
            .states
            .iter()
            .map(|state| state.name.as_str())
            .collect::<Vec<_>>()
            .join(", "),
        about
            .inputs
            .iter()
            .map(|input| input.name.as_str())
            .collect::<Vec<_>>()
            .join(", "),
        about
            .outputs
            .iter()
            .map(|output| output.name.as_str())
            .collect::<Vec<_>>()
            .join(", "),
    );
    for (matrix, lines) in entries(compiled, Notation::Text) {
        text += &format!("\n{matrix:?}\n");
        lines
            .iter()
            .for_each(|(left, right)| text += &format!("    {left} = {right}\n"));
    }
    text
}

/// The nonzeros of each matrix: where, what.
pub fn entries(compiled: &Compiled, notation: Notation) -> Vec<(Matrix, Vec<(String, String)>)> {
    let mut writer = Writer::new(&compiled.model, &compiled.graph, notation);
    named_quantities(&compiled.model)
        .iter()
        .for_each(|(name, value)| writer.name(*value, name));
    let of = |matrix: Matrix| {
        let nonzeros = compiled
            .linear
            .matrices
            .iter()
            .filter(|(entry, _)| entry.matrix == matrix);
        let written = |(entry, value): &(Entry, Expr)| (place(&compiled.about, &writer, entry), writer.write(*value));
        (matrix, nonzeros.map(written).collect())
    };
    [Matrix::A, Matrix::B, Matrix::C, Matrix::D].map(of).into()
}

fn place(about: &About, writer: &Writer, entry: &Entry) -> String {
    let (row, column) = about.relates(entry);
    format!("[{}, {}]", writer.identifier(row), writer.identifier(column))
}
