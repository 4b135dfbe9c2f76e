//! The matrices of a model at rest, and dense ones.

use nalgebra::DMatrix;

use crate::model::{About, Matrix, Model};

fn rest(about: &About) -> (Vec<f64>, Vec<f64>) {
    (vec![0.0; about.states.len()], vec![0.0; about.inputs.len()])
}

/// The nonzeros of A, B, C and D at rest, in the order of [`About::matrices`].
pub fn at_rest(model: &(impl Model + ?Sized), p: &[f64]) -> Vec<f64> {
    let (x, u) = rest(model.about());
    let mut nonzeros = vec![0.0; model.about().matrices.len()];
    model.matrices(p, &x, &u, &mut nonzeros);
    nonzeros
}

/// The nonzeros of their parameter Jacobians at rest, in the order of [`About::sensitivities`].
pub fn sensitivities_at_rest(model: &(impl Model + ?Sized), p: &[f64]) -> Vec<f64> {
    let (x, u) = rest(model.about());
    let mut nonzeros = vec![0.0; model.about().sensitivities.len()];
    model.sensitivities(p, &x, &u, &mut nonzeros);
    nonzeros
}

/// One of the matrices in dense form, from the nonzeros of all.
pub(crate) fn dense(about: &About, which: Matrix, nonzeros: &[f64]) -> DMatrix<f64> {
    let rows = match which {
        Matrix::A | Matrix::B => about.states.len(),
        Matrix::C | Matrix::D => about.outputs.len(),
    };
    let columns = match which {
        Matrix::A | Matrix::C => about.states.len(),
        Matrix::B | Matrix::D => about.inputs.len(),
    };
    let mut dense = DMatrix::zeros(rows, columns);
    for (entry, &value) in about.matrices.iter().zip(nonzeros) {
        if entry.matrix == which {
            dense[(usize::from(entry.row), usize::from(entry.column))] = value;
        }
    }
    dense
}
