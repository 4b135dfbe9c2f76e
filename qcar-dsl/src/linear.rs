//! Equations to matrices and their parameter Jacobians.
//!
//! Derivatives follow the factored equations: the law of a link is differentiated once by its own arguments, and the
//! chain rule carries that through the definitions, so that every entry shares what the links have in common.

use crate::about::{Entry, Matrix};
use crate::check::Checked;
use crate::expr::{Differential, Expr, Graph, Symbol};
use crate::motion::Motion;

/// The Jacobians of the equations of motion, nonzeros only, in states, inputs, parameters and the definitions of the
/// equations.
#[derive(Clone, Debug)]
pub struct Linear {
    /// True where A, B, C and D depend on the parameters alone.
    pub linear: bool,
    /// A = ∂f/∂x, B = ∂f/∂u, C = ∂h/∂x and D = ∂h/∂u, matrix after matrix, row after row.
    pub matrices: Vec<(Entry, Expr)>,
    /// Their derivatives by a parameter, parameter after parameter.
    pub sensitivities: Vec<(Entry, u16, Expr)>,
    /// ∂f/∂p and ∂h/∂p: is it an output, row, parameter; row after row.
    pub parameter_jacobian: Vec<(bool, u16, u16, Expr)>,
}

/// Differentiates the equations by states, inputs and parameters.
pub fn linearise(model: &Checked, motion: &Motion, graph: &mut Graph) -> Linear {
    let slopes = slopes_of_laws(motion, graph);
    let mut matrices = Vec::new();
    for (columns, of_rates, of_outputs) in [
        (&motion.states, Matrix::A, Matrix::C),
        (&motion.inputs, Matrix::B, Matrix::D),
    ] {
        for (column, &leaf) in columns.iter().enumerate() {
            let mut by = total_derivative(motion, graph, &slopes, leaf);
            for (matrix, rows) in [(of_rates, &motion.rates), (of_outputs, &motion.outputs)] {
                for (row, value) in nonzeros(graph, &mut by, rows.iter().copied()) {
                    matrices.push((
                        Entry {
                            matrix,
                            row: row as u16,
                            column: column as u16,
                        },
                        value,
                    ));
                }
            }
        }
    }
    matrices.sort_by_key(|&(entry, _)| entry);
    let mut sensitivities = Vec::new();
    let mut parameter_jacobian = Vec::new();
    for p in 0..model.parameters.len() as u16 {
        let mut by = total_derivative(motion, graph, &slopes, Symbol::Parameter(p));
        let entries = nonzeros(graph, &mut by, matrices.iter().map(|&(_, value)| value));
        sensitivities.extend(entries.into_iter().map(|(place, value)| (matrices[place].0, p, value)));
        for (is_output, rows) in [(false, &motion.rates), (true, &motion.outputs)] {
            let entries = nonzeros(graph, &mut by, rows.iter().copied());
            parameter_jacobian.extend(
                entries
                    .into_iter()
                    .map(|(row, value)| (is_output, row as u16, p, value)),
            );
        }
    }
    parameter_jacobian.sort_by_key(|&(is_output, row, p, _)| (is_output, row, p));
    let leaves = graph.symbols(matrices.iter().map(|&(_, value)| value));
    let linear = leaves.iter().all(|leaf| matches!(leaf, Symbol::Parameter(_)));
    Linear {
        linear,
        matrices,
        sensitivities,
        parameter_jacobian,
    }
}

/// A law with its slopes by each of its arguments.
type Slopes = Vec<(Symbol, Vec<(Symbol, Expr)>)>;

fn slopes_of_laws(motion: &Motion, graph: &mut Graph) -> Slopes {
    let laws = motion
        .definitions
        .iter()
        .filter(|(symbol, _)| matches!(symbol, Symbol::LinkForce(_)));
    laws.map(|&(symbol, law)| {
        let arguments = graph.symbols([law]);
        let slope = |leaf| (leaf, Differential::by(graph, leaf).of(graph, law));
        (symbol, arguments.into_iter().map(slope).collect())
    })
    .collect()
}

/// The derivative by one leaf through all definitions.
fn total_derivative(motion: &Motion, graph: &mut Graph, slopes: &Slopes, leaf: Symbol) -> Differential {
    let mut by = Differential::by(graph, leaf);
    for &(symbol, value) in &motion.definitions {
        let change = match slopes.iter().find(|(law, _)| *law == symbol) {
            Some((_, slopes)) => chain(graph, &by, slopes),
            None => by.of(graph, value),
        };
        if graph.as_constant(change) != Some(0.0) {
            by.set(symbol, change);
        }
    }
    by
}

/// `Σ slope change(argument)`
fn chain(graph: &mut Graph, by: &Differential, slopes: &[(Symbol, Expr)]) -> Expr {
    let mut sum = graph.constant(0.0);
    for &(argument, slope) in slopes {
        if let Some(change) = by.leaf(argument) {
            let term = graph.mul(slope, change);
            sum = graph.add(sum, term);
        }
    }
    sum
}

/// The derivatives that are not structurally zero, with their places.
fn nonzeros(graph: &mut Graph, by: &mut Differential, values: impl Iterator<Item = Expr>) -> Vec<(usize, Expr)> {
    let all: Vec<Expr> = values.map(|value| by.of(graph, value)).collect();
    all.into_iter()
        .enumerate()
        .filter(|&(_, value)| graph.as_constant(value) != Some(0.0))
        .collect()
}
