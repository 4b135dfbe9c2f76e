//! How a model moves when nothing drives it: natural frequencies, damping ratios and shapes.
//!
//! The equations of motion are linearised at rest, `dx = A x`; a mode is a pair of complex eigenvalues of A with its
//! eigenvector. See Ewins, "Modal Testing", 2nd ed., section 2.5, for modes of nonproportional damping.

use std::f64::consts::TAU;

use nalgebra::{Complex, DMatrix, DVector};

use crate::model::{Matrix, Model, StateKind};
use crate::response::parameters::Values;

/// A natural vibration.
#[derive(Clone, Debug, PartialEq)]
pub struct Mode {
    /// Undamped natural frequency `|λ| / 2π`, Hz.
    pub frequency: f64,
    /// Damping ratio `-Re λ / |λ|`, below 1.
    pub damping: f64,
    /// The position of everything that moves in it; the largest is 1.
    pub shape: Vec<Part>,
}

/// What a point does in a mode.
#[derive(Clone, Debug, PartialEq)]
pub struct Part {
    /// The mass or node.
    pub location: String,
    /// `z`, `x`.
    pub axis: String,
    /// Amplitude over that of the largest, and phase to it.
    pub amplitude: Complex<f64>,
}

/// Modes below this frequency (Hz) are the axle drifting off as a whole, which nothing holds along the road.
const RIGID: f64 = 0.01;

/// Points that move less than this share of the largest stand still.
const STILL: f64 = 1e-6;

/// The vibrations of a model, lowest frequency first. What decays without vibrating is left out.
pub fn modes(model: &dyn Model, values: &Values) -> Vec<Mode> {
    let a = dynamics(model, values);
    let vibrates = |root: &Complex<f64>| root.im > 1e-6 * root.norm() && root.norm() > TAU * RIGID;
    // Nothing moves in a model without a mass, and what is not a number has no Schur form to wait for.
    if a.is_empty() || a.iter().any(|value| !value.is_finite()) {
        return Vec::new();
    }
    let roots = a.clone().complex_eigenvalues();
    let mut modes: Vec<Mode> = roots
        .iter()
        .filter(|root| vibrates(root))
        .map(|&root| mode(model, &a, root))
        .collect();
    modes.sort_by(|a, b| a.frequency.total_cmp(&b.frequency));
    modes
}

/// A at rest.
fn dynamics(model: &dyn Model, values: &Values) -> DMatrix<f64> {
    let about = model.about();
    let (x, u) = (vec![0.0; about.states.len()], vec![0.0; about.inputs.len()]);
    let mut nonzeros = vec![0.0; about.matrices.len()];
    model.matrices(values.as_slice(), &x, &u, &mut nonzeros);
    let mut a = DMatrix::zeros(x.len(), x.len());
    for (entry, &value) in about.matrices.iter().zip(&nonzeros) {
        if entry.matrix == Matrix::A {
            a[(usize::from(entry.row), usize::from(entry.column))] = value;
        }
    }
    a
}

fn mode(model: &dyn Model, a: &DMatrix<f64>, root: Complex<f64>) -> Mode {
    let vector = eigenvector(a, root);
    let states = model.about().states.iter().zip(vector.iter());
    let positions = states.filter(|(state, _)| state.kind == StateKind::Position);
    let positions: Vec<_> = positions.collect();
    let largest = positions.iter().map(|(_, value)| **value);
    let largest = largest.fold(Complex::ZERO, |a, b| if b.norm() > a.norm() { b } else { a });
    let part = |(state, value): &(&crate::model::State, &Complex<f64>)| Part {
        location: state.location.to_string(),
        axis: state.axis.to_string(),
        amplitude: *value / largest,
    };
    let shape = positions.iter().map(part).filter(|part| part.amplitude.norm() > STILL);
    Mode {
        frequency: root.norm() / TAU,
        damping: -root.re / root.norm(),
        shape: shape.collect(),
    }
}

/// The vector that `A - λ` takes to the smallest: inverse iteration from a shifted root.
fn eigenvector(a: &DMatrix<f64>, root: Complex<f64>) -> DVector<Complex<f64>> {
    const SHIFT: f64 = 1e-9;
    const STEPS: usize = 3;
    let count = a.nrows();
    let shifted = a.map(Complex::from) - DMatrix::from_diagonal_element(count, count, root * (1.0 + SHIFT));
    let factors = shifted.lu();
    let mut vector = DVector::from_fn(count, |row, _| Complex::new(1.0, row as f64 / count as f64));
    for _ in 0..STEPS {
        let next = factors.solve(&vector).unwrap_or_else(|| vector.clone());
        vector = next.unscale(next.norm());
    }
    vector
}
