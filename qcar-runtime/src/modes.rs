//! Free vibration of a model: natural frequencies, damping ratios and mode shapes.
//!
//! The equations of motion are linearised at rest, `dx = A x`; a mode is a pair of complex eigenvalues of A with its
//! eigenvector. See Ewins, "Modal Testing", 2nd ed., section 2.5, for modes of nonproportional damping.

// Eigenvectors by inverse iteration.
mod eigenvector;
// Eigenvalues near a number.
mod ritz;
// Whether all eigenvalues within a circle are known.
mod enclosed;
// The lowest vibrations.
mod lowest;

use std::collections::BTreeMap;
use std::f64::consts::TAU;

use nalgebra::{Complex, DVector};

use eigenvector::eigenvectors;
pub(crate) use eigenvector::{are_equal, eigenvector};

use crate::banded::Ordered;
use crate::matrices::at_rest;
use crate::model::{Matrix, Model, StateKind};
use crate::response::parameters::Values;

/// A mode.
#[derive(Clone, Debug, PartialEq)]
pub struct Mode {
    /// Undamped natural frequency `|λ| / 2π`, Hz.
    pub frequency: f64,
    /// Damping ratio `-Re λ / |λ|`, below 1; zero if it is a rounding error.
    pub damping: f64,
    /// Motion of every point; the largest amplitude is 1.
    pub shape: Vec<Part>,
}

/// Motion of a point in a mode.
#[derive(Clone, Debug, PartialEq)]
pub struct Part {
    /// The mass or node.
    pub location: String,
    /// `z`, `x`.
    pub axis: String,
    /// Amplitude over that of the largest, and phase to it.
    pub amplitude: Complex<f64>,
}

/// Frequency below which a mode counts as a rigid motion of the axle along the road, Hz.
const RIGID: f64 = 0.01;

/// Damping ratios below this are the rounding errors of an undamped mode: those of its eigenvalue are some 1e-12.
const UNDAMPED: f64 = 1e-9;

/// Points with an amplitude below this share of the largest count as at rest.
const STILL: f64 = 1e-6;

/// The modes of a model, lowest frequency first. Eigenvalues without oscillation are left out.
pub fn modes(model: &(impl Model + ?Sized), values: &Values) -> Vec<Mode> {
    let a = dynamics(model, values.as_slice());
    let roots = vibrations(&a);
    let mode = |(root, shape)| Mode {
        frequency: frequency(root),
        damping: damping(root),
        shape,
    };
    let shapes = shapes(model, &a, &roots);
    roots.into_iter().zip(shapes).map(mode).collect()
}

/// Frequency (Hz) and damping ratio of each mode, without its shape.
pub fn frequencies(model: &(impl Model + ?Sized), values: &Values) -> Vec<(f64, f64)> {
    let roots = vibrations(&dynamics(model, values.as_slice())).into_iter();
    roots.map(|root| (frequency(root), damping(root))).collect()
}

/// Eigenvalue of each mode with positive imaginary part, lowest frequency first.
pub(crate) fn vibrations(a: &Ordered) -> Vec<Complex<f64>> {
    eigenvalues(a).into_iter().filter(vibrates).collect()
}

/// All eigenvalues, lowest frequency first.
pub(crate) fn eigenvalues(a: &Ordered) -> Vec<Complex<f64>> {
    // A model without masses has no modes, and the Schur form of a matrix with NaN would not converge.
    if a.order().is_empty() || !a.is_finite() {
        return Vec::new();
    }
    let mut roots: Vec<Complex<f64>> = a.dense().complex_eigenvalues().iter().copied().collect();
    roots.sort_by(|a, b| frequency(*a).total_cmp(&frequency(*b)));
    roots
}

/// The same for the modes of lowest frequency, at least `count` of them if there are so many. Those of a large matrix
/// are computed without all the others, where this is certain to find the same.
pub(crate) fn first_vibrations(a: &Ordered, count: usize) -> Vec<Complex<f64>> {
    lowest::lowest_vibrations(a, count).unwrap_or_else(|| vibrations(a))
}

pub(crate) fn vibrates(root: &Complex<f64>) -> bool {
    root.im > 1e-6 * root.norm() && !is_rigid(*root)
}

/// True for the eigenvalue of a motion that nothing holds.
pub(crate) fn is_rigid(root: Complex<f64>) -> bool {
    root.norm() <= TAU * RIGID
}

pub(crate) fn frequency(root: Complex<f64>) -> f64 {
    root.norm() / TAU
}

/// Damping ratio of an eigenvalue; zero if it is a rounding error.
pub(crate) fn damping(root: Complex<f64>) -> f64 {
    let ratio = -root.re / root.norm();
    if ratio.abs() < UNDAMPED { 0.0 } else { ratio }
}

/// Pairs of modes of two models that correspond, by their positions in both lists; each mode is in at most one pair.
///
/// The most similar pairs are chosen first, down to a similarity of one half.
pub fn pairs(first: &[Mode], second: &[Mode]) -> Vec<(usize, usize)> {
    let mut points = BTreeMap::new();
    let [one, other] = [first, second].map(|modes| {
        let moved = modes.iter().map(|mode| IndexedShape::of(mode, &mut points));
        moved.collect::<Vec<_>>()
    });
    let all = (0..first.len()).flat_map(|a| (0..second.len()).map(move |b| (a, b)));
    let mut likely: Vec<_> = all.map(|(a, b)| (likeness(&one[a], &other[b]), a, b)).collect();
    likely.sort_by(|one, other| other.0.total_cmp(&one.0));
    let mut pairs: Vec<(usize, usize)> = Vec::new();
    for (likeness, a, b) in likely {
        if likeness >= 0.5 && pairs.iter().all(|pair| pair.0 != a && pair.1 != b) {
            pairs.push((a, b));
        }
    }
    pairs.sort_unstable();
    pairs
}

/// The shape of a mode by the numbers of its points, so that shapes are compared without comparing names.
struct IndexedShape {
    shape: Vec<(usize, Complex<f64>)>,
    by_point: Vec<Option<Complex<f64>>>,
    /// The sum of the squares of all amplitudes.
    square: f64,
}

impl IndexedShape {
    /// Numbers the points of a mode; a point that is not in `points` gets the next number.
    fn of<'m>(mode: &'m Mode, points: &mut BTreeMap<(&'m str, &'m str), usize>) -> Self {
        let (mut shape, mut by_point) = (Vec::new(), Vec::new());
        for part in &mode.shape {
            let next = points.len();
            let point = *points
                .entry((part.location.as_str(), part.axis.as_str()))
                .or_insert(next);
            if by_point.len() <= point {
                by_point.resize(point + 1, None);
            }
            by_point[point] = Some(part.amplitude);
            shape.push((point, part.amplitude));
        }
        let square = shape.iter().map(|(_, amplitude)| amplitude.norm_sqr()).sum();
        IndexedShape {
            shape,
            by_point,
            square,
        }
    }

    fn at(&self, point: usize) -> Option<Complex<f64>> {
        self.by_point.get(point).copied().flatten()
    }
}

/// The modal assurance criterion `|a·b|² / (|a|² |b|²)` over the points that both models have (Allemang, "The Modal
/// Assurance Criterion", Sound and Vibration 37 (2003)), times the share of these points in both modes: a mode of
/// points that only one model has resembles none of the other.
fn likeness(first: &IndexedShape, second: &IndexedShape) -> f64 {
    let square = |of: &IndexedShape, among: &IndexedShape| {
        let common = of.shape.iter().filter(|(point, _)| among.at(*point).is_some());
        common.map(|(_, amplitude)| amplitude.norm_sqr()).sum::<f64>()
    };
    let product = |&(point, amplitude): &(usize, Complex<f64>)| Some(amplitude.conj() * second.at(point)?);
    let product: Complex<f64> = first.shape.iter().filter_map(product).sum();
    let whole = (first.square * second.square).sqrt();
    let common = (square(first, second) * square(second, first)).sqrt();
    if common > 0.0 {
        product.norm_sqr() / (common * whole)
    } else {
        0.0
    }
}

/// The matrix A at rest.
pub(crate) fn dynamics(model: &(impl Model + ?Sized), p: &[f64]) -> Ordered {
    let about = model.about();
    let entries = about.matrices.iter().zip(at_rest(model, p));
    let nonzeros = entries.filter(|(entry, value)| entry.matrix == Matrix::A && *value != 0.0);
    let nonzeros = nonzeros.map(|(entry, value)| (usize::from(entry.row), usize::from(entry.column), value));
    Ordered::of(about.states.len(), &nonzeros.collect::<Vec<_>>())
}

/// For each eigenvalue, the motion of every point; the largest amplitude is 1.
pub(crate) fn shapes(model: &(impl Model + ?Sized), a: &Ordered, roots: &[Complex<f64>]) -> Vec<Vec<Part>> {
    let vectors = eigenvectors(a, roots);
    vectors.iter().map(|vector| shape(model, vector)).collect()
}

/// The motion of every point in an eigenvector.
fn shape(model: &(impl Model + ?Sized), vector: &DVector<Complex<f64>>) -> Vec<Part> {
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
    let parts = positions.iter().map(part);
    parts.filter(|part| part.amplitude.norm() > STILL).collect()
}
