//! The kinetic energy of masses and inerters together.

use super::Scratch;
use super::sample::{bounds, uniform};
use crate::expr::{CoordinateId, Expr, Symbol};
use crate::model::{CoordinateKind, Term};

/// Number of parameter sets within the declared ranges that are tried.
const TRIALS: u64 = 256;

/// Checks that no motion has a negative kinetic energy, for all parameters with positive masses. A rigid body on two
/// supports may be two masses with a negative inertance between them.
pub fn stays_positive(scratch: &Scratch) -> bool {
    (0..TRIALS).filter_map(|trial| matrix(scratch, trial)).all(is_positive)
}

/// The inertias of masses and inerters; `None` where a mass is not positive or a parameter has no range.
fn matrix(scratch: &Scratch, trial: u64) -> Option<Vec<Vec<f64>>> {
    let model = scratch.model;
    let size = model.coordinates.len();
    let mut matrix = vec![vec![0.0; size]; size];
    for (c, coordinate) in model.coordinates.iter().enumerate() {
        // A coordinate without a mass is moved by others.
        matrix[c][c] = match coordinate.kind {
            CoordinateKind::Mass(inertia) => value(scratch, trial, inertia).filter(|mass| *mass > 0.0)?,
            _ => f64::MIN_POSITIVE,
        };
    }
    for link in &model.links {
        let held: Vec<(CoordinateId, f64)> = link
            .stretch
            .iter()
            .map(|&(c, factor)| Some((c, value(scratch, trial, factor)?)))
            .collect::<Option<_>>()?;
        for term in &link.law.terms {
            let Term::Inerter(inertance) = *term else { continue };
            let inertance = value(scratch, trial, inertance)?;
            for (a, by_a) in &held {
                held.iter()
                    .for_each(|(b, by_b)| matrix[usize::from(a.0)][usize::from(b.0)] += inertance * by_a * by_b);
            }
        }
    }
    Some(matrix)
}

fn value(scratch: &Scratch, trial: u64, e: Expr) -> Option<f64> {
    let parameters = &scratch.model.parameters;
    let known = |symbol: Symbol| match symbol {
        Symbol::Parameter(index) => {
            let (low, high) = bounds(scratch.model, &parameters[usize::from(index)])?;
            Some(low + (high - low) * uniform(trial, 1000 + u64::from(index)))
        }
        _ => None,
    };
    let decided = scratch
        .graph
        .symbols([e])
        .into_iter()
        .all(|symbol| known(symbol).is_some());
    decided.then(|| scratch.graph.evaluate(e, &|symbol| known(symbol).unwrap_or_default()))
}

/// True if a symmetric matrix is positive definite, by elimination.
fn is_positive(mut matrix: Vec<Vec<f64>>) -> bool {
    for pivot in 0..matrix.len() {
        if matrix[pivot][pivot] <= 0.0 {
            return false;
        }
        let row = matrix[pivot].clone();
        for below in matrix.iter_mut().skip(pivot + 1) {
            let factor = below[pivot] / row[pivot];
            below
                .iter_mut()
                .zip(&row)
                .for_each(|(entry, above)| *entry -= factor * above);
        }
    }
    true
}
