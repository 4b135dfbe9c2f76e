//! Support for generated models.
//!
//! Slices become arrays of fixed size once per call, so that straight-line code needs no bounds checks. A frequency
//! response is cut into blocks of lines, over which that code runs in a loop that LLVM vectorises.

use std::ops::Index;

use nalgebra::SMatrix;

use crate::model::{About, Entry, LANES, Lanes, Matrix, ResponseMut};
use crate::vectors::{Loops, widest};

/// Number of lines of a frequency response that are computed together: a cache line of each row.
pub const LINES: usize = LANES;

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

/// A derivative at `x`, of an order from 0 to 3, of the piecewise cubic curve through points, which continues as a
/// straight line beyond its ends. At a knot, derivatives above the first are those of the piece above it.
pub fn table<const N: usize>(order: u8, x: f64, knots: &[f64; N], values: &[f64; N], slopes: &[f64; N]) -> f64 {
    let right = knots.partition_point(|&knot| knot <= x);
    let left = right.saturating_sub(1);
    let t = x - knots[left];
    let (mut square, mut cube) = (0.0, 0.0);
    if right > 0 && right < N {
        let width = knots[right] - knots[left];
        let secant = (values[right] - values[left]) / width;
        square = (3.0 * secant - 2.0 * slopes[left] - slopes[right]) / width;
        cube = (slopes[left] + slopes[right] - 2.0 * secant) / (width * width);
    }
    match order {
        0 => values[left] + t * (slopes[left] + t * (square + t * cube)),
        1 => slopes[left] + t * (2.0 * square + t * (3.0 * cube)),
        2 => 2.0 * square + t * (6.0 * cube),
        _ => 6.0 * cube,
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

/// -1, 0 or 1; the sign of zero is 0.
#[inline]
pub fn sign(value: f64) -> f64 {
    if value == 0.0 { 0.0 } else { value.signum() }
}

/// The straight-line code of a frequency response: `R` rows at a block of lines.
///
/// `compute` must be marked `inline(always)`, since it is compiled once for each instruction set that [`respond`]
/// supports.
pub trait Block<const R: usize> {
    /// The rows at these frequencies, rad/s.
    fn compute(&self, frequencies: &[f64; LINES], rows: &mut [[f64; LINES]; R]);
}

/// Runs `block` over all lines and stores its rows: real parts, imaginary parts, and both parts of the Jacobian.
///
/// # Panics
///
/// If `into` does not have `R` rows of `omega.len()` lines.
#[inline]
pub fn respond<const R: usize>(omega: &[f64], mut into: ResponseMut<'_>, block: &impl Block<R>) {
    let jacobian = into.jacobian.as_ref().map_or(0, |(re, im)| re.len() + im.len());
    assert_eq!(
        into.re.len() + into.im.len() + jacobian,
        R * omega.len(),
        "a response has {R} rows"
    );
    let mut rows = [[0.0; LINES]; R];
    let compute = |frequencies: &[f64; LINES], rows: &mut [[f64; LINES]; R]| {
        widest(Lines {
            block,
            frequencies,
            rows,
        });
    };
    let (chunks, rest) = omega.as_chunks::<LINES>();
    for (place, frequencies) in chunks.iter().enumerate() {
        compute(frequencies, &mut rows);
        scatter(&rows, &mut into, omega.len(), place * LINES, LINES);
    }
    if let Some(&last) = rest.last() {
        let mut frequencies = [last; LINES];
        frequencies[..rest.len()].copy_from_slice(rest);
        compute(&frequencies, &mut rows);
        scatter(&rows, &mut into, omega.len(), chunks.len() * LINES, rest.len());
    }
}

/// Straight-line code for several parameter sets at once, with `R` results.
///
/// `compute` must be marked `inline(always)`, since it is compiled once for each instruction set that [`together`]
/// supports.
pub trait Sets<const R: usize> {
    /// The results, a row for each.
    fn compute(&self, rows: &mut [Lanes; R]);
}

/// Computes `sets` with the widest vectors of this machine.
///
/// # Panics
///
/// If there are fewer rows than results.
#[inline]
pub fn together<const R: usize>(sets: &impl Sets<R>, rows: &mut [Lanes]) {
    let rows = fixed_mut(rows);
    widest(Together { sets, rows });
}

struct Together<'a, S, const R: usize> {
    sets: &'a S,
    rows: &'a mut [Lanes; R],
}

impl<S: Sets<R>, const R: usize> Loops for Together<'_, S, R> {
    type Result = ();

    #[inline(always)]
    fn run(self) {
        self.sets.compute(self.rows);
    }
}

/// A block of lines that is to be computed.
struct Lines<'a, B, const R: usize> {
    block: &'a B,
    frequencies: &'a [f64; LINES],
    rows: &'a mut [[f64; LINES]; R],
}

impl<B: Block<R>, const R: usize> Loops for Lines<'_, B, R> {
    type Result = ();

    #[inline(always)]
    fn run(self) {
        self.block.compute(self.frequencies, self.rows);
    }
}

/// Copies a block of `count` lines from `start` on to the rows of the whole response.
fn scatter(rows: &[[f64; LINES]], into: &mut ResponseMut<'_>, lines: usize, start: usize, count: usize) {
    let mut rows = rows.iter();
    let (re, im) = match &mut into.jacobian {
        Some((re, im)) => (&mut re[..], &mut im[..]),
        None => (&mut [][..], &mut [][..]),
    };
    for part in [&mut into.re[..], &mut into.im[..], re, im] {
        for (to, from) in part.chunks_exact_mut(lines).zip(&mut rows) {
            match to[start..].first_chunk_mut::<LINES>() {
                Some(whole) if count == LINES => *whole = *from,
                _ => to[start..start + count].copy_from_slice(&from[..count]),
            }
        }
    }
}
