//! The matrices of a model at rest.

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

/// The matrix A at rest.
pub fn dynamics(model: &(impl Model + ?Sized), p: &[f64]) -> DMatrix<f64> {
    let states = model.about().states.len();
    let mut a = DMatrix::zeros(states, states);
    for (entry, value) in model.about().matrices.iter().zip(at_rest(model, p)) {
        if entry.matrix == Matrix::A {
            a[(usize::from(entry.row), usize::from(entry.column))] = value;
        }
    }
    a
}

/// The nonzeros of their parameter Jacobians at rest, in the order of [`About::sensitivities`].
pub fn sensitivities_at_rest(model: &(impl Model + ?Sized), p: &[f64]) -> Vec<f64> {
    let (x, u) = rest(model.about());
    let mut nonzeros = vec![0.0; model.about().sensitivities.len()];
    model.sensitivities(p, &x, &u, &mut nonzeros);
    nonzeros
}
