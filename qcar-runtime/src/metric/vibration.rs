//! Natural frequencies and damping ratios, with their derivatives.

use std::cell::OnceCell;
use std::f64::consts::TAU;

use nalgebra::Complex;

use crate::banded::Ordered;
use crate::matrices::sensitivities_at_rest;
use crate::model::{Matrix, Model};
use crate::modes::{damping, dynamics, eigenvector, first_vibrations, frequency};

/// Modes of a model, lowest frequency first, with derivatives along directions of the parameters.
pub(super) struct Vibrations<'d> {
    modes: Vec<Vibration>,
    directions: &'d [Vec<f64>],
    /// `None` without directions.
    gradient: Option<Gradient>,
}

struct Vibration {
    root: Complex<f64>,
    /// Derivatives of frequency and damping ratio along each direction, once they have been asked for.
    slopes: OnceCell<Vec<[f64; 2]>>,
}

impl<'d> Vibrations<'d> {
    /// At least the first `count` modes, or all if there are fewer.
    pub fn of(model: &dyn Model, p: &[f64], count: usize, directions: &'d [Vec<f64>]) -> Self {
        let a = dynamics(model, p);
        let vibration = |root| Vibration {
            root,
            slopes: OnceCell::new(),
        };
        Self {
            modes: first_vibrations(&a, count).into_iter().map(vibration).collect(),
            directions,
            gradient: (!directions.is_empty()).then(|| Gradient {
                sides: [a.transposed(), a],
                parameters: p.len(),
                nonzeros: nonzeros(model, p),
            }),
        }
    }

    pub fn count(&self) -> usize {
        self.modes.len()
    }

    /// Natural frequency in Hz and damping ratio of a mode, and the derivatives of both along each direction; `None` if
    /// the model has fewer modes.
    pub fn mode(&self, place: usize) -> Option<([f64; 2], &[[f64; 2]])> {
        let own = self.modes.get(place)?;
        let value = [frequency(own.root), damping(own.root)];
        Some((value, own.slopes.get_or_init(|| self.slopes(own.root))))
    }

    fn slopes(&self, root: Complex<f64>) -> Vec<[f64; 2]> {
        let Some(gradient) = &self.gradient else {
            return Vec::new();
        };
        let by_parameter = gradient.of(root);
        let along = |direction: &Vec<f64>| {
            let parts = by_parameter.iter().zip(direction);
            slope(root, parts.map(|(moved, by)| moved * by).sum())
        };
        self.directions.iter().map(along).collect()
    }
}

/// What the derivatives of the eigenvalues of A at rest need.
struct Gradient {
    /// The transpose of A, and A.
    sides: [Ordered; 2],
    /// Number of parameters.
    parameters: usize,
    /// Row, column and parameter of each nonzero of `∂A/∂p`, with its value.
    nonzeros: Vec<([usize; 3], f64)>,
}

impl Gradient {
    /// The derivative of an eigenvalue by each parameter.
    ///
    /// It is `wᵀ ∂A/∂p v / wᵀ v`, with its right and left vectors (Fox and Kapoor, AIAA J. 6, 1968).
    fn of(&self, root: Complex<f64>) -> Vec<Complex<f64>> {
        let [left, right] = self.sides.each_ref().map(|side| eigenvector(side, root));
        let scale = left.dot(&right);
        let mut gradient = vec![Complex::ZERO; self.parameters];
        for &([row, column, parameter], value) in &self.nonzeros {
            gradient[parameter] += left[row] * right[column] * value / scale;
        }
        gradient
    }
}

fn nonzeros(model: &dyn Model, p: &[f64]) -> Vec<([usize; 3], f64)> {
    let all = model.about().sensitivities.iter().zip(sensitivities_at_rest(model, p));
    let of_dynamics = all.filter(|((entry, _), _)| entry.matrix == Matrix::A);
    of_dynamics
        .map(|((entry, parameter), value)| ([entry.row, entry.column, *parameter].map(usize::from), value))
        .collect()
}

/// Derivatives of frequency and damping ratio, given that of the eigenvalue.
fn slope(root: Complex<f64>, moved: Complex<f64>) -> [f64; 2] {
    let size = root.norm();
    let grown = (root.conj() * moved).re / size;
    [grown / TAU, (-moved.re + root.re * grown / size) / size]
}
