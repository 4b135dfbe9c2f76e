//! Natural frequencies and damping ratios, with their derivatives.

use nalgebra::{Complex, DMatrix};
use std::f64::consts::TAU;

use crate::matrices::sensitivities_at_rest;
use crate::model::{Matrix, Model};
use crate::modes::{Eigenvectors, dynamics, vibrations};

/// A mode: its `[frequency in Hz, damping ratio]`, and the derivatives of both along each direction.
pub(super) struct Vibration {
    pub value: [f64; 2],
    pub slopes: Vec<[f64; 2]>,
}

/// The modes of a model, lowest frequency first, with their derivatives along directions of the parameters.
///
/// An eigenvalue moves by `wᵀ dA v / wᵀ v`, with its right and left vectors (Fox and Kapoor, AIAA J. 6, 1968).
pub(super) fn of(model: &dyn Model, p: &[f64], directions: &[Vec<f64>]) -> Vec<Vibration> {
    let a = dynamics(model, p);
    let moved: Vec<DMatrix<f64>> = directions.iter().map(|direction| change(model, p, direction)).collect();
    let sides = (!moved.is_empty()).then(|| [&a, &a.transpose()].map(Eigenvectors::of));
    let vibration = |root: Complex<f64>| Vibration {
        value: [root.norm() / TAU, -root.re / root.norm()],
        slopes: sides.as_ref().map_or_else(Vec::new, |sides| {
            let [right, left] = sides.each_ref().map(|side| side.nearest(root));
            let scale = left.dot(&right);
            let by = |da: &DMatrix<f64>| slope(root, left.dot(&(da.map(Complex::from) * &right)) / scale);
            moved.iter().map(by).collect()
        }),
    };
    vibrations(&a).into_iter().map(vibration).collect()
}

/// Derivatives of frequency and damping ratio, given that of the eigenvalue.
fn slope(root: Complex<f64>, moved: Complex<f64>) -> [f64; 2] {
    let size = root.norm();
    let grown = (root.conj() * moved).re / size;
    [grown / TAU, (-moved.re + root.re * grown / size) / size]
}

/// The derivative of A at rest along a direction.
fn change(model: &dyn Model, p: &[f64], direction: &[f64]) -> DMatrix<f64> {
    let about = model.about();
    let nonzeros = sensitivities_at_rest(model, p);
    let mut change = DMatrix::zeros(about.states.len(), about.states.len());
    for ((entry, parameter), &value) in about.sensitivities.iter().zip(&nonzeros) {
        if entry.matrix == Matrix::A {
            change[(usize::from(entry.row), usize::from(entry.column))] += value * direction[usize::from(*parameter)];
        }
    }
    change
}
