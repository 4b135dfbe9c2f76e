//! The nonzero entries of A, B, C and D in the names of the model.

use std::collections::BTreeMap;

use qcar_model::{About, Entry, Matrix};

use crate::back::equations::named_quantities;
use crate::back::notation::{Notation, Writer};
use crate::expr::Expr;
use crate::program::schedule::Compiled;

/// The names of states, inputs and outputs, then the nonzeros of the matrices row by row.
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
            .map(|state| state.name.as_ref())
            .collect::<Vec<_>>()
            .join(", "),
        about
            .inputs
            .iter()
            .map(|input| input.name.as_ref())
            .collect::<Vec<_>>()
            .join(", "),
        about
            .outputs
            .iter()
            .map(|output| output.name.as_ref())
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

/// The nonzeros of each matrix: their position and their value. An output that is the rate of a state refers to the
/// rows of that state.
pub fn entries(compiled: &Compiled, notation: Notation) -> Vec<(Matrix, Vec<(String, String)>)> {
    let mut writer = Writer::new(&compiled.model, &compiled.graph, notation);
    named_quantities(&compiled.model)
        .iter()
        .for_each(|(name, value)| writer.name(*value, name));
    let about = &compiled.about;
    let same = SameRates::of(compiled);
    let of = |matrix: Matrix| {
        let mut lines = Vec::new();
        for row in 0..rows(about, matrix) {
            let nonzeros = self::row(compiled, matrix, row);
            match same.state(compiled, matrix, row) {
                Some(state) if !nonzeros.is_empty() => {
                    lines.push(reference(
                        &writer,
                        &about.outputs[row].name,
                        matrix,
                        &about.states[state].name,
                    ));
                }
                _ => lines.extend(
                    nonzeros
                        .iter()
                        .map(|(entry, value)| (place(about, &writer, entry), writer.write(*value))),
                ),
            }
        }
        (matrix, lines)
    };
    let all = [Matrix::A, Matrix::B, Matrix::C, Matrix::D].map(of);
    all.into_iter().filter(|(_, lines)| !lines.is_empty()).collect()
}

fn rows(about: &About, matrix: Matrix) -> usize {
    match matrix {
        Matrix::A | Matrix::B => about.states.len(),
        Matrix::C | Matrix::D => about.outputs.len(),
    }
}

/// The nonzeros of a row.
fn row(compiled: &Compiled, matrix: Matrix, row: usize) -> &[(Entry, Expr)] {
    let nonzeros = compiled.linear.matrices.as_slice();
    let before = |of: &Entry, last: bool| {
        let own = (of.matrix, usize::from(of.row));
        own < (matrix, row) || last && own == (matrix, row)
    };
    let first = nonzeros.partition_point(|(entry, _)| before(entry, false));
    let last = nonzeros.partition_point(|(entry, _)| before(entry, true));
    &nonzeros[first..last]
}

/// The columns and values of two rows, of A and B or of C and D.
type Rate = [Vec<(u16, Expr)>; 2];

fn rate(compiled: &Compiled, matrices: [Matrix; 2], place: usize) -> Rate {
    let values = |matrix| {
        let nonzeros = row(compiled, matrix, place).iter();
        nonzeros.map(|&(entry, value)| (entry.column, value)).collect()
    };
    matrices.map(values)
}

/// The states by their rows of A and B.
struct SameRates(BTreeMap<Rate, usize>);

impl SameRates {
    fn of(compiled: &Compiled) -> Self {
        // Of states with the same rate, the first one counts.
        let states = (0..compiled.about.states.len()).rev();
        SameRates(
            states
                .map(|state| (rate(compiled, [Matrix::A, Matrix::B], state), state))
                .collect(),
        )
    }

    /// The state whose rate an output is.
    fn state(&self, compiled: &Compiled, matrix: Matrix, output: usize) -> Option<usize> {
        let is_output = matches!(matrix, Matrix::C | Matrix::D);
        is_output.then(|| self.0.get(&rate(compiled, [Matrix::C, Matrix::D], output)).copied())?
    }
}

/// `[z_body_acceleration, ·] = A[vz_body, ·]`
fn reference(writer: &Writer, output: &str, matrix: Matrix, state: &str) -> (String, String) {
    let of_rates = if matrix == Matrix::C { Matrix::A } else { Matrix::B };
    let row = |name: &str| format!("[{}, {}]", writer.identifier(name), writer.any());
    (row(output), format!("{of_rates:?}{}", row(state)))
}

fn place(about: &About, writer: &Writer, entry: &Entry) -> String {
    let (row, column) = about.relates(entry);
    format!("[{}, {}]", writer.identifier(row), writer.identifier(column))
}
