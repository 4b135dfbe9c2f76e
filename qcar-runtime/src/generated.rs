//! Support for generated models.
//!
//! Here slices become arrays of fixed size, once for a call, so that no bounds check is left in straight-line code; and
//! `in_vectors` runs that code over vectors of several parameter sets, or of several lines of a frequency response.

// Straight-line code over vectors.
mod in_vectors;

use std::ops::Index;

use nalgebra::SMatrix;

use crate::model::{About, Entry, Matrix};
pub use crate::vectors::{Eight, Four, LinesMut, sign, table};
pub use in_vectors::{OverLines, Responds, Sets, one, respond, respond_sets, together};

/// The state-space form `dx = A x + B u`, `y = C x + D u` of a model with N states, M inputs and O outputs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StateSpace<const N: usize, const M: usize, const O: usize> {
    /// ∂f/∂x
    pub a: SMatrix<f64, N, N>,
    /// ∂f/∂u
    pub b: SMatrix<f64, N, M>,
    /// ∂h/∂x
    pub c: SMatrix<f64, O, N>,
    /// ∂h/∂u
    pub d: SMatrix<f64, O, M>,
}

impl<const N: usize, const M: usize, const O: usize> StateSpace<N, M, O> {
    /// All zero.
    pub fn zeros() -> Self {
        StateSpace {
            a: SMatrix::zeros(),
            b: SMatrix::zeros(),
            c: SMatrix::zeros(),
            d: SMatrix::zeros(),
        }
    }
}

/// The derivatives of A, B, C and D by each parameter, dense and by name: `jacobians.a["k_tire"]` is ∂A/∂k_tire.
#[derive(Clone, Debug, PartialEq)]
pub struct Jacobians<const N: usize, const M: usize, const O: usize> {
    /// Derivatives of A.
    pub a: ByParameter<SMatrix<f64, N, N>>,
    /// Derivatives of B.
    pub b: ByParameter<SMatrix<f64, N, M>>,
    /// Derivatives of C.
    pub c: ByParameter<SMatrix<f64, O, N>>,
    /// Derivatives of D.
    pub d: ByParameter<SMatrix<f64, O, M>>,
}

impl<const N: usize, const M: usize, const O: usize> Jacobians<N, M, O> {
    /// Builds the matrices from their nonzeros and the positions of these.
    pub fn new(names: &'static [&'static str], places: &[(Entry, u16)], nonzeros: &[f64]) -> Self {
        let mut all = Jacobians {
            a: ByParameter::zeros(names),
            b: ByParameter::zeros(names),
            c: ByParameter::zeros(names),
            d: ByParameter::zeros(names),
        };
        for ((entry, parameter), &nonzero) in places.iter().zip(nonzeros) {
            let at = (usize::from(entry.row), usize::from(entry.column));
            let parameter = usize::from(*parameter);
            match entry.matrix {
                Matrix::A => all.a.matrices[parameter][at] = nonzero,
                Matrix::B => all.b.matrices[parameter][at] = nonzero,
                Matrix::C => all.c.matrices[parameter][at] = nonzero,
                Matrix::D => all.d.matrices[parameter][at] = nonzero,
            }
        }
        all
    }
}

/// A matrix for each parameter, found by its name.
#[derive(Clone, Debug, PartialEq)]
pub struct ByParameter<T> {
    names: &'static [&'static str],
    matrices: Vec<T>,
}

impl<T> ByParameter<T> {
    /// The matrix of a parameter; `None` if the model has no parameter of this name.
    pub fn get(&self, name: &str) -> Option<&T> {
        let place = self.names.iter().position(|own| *own == name)?;
        Some(&self.matrices[place])
    }

    /// Every parameter with its matrix, in the order of the model.
    pub fn iter(&self) -> impl Iterator<Item = (&'static str, &T)> {
        self.names.iter().copied().zip(&self.matrices)
    }
}

impl<const R: usize, const C: usize> ByParameter<SMatrix<f64, R, C>> {
    fn zeros(names: &'static [&'static str]) -> Self {
        let matrices = vec![SMatrix::zeros(); names.len()];
        ByParameter { names, matrices }
    }
}

impl<T> Index<&str> for ByParameter<T> {
    type Output = T;

    /// # Panics
    ///
    /// If the model has no parameter of this name; [`ByParameter::get`] returns `None` instead.
    #[track_caller]
    fn index(&self, name: &str) -> &T {
        self.get(name)
            .unwrap_or_else(|| panic!("no parameter `{name}`; there are {}", self.names.join(", ")))
    }
}

/// The first `N` values of a slice.
///
/// # Panics
///
/// If there are fewer.
#[inline]
#[track_caller]
pub fn fixed<T, const N: usize>(slice: &[T]) -> &[T; N] {
    slice.first_chunk().unwrap_or_else(|| too_short(slice.len(), N))
}

/// The first `N` values of a slice, to be written.
///
/// # Panics
///
/// If there are fewer.
#[inline]
#[track_caller]
pub fn fixed_mut<T, const N: usize>(slice: &mut [T]) -> &mut [T; N] {
    let length = slice.len();
    slice.first_chunk_mut().unwrap_or_else(|| too_short(length, N))
}

#[cold]
#[track_caller]
fn too_short(length: usize, needed: usize) -> ! {
    panic!("a slice of {length} values where a model needs {needed}")
}

/// Panics because a model has no such excitation.
///
/// # Panics
///
/// Always.
#[cold]
#[track_caller]
pub fn no_response(about: &About, excitation: usize) -> ! {
    panic!(
        "excitation {excitation} of {}, which has {}",
        about.name,
        about.responses.len()
    )
}
