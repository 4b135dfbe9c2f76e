//! Support for generated models.
//!
//! Here slices become arrays of fixed size, once for a call, so that few bounds checks are left in straight-line code; and
//! here that code runs over vectors of several parameter sets, or of several lines of a frequency response.

use std::marker::PhantomData;
use std::ops::Index;

use nalgebra::SMatrix;

use crate::model::{About, Contact, Contacts, Entry, LANES, Lanes, Matrix, ResponseMut};
pub use crate::vectors::Number;
use crate::vectors::{Straight, in_vectors};

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
    /// Of A.
    pub a: ByParameter<SMatrix<f64, N, N>>,
    /// Of B.
    pub b: ByParameter<SMatrix<f64, N, M>>,
    /// Of C.
    pub c: ByParameter<SMatrix<f64, O, N>>,
    /// Of D.
    pub d: ByParameter<SMatrix<f64, O, M>>,
}

impl<const N: usize, const M: usize, const O: usize> Jacobians<N, M, O> {
    /// Puts each nonzero where it belongs; all others are zero.
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
    /// The matrix of a parameter; none where the model has no parameter of this name.
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
    /// Where the model has no parameter of this name; [`ByParameter::get`] asks first.
    #[track_caller]
    fn index(&self, name: &str) -> &T {
        self.get(name)
            .unwrap_or_else(|| panic!("no parameter `{name}`; there are {}", self.names.join(", ")))
    }
}

/// A derivative of the piecewise cubic curve through points, of an order from 0 to 3, at `x`; beyond its ends it is a
/// straight line. At a knot, those above the first are of the piece above it.
#[inline(always)]
pub fn table<V: Number, const N: usize>(order: u8, x: V, knots: &[f64; N], values: &[V; N], slopes: &[V; N]) -> V {
    V::from_lanes(
        #[inline(always)]
        |lane| {
            let of_lane = |points: &[V; N]| points.map(|point| point.lane(lane));
            curve(order, x.lane(lane), knots, &of_lane(values), &of_lane(slopes))
        },
    )
}

fn curve<const N: usize>(order: u8, x: f64, knots: &[f64; N], values: &[f64; N], slopes: &[f64; N]) -> f64 {
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
/// Where there are fewer.
#[inline]
#[track_caller]
pub fn fixed<T, const N: usize>(slice: &[T]) -> &[T; N] {
    slice.first_chunk().unwrap_or_else(|| too_short(slice.len(), N))
}

/// The first `N` values of a slice, to be written.
///
/// # Panics
///
/// Where there are fewer.
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

/// Says that a model has no such excitation.
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

/// Where straight-line code reads `N` values.
pub trait Entries<V, const N: usize> {
    /// The value at a place.
    fn at(&self, place: usize) -> V;
}

/// One set of values, for all lanes.
impl<V: Number, const N: usize> Entries<V, N> for [f64; N] {
    #[inline(always)]
    fn at(&self, place: usize) -> V {
        V::of(self[place])
    }
}

/// Values of several parameter sets, from one of them on.
pub struct Rows<'a, const N: usize> {
    rows: &'a [Lanes; N],
    first: usize,
}

impl<'a, const N: usize> Rows<'a, N> {
    /// Those from the set `first` on.
    #[inline(always)]
    pub fn new(rows: &'a [Lanes; N], first: usize) -> Self {
        Rows { rows, first }
    }
}

impl<V: Number, const N: usize> Entries<V, N> for Rows<'_, N> {
    #[inline(always)]
    fn at(&self, place: usize) -> V {
        V::load(&self.rows[place][self.first..])
    }
}

/// What tyres that roll give to the sets from `first` on.
#[inline(always)]
pub fn contact<V: Number>(contacts: &Contacts, first: usize) -> Contact<V> {
    let of = |row: &Lanes| V::load(&row[first..]);
    Contact {
        s: of(&contacts.s),
        v: of(&contacts.v),
        force: [of(&contacts.force[0]), of(&contacts.force[1])],
    }
}

/// Where straight-line code puts its `N` results.
pub trait Results<V, const N: usize> {
    /// Puts one at its place.
    fn put(&mut self, place: usize, value: V);
}

impl<const N: usize> Results<f64, N> for [f64; N] {
    #[inline(always)]
    fn put(&mut self, place: usize, value: f64) {
        self[place] = value;
    }
}

/// Results of several parameter sets, from one of them on.
pub struct RowsMut<'a, const N: usize> {
    rows: &'a mut [Lanes; N],
    first: usize,
}

impl<V: Number, const N: usize> Results<V, N> for RowsMut<'_, N> {
    #[inline(always)]
    fn put(&mut self, place: usize, value: V) {
        value.store(&mut self.rows[place][self.first..]);
    }
}

/// Straight-line code for several parameter sets at once, with `R` results.
///
/// `compute` is to be inlined always: it is compiled once for each width of vectors that [`together`] knows.
pub trait Sets<const R: usize> {
    /// The results of the sets from `first` on.
    fn compute<V: Number>(&self, first: usize, out: &mut RowsMut<'_, R>);
}

/// Computes what is wanted of several parameter sets, with the widest vectors of this machine.
///
/// # Panics
///
/// Where there are fewer rows than results.
#[inline]
pub fn together<const R: usize>(sets: &impl Sets<R>, rows: &mut [Lanes]) {
    let rows = fixed_mut(rows);
    in_vectors(Together { sets, rows });
}

struct Together<'a, S, const R: usize> {
    sets: &'a S,
    rows: &'a mut [Lanes; R],
}

impl<S: Sets<R>, const R: usize> Straight for Together<'_, S, R> {
    #[inline(always)]
    fn run<V: Number>(self) {
        for group in 0..LANES / V::LANES {
            let (rows, first) = (&mut *self.rows, group * V::LANES);
            self.sets.compute::<V>(first, &mut RowsMut { rows, first });
        }
    }
}

/// The straight-line code of a frequency response with `N` outputs, over `C` constants.
///
/// `compute` is to be inlined always: it is compiled once for each width of vectors that [`respond`] knows.
pub trait Responds<const C: usize, const N: usize> {
    /// The rows at these frequencies, rad/s.
    fn compute<V: Number>(constants: &Rows<'_, C>, omega: V, out: &mut LinesMut<'_, N>);
}

/// The lines of a response of `N` outputs, from one of them on.
pub struct LinesMut<'a, const N: usize> {
    /// Real parts, imaginary parts, and those of the Jacobian.
    parts: [&'a mut [f64]; 4],
    lines: usize,
    first: usize,
}

impl<V: Number, const N: usize, const R: usize> Results<V, R> for LinesMut<'_, N> {
    #[inline(always)]
    fn put(&mut self, place: usize, value: V) {
        let slopes = R / 2 - N;
        let (part, row) = match place {
            _ if place < N => (0, place),
            _ if place < 2 * N => (1, place - N),
            _ if place < 2 * N + slopes => (2, place - 2 * N),
            _ => (3, place - 2 * N - slopes),
        };
        value.store(&mut self.parts[part][row * self.lines + self.first..]);
    }
}

/// A frequency response at all lines.
///
/// # Panics
///
/// Where `into` has no room for as many rows of `omega.len()` lines as there are results.
pub fn respond<P: Responds<C, N>, const C: usize, const N: usize>(
    constants: &[f64; C],
    omega: &[f64],
    into: ResponseMut<'_>,
) {
    let parts = parts(into);
    let constants = &constants.map(|constant| [constant; LANES]);
    let lines = omega.len();
    if lines >= LANES {
        let place = Place::Lines;
        return at_lines::<P, C, N>(Lines {
            constants,
            omega,
            parts,
            place,
        });
    }
    let Some(&last) = omega.last() else { return };
    // Whole vectors, of which the lines that are wanted are copied.
    let mut whole = [last; LANES];
    whole[..lines].copy_from_slice(omega);
    let mut found = parts.each_ref().map(|part| vec![0.0; part.len() / lines * LANES]);
    at_lines::<P, C, N>(Lines {
        constants,
        omega: &whole,
        parts: found.each_mut().map(|part| &mut part[..]),
        place: Place::Lines,
    });
    for (part, found) in parts.into_iter().zip(&found) {
        for (row, found) in part.chunks_exact_mut(lines).zip(found.chunks_exact(LANES)) {
            row.copy_from_slice(&found[..lines]);
        }
    }
}

/// A frequency response of several parameter sets at one line: the rows of all real parts, of all imaginary parts, and of the same of the
/// Jacobian.
///
/// # Panics
///
/// Where there are fewer rows than results.
pub fn respond_sets<P: Responds<C, N>, const C: usize, const N: usize>(
    constants: &[Lanes; C],
    omega: f64,
    rows: &mut [Lanes],
) {
    let slopes = (rows.len() / 2).saturating_sub(N);
    let (re, rest) = rows.as_flattened_mut().split_at_mut(LANES * N);
    let (im, rest) = rest.split_at_mut(LANES * N);
    let (d_re, d_im) = rest.split_at_mut(LANES * slopes);
    at_lines::<P, C, N>(Lines {
        constants,
        omega: &[omega; LANES],
        parts: [re, im, d_re, d_im],
        place: Place::Sets,
    });
}

fn parts(into: ResponseMut<'_>) -> [&mut [f64]; 4] {
    let (d_re, d_im) = into.jacobian.unwrap_or_default();
    [into.re, into.im, d_re, d_im]
}

fn at_lines<P: Responds<C, N>, const C: usize, const N: usize>(lines: Lines<'_, C>) {
    in_vectors(Response::<P, C, N> {
        lines,
        code: PhantomData,
    });
}

/// What is computed of a response.
struct Lines<'a, const C: usize> {
    constants: &'a [Lanes; C],
    omega: &'a [f64],
    parts: [&'a mut [f64]; 4],
    place: Place,
}

/// What stands side by side in a row.
#[derive(Clone, Copy)]
enum Place {
    /// Lines of one parameter set, which is that of each lane.
    Lines,
    /// Parameter sets at one line.
    Sets,
}

struct Response<'a, P, const C: usize, const N: usize> {
    lines: Lines<'a, C>,
    code: PhantomData<P>,
}

impl<P: Responds<C, N>, const C: usize, const N: usize> Straight for Response<'_, P, C, N> {
    #[inline(always)]
    fn run<V: Number>(self) {
        let Lines {
            constants,
            omega,
            mut parts,
            place,
        } = self.lines;
        let lines = omega.len();
        for group in 0..lines.div_ceil(V::LANES) {
            // The last group is whole, too: it may compute again what the one before it has.
            let first = (group * V::LANES).min(lines - V::LANES);
            let set = match place {
                Place::Lines => 0,
                Place::Sets => first,
            };
            let mut out = LinesMut {
                parts: parts.each_mut().map(|part| &mut **part),
                lines,
                first,
            };
            P::compute(&Rows::new(constants, set), V::load(&omega[first..]), &mut out);
        }
    }
}
