//! The matrices of a model at rest.

use crate::model::{About, Model};

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
