//! Straight-line code over vectors: of several parameter sets, or of several lines of a frequency response.

use super::{fixed, fixed_mut};
use crate::model::{LANES, Lanes, ResponseMut};
use crate::vectors::{Eight, Four, LinesMut, Width, width};

/// Straight-line functions over vectors of four numbers, as `pub fn name(arguments) { body }`. A vector is `V` to them.
#[macro_export]
macro_rules! in_fours {
    ($($(#[$about:meta])* pub fn $name:ident $arguments:tt $body:block)*) => {
        use $crate::generated::Four as V;

        $(
            $(#[$about])*
            #[cfg_attr(target_arch = "x86_64", target_feature(enable = "avx"))]
            #[inline(never)]
            pub fn $name $arguments $body
        )*
    };
}

/// As [`in_fours!`](crate::in_fours), over vectors of eight numbers.
#[cfg(target_arch = "x86_64")]
#[macro_export]
macro_rules! in_eights {
    ($($(#[$about:meta])* pub fn $name:ident $arguments:tt $body:block)*) => {
        use $crate::generated::Eight as V;

        $(
            $(#[$about])*
            #[target_feature(enable = "avx512f")]
            #[inline(never)]
            pub fn $name $arguments $body
        )*
    };
}

/// The functions in a module for each width of vectors. They can use the names in scope around the macro.
#[macro_export]
macro_rules! in_vectors {
    ($($functions:tt)*) => {
        /// Over vectors of four numbers.
        pub mod four {
            use super::*;

            $crate::in_fours! { $($functions)* }
        }

        /// Over vectors of eight numbers.
        #[cfg(target_arch = "x86_64")]
        pub mod eight {
            use super::*;

            $crate::in_eights! { $($functions)* }
        }

        /// A vector of eight numbers would be no faster here than two of four.
        #[cfg(not(target_arch = "x86_64"))]
        pub use four as eight;
    };
}

/// The values of one of several parameter sets.
#[inline]
pub fn one<const N: usize>(rows: &[Lanes; N], set: usize) -> [f64; N] {
    let mut values = [0.0; N];
    values.iter_mut().zip(rows).for_each(|(value, row)| *value = row[set]);
    values
}

/// Straight-line code for several parameter sets at once, with `R` results.
///
/// The functions are unsafe because they need the instructions of their vector. They must need no others.
pub trait Sets<const R: usize> {
    /// The results of the four sets from the given one on, over [`Four`].
    const FOUR: unsafe fn(&Self, usize, &mut [Lanes; R]);

    /// The results of the eight sets, over [`Eight`].
    const EIGHT: unsafe fn(&Self, usize, &mut [Lanes; R]);

    /// The results of one set.
    fn one(&self, set: usize, out: &mut [f64; R]);
}

/// Computes the results of several parameter sets with the widest vectors of this machine.
///
/// # Panics
///
/// If there are fewer rows than results.
#[inline]
pub fn together<S: Sets<R>, const R: usize>(sets: &S, rows: &mut [Lanes]) {
    sets_in(width(), sets, fixed_mut(rows));
}

#[inline]
fn sets_in<S: Sets<R>, const R: usize>(width: Width, sets: &S, rows: &mut [Lanes; R]) {
    match width {
        #[allow(unsafe_code, reason = "this machine has the instructions")]
        // SAFETY: this machine has the instructions of the vector, and the function asks for no others.
        Width::Eight => unsafe { (S::EIGHT)(sets, 0, rows) },
        #[allow(unsafe_code, reason = "this machine has the instructions")]
        // SAFETY: as above.
        Width::Four => [0, 4].into_iter().for_each(|set| unsafe { (S::FOUR)(sets, set, rows) }),
        Width::One => {
            let mut found = [0.0; R];
            for set in 0..LANES {
                sets.one(set, &mut found);
                rows.iter_mut().zip(&found).for_each(|(row, value)| row[set] = *value);
            }
        }
    }
}

/// Code of a response over a vector of lines. Its arguments are the constants, the frequencies in rad/s, the position
/// of the first frequency of the vector, and the results.
pub type OverLines<V, const C: usize, const N: usize, const R: usize> =
    unsafe fn(&[Lanes; C], &Lanes, usize, &mut LinesMut<'_, V, N, R>);

/// The straight-line code of a frequency response with `N` outputs, over `C` constants, with `R` results.
///
/// The functions are unsafe because they need the instructions of their vector. They must need no others.
pub trait Responds<const C: usize, const N: usize, const R: usize> {
    /// The results of four lines.
    const FOUR: OverLines<Four, C, N, R>;

    /// The results of eight lines; `None` if they are not compiled. They take 0.87 of the time of twice four.
    const EIGHT: Option<OverLines<Eight, C, N, R>>;

    /// The results at one frequency, rad/s.
    fn one(constants: &[f64; C], omega: f64, out: &mut [f64; R]);
}

/// A frequency response at all lines.
///
/// # Panics
///
/// If `into` has no room for a row of `omega.len()` lines for each result.
pub fn respond<P: Responds<C, N, R>, const C: usize, const N: usize, const R: usize>(
    constants: &[f64; C],
    omega: &[f64],
    into: ResponseMut<'_>,
) {
    let (d_re, d_im) = into.jacobian.unwrap_or_default();
    let mut into = Rows {
        parts: [into.re, into.im, d_re, d_im],
        lines: omega.len(),
    };
    let Some(last) = omega.len().checked_sub(LANES) else {
        let lines = omega.iter().enumerate();
        return lines.for_each(|(line, omega)| into.compute_one::<P, C, N, R>(constants, *omega, line));
    };
    let constants = constants.map(|constant| [constant; LANES]);
    // The last group is whole too: it may compute some lines of the group before again.
    for first in (0..last).step_by(LANES).chain([last]) {
        into.compute::<P, C, N, R>(width(), &constants, fixed(&omega[first..]), first);
    }
}

/// A frequency response of several parameter sets at one line. The rows are all real parts, all imaginary parts, and
/// the same of the Jacobian.
///
/// # Panics
///
/// If there are fewer rows than results.
pub fn respond_sets<P: Responds<C, N, R>, const C: usize, const N: usize, const R: usize>(
    constants: &[Lanes; C],
    omega: f64,
    rows: &mut [Lanes],
) {
    let (re, rest) = fixed_mut::<_, R>(rows).as_flattened_mut().split_at_mut(LANES * N);
    let (im, rest) = rest.split_at_mut(LANES * N);
    let (d_re, d_im) = rest.split_at_mut(rest.len() / 2);
    let mut into = Rows {
        parts: [re, im, d_re, d_im],
        lines: LANES,
    };
    into.compute::<P, C, N, R>(width(), constants, &[omega; LANES], 0);
}

/// The rows that receive a response: real parts, imaginary parts, and the same of the Jacobian.
struct Rows<'a> {
    parts: [&'a mut [f64]; 4],
    /// Number of lines in a row.
    lines: usize,
}

impl Rows<'_> {
    /// Computes eight lines from `first` on.
    fn compute<P: Responds<C, N, R>, const C: usize, const N: usize, const R: usize>(
        &mut self,
        width: Width,
        constants: &[Lanes; C],
        omega: &Lanes,
        first: usize,
    ) {
        match (width, P::EIGHT) {
            (Width::Eight, Some(code)) => {
                let mut out = LinesMut::new(&mut self.parts, self.lines, first, LANES);
                #[allow(unsafe_code, reason = "this machine has the instructions")]
                // SAFETY: this machine has the instructions of the vector, and the function asks for no others.
                unsafe {
                    code(constants, omega, 0, &mut out);
                }
            }
            (Width::Four | Width::Eight, _) => {
                for lane in [0, 4] {
                    let mut out = LinesMut::new(&mut self.parts, self.lines, first + lane, 4);
                    #[allow(unsafe_code, reason = "this machine has the instructions")]
                    // SAFETY: as above; a machine with vectors of eight has those of four.
                    unsafe {
                        (P::FOUR)(constants, omega, lane, &mut out);
                    }
                }
            }
            (Width::One, _) => {
                for (lane, omega) in omega.iter().enumerate() {
                    self.compute_one::<P, C, N, R>(&one(constants, lane), *omega, first + lane);
                }
            }
        }
    }

    fn compute_one<P: Responds<C, N, R>, const C: usize, const N: usize, const R: usize>(
        &mut self,
        constants: &[f64; C],
        omega: f64,
        line: usize,
    ) {
        let mut found = [0.0; R];
        P::one(constants, omega, &mut found);
        let rows = self.parts.iter_mut().flat_map(|part| part.chunks_exact_mut(self.lines));
        rows.zip(&found).for_each(|(row, value)| row[line] = *value);
    }
}

#[cfg(test)]
mod tests {
    use std::array;

    use super::super::{sign, table};
    use super::*;

    const A: Lanes = [1.5, -0.25, 0.0, -0.0, f64::NAN, 1e300, -7.0, f64::INFINITY];
    const B: Lanes = [-0.0, f64::NAN, 1e300, -7.0, f64::INFINITY, 1.5, -0.25, 0.0];
    const KNOTS: [f64; 3] = [-1.0, 0.5, 2.0];

    /// All operations on two values of each set.
    struct Operations<'a> {
        a: &'a Lanes,
        b: &'a Lanes,
    }

    const RESULTS: usize = 20;

    /// A response of two outputs: `a + ω` and `a ω` with imaginary parts `a - ω` and `a / ω`, whose derivative by `a`
    /// is of the second.
    struct Response;

    mod vectors {
        use super::*;

        crate::in_vectors! {
            pub fn operations(sets: &Operations<'_>, first: usize, out: &mut [Lanes; RESULTS]) {
                let (a, b) = (V::load(sets.a, first), V::load(sets.b, first));
                let found = [
                    V::neg(a),
                    V::add(a, b),
                    V::sub(a, b),
                    V::mul(a, b),
                    V::div(a, b),
                    V::abs(a),
                    V::sqrt(a),
                    V::min(a, b),
                    V::max(a, b),
                    V::choose(a, b, V::of(3.0)),
                    V::sign(a),
                    V::exp(a),
                    V::ln(a),
                    V::sin(a),
                    V::cos(a),
                    V::tan(a),
                    V::atan(a),
                    V::tanh(a),
                    V::powf(a, b),
                    V::table(0, b, &KNOTS, &[a, V::of(1.0), b], &[V::of(0.0), a, b]),
                ];
                for (row, found) in out.iter_mut().zip(found) {
                    V::store(found, row, first);
                }
            }

            pub fn response(constants: &[Lanes; 1], omega: &Lanes, first: usize, out: &mut LinesMut<'_, V, 2, 6>) {
                let (a, omega) = (V::load(&constants[0], first), V::load(omega, first));
                out.put(0, V::add(a, omega));
                out.put(1, V::mul(a, omega));
                out.put(2, V::sub(a, omega));
                out.put(3, V::div(a, omega));
                out.put(4, omega);
                out.put(5, V::div(V::of(1.0), omega));
            }
        }
    }

    impl Sets<RESULTS> for Operations<'_> {
        const FOUR: unsafe fn(&Self, usize, &mut [Lanes; RESULTS]) = vectors::four::operations;
        const EIGHT: unsafe fn(&Self, usize, &mut [Lanes; RESULTS]) = vectors::eight::operations;

        fn one(&self, set: usize, out: &mut [f64; RESULTS]) {
            let (a, b) = (self.a[set], self.b[set]);
            *out = [
                -a,
                a + b,
                a - b,
                a * b,
                a / b,
                a.abs(),
                a.sqrt(),
                a.min(b),
                a.max(b),
                if a > 0.0 { b } else { 3.0 },
                sign(a),
                a.exp(),
                a.ln(),
                a.sin(),
                a.cos(),
                a.tan(),
                a.atan(),
                a.tanh(),
                a.powf(b),
                table(0, b, &KNOTS, &[a, 1.0, b], &[0.0, a, b]),
            ];
        }
    }

    impl Responds<1, 2, 6> for Response {
        const FOUR: OverLines<Four, 1, 2, 6> = vectors::four::response;
        const EIGHT: Option<OverLines<Eight, 1, 2, 6>> = Some(vectors::eight::response);

        fn one(&[a]: &[f64; 1], omega: f64, out: &mut [f64; 6]) {
            *out = [a + omega, a * omega, a - omega, a / omega, omega, 1.0 / omega];
        }
    }

    /// Every width that this machine has, up to its widest.
    fn widths() -> impl Iterator<Item = Width> {
        let count = match width() {
            Width::One => 1,
            Width::Four => 2,
            Width::Eight => 3,
        };
        [Width::One, Width::Four, Width::Eight].into_iter().take(count)
    }

    fn bits(values: &[f64]) -> Vec<Option<u64>> {
        let bits = values.iter().map(|value| (!value.is_nan()).then_some(value.to_bits()));
        bits.collect()
    }

    #[test]
    fn vectors_of_any_width_have_the_bits_of_their_numbers() {
        for width in widths() {
            let mut rows = [[9.0; LANES]; RESULTS];
            let operations = Operations { a: &A, b: &B };
            sets_in(width, &operations, &mut rows);
            for set in 0..LANES {
                let mut alone = [0.0; RESULTS];
                operations.one(set, &mut alone);
                assert_eq!(bits(&one(&rows, set)), bits(&alone), "set {set}");
            }
        }
    }

    #[test]
    fn a_response_is_the_same_at_any_number_of_lines_and_of_several_sets() {
        let alone = |a: f64, omega: f64| {
            let mut out = [0.0; 6];
            Response::one(&[a], omega, &mut out);
            out
        };
        for lines in [0, 1, 7, 8, 9, 21] {
            let omega: Vec<f64> = (0..lines).map(|line| 1.5 + line as f64).collect();
            let mut found = vec![9.0; 6 * lines];
            let (re, rest) = found.split_at_mut(2 * lines);
            let (im, rest) = rest.split_at_mut(2 * lines);
            let jacobian = Some(rest.split_at_mut(lines));
            respond::<Response, 1, 2, 6>(&[0.7], &omega, ResponseMut { re, im, jacobian });
            for (line, omega) in omega.iter().enumerate() {
                let at: [f64; 6] = array::from_fn(|row| found[row * lines + line]);
                assert_eq!(at, alone(0.7, *omega), "line {line} of {lines}");
            }
        }
        for width in widths() {
            let mut rows = [[9.0; LANES]; 6];
            let [re_0, re_1, im_0, im_1, d_re, d_im] = &mut rows;
            let (mut re, mut im) = ([*re_0, *re_1], [*im_0, *im_1]);
            let parts = [
                re.as_flattened_mut(),
                im.as_flattened_mut(),
                &mut d_re[..],
                &mut d_im[..],
            ];
            let mut into = Rows { parts, lines: LANES };
            into.compute::<Response, 1, 2, 6>(width, &[A], &[60.0; LANES], 0);
            rows[..4].copy_from_slice(&[re[0], re[1], im[0], im[1]]);
            for (set, a) in A.into_iter().enumerate() {
                assert_eq!(bits(&one(&rows, set)), bits(&alone(a, 60.0)), "set {set}");
            }
        }
    }

    #[test]
    #[should_panic(expected = "parts.iter()")]
    fn a_response_needs_room_for_all_its_rows() {
        let (omega, mut short) = ([1.0; LANES], [0.0; 2 * LANES]);
        let (re, im) = short.split_at_mut(LANES);
        let jacobian = None;
        respond::<Response, 1, 2, 6>(&[0.7], &omega, ResponseMut { re, im, jacobian });
    }
}
