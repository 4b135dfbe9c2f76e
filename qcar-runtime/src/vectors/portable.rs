//! Four numbers for any processor; the optimiser chooses the instructions.
#![allow(unsafe_code, reason = "rows of a response are written through pointers")]

use std::array;

use super::lines::{LinesMut, place_of_line};
use super::number;
use crate::model::{LANES, Lanes};

/// Number of values.
const WIDTH: usize = 4;

/// Four numbers.
#[derive(Clone, Copy)]
pub struct Four([f64; WIDTH]);

/// A function of each lane.
macro_rules! of_each_lane {
    ($($name:ident, $function:expr;)*) => {$(
        /// The function of this name, of each lane.
        #[inline]
        pub fn $name(self) -> Self {
            Four(self.0.map($function))
        }
    )*};
}

/// A function of each lane of two.
macro_rules! of_each_pair {
    ($($name:ident, $function:expr;)*) => {$(
        /// The function or operation of this name, of each lane.
        #[inline]
        pub fn $name(a: Self, b: Self) -> Self {
            Four(array::from_fn(|lane| $function(a.0[lane], b.0[lane])))
        }
    )*};
}

impl Four {
    /// The same number in every lane.
    #[inline]
    pub fn of(value: f64) -> Self {
        Four([value; WIDTH])
    }

    /// The values of the sets from `set` on.
    #[inline]
    pub fn load(row: &Lanes, set: usize) -> Self {
        Four(array::from_fn(|lane| row[(set & (LANES - WIDTH)) + lane]))
    }

    /// Stores the values of the sets from `set` on.
    #[inline]
    pub fn store(self, row: &mut Lanes, set: usize) {
        let first = set & (LANES - WIDTH);
        row[first..first + WIDTH].copy_from_slice(&self.0);
    }

    of_each_lane! {
        neg, |value| -value;
        abs, f64::abs;
        sqrt, f64::sqrt;
        sign, number::sign;
        exp, f64::exp;
        ln, f64::ln;
        sin, f64::sin;
        cos, f64::cos;
        tan, f64::tan;
        atan, f64::atan;
        tanh, f64::tanh;
    }

    of_each_pair! {
        add, |a, b| a + b;
        sub, |a, b| a - b;
        mul, |a, b| a * b;
        div, |a, b| a / b;
        min, f64::min;
        max, f64::max;
        powf, f64::powf;
    }

    /// `a` if the test is above zero, else `b`.
    #[inline]
    pub fn choose(test: Self, a: Self, b: Self) -> Self {
        Four(array::from_fn(
            |lane| {
                if test.0[lane] > 0.0 { a.0[lane] } else { b.0[lane] }
            },
        ))
    }

    /// [`number::table`] of each lane.
    pub fn table<const N: usize>(order: u8, x: Self, knots: &[f64; N], values: &[Self; N], slopes: &[Self; N]) -> Self {
        Four(array::from_fn(|lane| {
            let of_lane = |points: &[Self; N]| points.map(|point| point.0[lane]);
            number::table(order, x.0[lane], knots, &of_lane(values), &of_lane(slopes))
        }))
    }
}

impl<const N: usize, const R: usize> LinesMut<'_, Four, N, R> {
    /// Stores a result.
    #[inline]
    pub fn put(&mut self, place: usize, value: Four) {
        let (part, row) = place_of_line!(place, N, R);
        // SAFETY: `LinesMut::new` has checked that each part has all rows, and that each row has these lines.
        unsafe {
            self.parts[part]
                .add(row * self.lines)
                .cast::<[f64; WIDTH]>()
                .write_unaligned(value.0)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const A: Lanes = [1.5, -0.25, 0.0, -0.0, f64::NAN, 1e300, -7.0, f64::INFINITY];
    const B: Lanes = [-0.0, f64::NAN, 1e300, -7.0, f64::INFINITY, 1.5, -0.25, 0.0];

    /// An operation over four numbers, and the same over one.
    type Pair = (fn(Four, Four) -> Four, fn(f64, f64) -> f64);

    #[test]
    fn four_numbers_are_computed_as_each_alone() {
        let operations: [Pair; 8] = [
            (|a, _| Four::neg(a), |a, _| -a),
            (Four::sub, |a, b| a - b),
            (Four::div, |a, b| a / b),
            (Four::max, f64::max),
            (Four::powf, f64::powf),
            (
                |a, b| Four::choose(a, b, Four::of(3.0)),
                |a, b| if a > 0.0 { b } else { 3.0 },
            ),
            (|a, _| Four::tanh(a), |a, _| a.tanh()),
            (
                |a, b| Four::table(1, b, &[-1.0, 2.0], &[a, b], &[a, a]),
                |a, b| number::table(1, b, &[-1.0, 2.0], &[a, b], &[a, a]),
            ),
        ];
        for (four, one) in operations {
            let mut row = Lanes::default();
            for first in [0, 4] {
                four(Four::load(&A, first), Four::load(&B, first)).store(&mut row, first);
            }
            for ((found, a), b) in row.into_iter().zip(A).zip(B) {
                let alone = one(a, b);
                assert!(found.to_bits() == alone.to_bits() || found.is_nan() && alone.is_nan());
            }
        }
    }

    #[test]
    fn results_go_to_their_lines() {
        let mut parts = [[9.0; 5], [9.0; 5], [0.0; 5], [0.0; 5]];
        let [re, im, d_re, d_im] = &mut parts;
        let mut slices = [&mut re[..], &mut im[..], &mut d_re[..0], &mut d_im[..0]];
        let mut out = LinesMut::<Four, 1, 2>::new(&mut slices, 5, 1, WIDTH);
        out.put(0, Four([1.0, 2.0, 3.0, 4.0]));
        out.put(1, Four::of(7.0));
        assert_eq!(parts[..2], [[9.0, 1.0, 2.0, 3.0, 4.0], [9.0, 7.0, 7.0, 7.0, 7.0]]);
    }
}
