//! A number, or several at a time: what straight-line code is written over.

use std::array;
use std::ops::{Add, Div, Mul, Neg, Sub};

/// What generated code computes with: a number, or a vector of one for each of several parameter sets or lines. Each of a vector has the
/// bits that it has alone.
pub trait Number:
    Copy + Neg<Output = Self> + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Div<Output = Self>
{
    /// How many numbers it holds.
    const LANES: usize;

    /// The same number in every lane.
    fn of(value: f64) -> Self;

    /// A lane from each of the first values.
    ///
    /// # Panics
    /// Where there are fewer.
    fn load(values: &[f64]) -> Self;

    /// The first values from each lane.
    ///
    /// # Panics
    /// Where there is room for fewer.
    fn store(self, values: &mut [f64]);

    /// The magnitude.
    fn abs(self) -> Self;

    /// The square root.
    fn sqrt(self) -> Self;

    /// The smaller of two; the other one where one is not a number.
    fn min(self, other: Self) -> Self;

    /// The larger of two; the other one where one is not a number.
    fn max(self, other: Self) -> Self;

    /// `a` where the test is above zero, else `b`.
    fn choose(test: Self, a: Self, b: Self) -> Self;

    /// The number in a lane.
    fn lane(self, lane: usize) -> f64;

    /// What comes out for each lane.
    fn from_lanes(of_lane: impl FnMut(usize) -> f64) -> Self;

    /// Runs a part of a long function as a function of its own, with the instructions for such numbers.
    fn apart(part: impl FnOnce());

    /// A function of each lane.
    #[inline(always)]
    fn each(self, function: impl Fn(f64) -> f64) -> Self {
        Self::from_lanes(|lane| function(self.lane(lane)))
    }

    /// -1, 0 or 1: at rest there is no direction.
    #[inline(always)]
    fn sign(self) -> Self {
        self.each(|value| if value == 0.0 { 0.0 } else { value.signum() })
    }

    /// The exponential function.
    #[inline(always)]
    fn exp(self) -> Self {
        self.each(f64::exp)
    }

    /// The natural logarithm.
    #[inline(always)]
    fn ln(self) -> Self {
        self.each(f64::ln)
    }

    /// The sine.
    #[inline(always)]
    fn sin(self) -> Self {
        self.each(f64::sin)
    }

    /// The cosine.
    #[inline(always)]
    fn cos(self) -> Self {
        self.each(f64::cos)
    }

    /// The tangent.
    #[inline(always)]
    fn tan(self) -> Self {
        self.each(f64::tan)
    }

    /// The arc tangent.
    #[inline(always)]
    fn atan(self) -> Self {
        self.each(f64::atan)
    }

    /// The hyperbolic tangent.
    #[inline(always)]
    fn tanh(self) -> Self {
        self.each(f64::tanh)
    }

    /// It to the power of another.
    #[inline(always)]
    fn powf(self, exponent: Self) -> Self {
        Self::from_lanes(|lane| self.lane(lane).powf(exponent.lane(lane)))
    }
}

impl Number for f64 {
    const LANES: usize = 1;

    #[inline(always)]
    fn of(value: f64) -> Self {
        value
    }

    #[inline(always)]
    fn load(values: &[f64]) -> Self {
        values[0]
    }

    #[inline(always)]
    fn store(self, values: &mut [f64]) {
        values[0] = self;
    }

    #[inline(always)]
    fn abs(self) -> Self {
        f64::abs(self)
    }

    #[inline(always)]
    fn sqrt(self) -> Self {
        f64::sqrt(self)
    }

    #[inline(always)]
    fn min(self, other: Self) -> Self {
        f64::min(self, other)
    }

    #[inline(always)]
    fn max(self, other: Self) -> Self {
        f64::max(self, other)
    }

    #[inline(always)]
    fn choose(test: Self, a: Self, b: Self) -> Self {
        if test > 0.0 { a } else { b }
    }

    #[inline(always)]
    fn lane(self, _lane: usize) -> f64 {
        self
    }

    #[inline(always)]
    fn from_lanes(mut of_lane: impl FnMut(usize) -> f64) -> Self {
        of_lane(0)
    }

    #[inline(never)]
    fn apart(part: impl FnOnce()) {
        part();
    }
}

/// Two numbers, which nearly every processor can compute together; the optimiser finds how.
#[derive(Clone, Copy)]
pub(super) struct Pair([f64; 2]);

impl Neg for Pair {
    type Output = Self;

    #[inline(always)]
    fn neg(self) -> Self {
        Pair(self.0.map(|value| -value))
    }
}

macro_rules! lane_by_lane {
    ($($operator:ident, $function:ident, $sign:tt;)*) => {$(
        impl $operator for Pair {
            type Output = Self;

            #[inline(always)]
            fn $function(self, other: Self) -> Self {
                Self::from_lanes(|lane| self.0[lane] $sign other.0[lane])
            }
        }
    )*};
}

lane_by_lane! {
    Add, add, +;
    Sub, sub, -;
    Mul, mul, *;
    Div, div, /;
}

impl Number for Pair {
    const LANES: usize = 2;

    #[inline(always)]
    fn of(value: f64) -> Self {
        Pair([value; 2])
    }

    #[inline(always)]
    fn load(values: &[f64]) -> Self {
        Self::from_lanes(|lane| values[lane])
    }

    #[inline(always)]
    fn store(self, values: &mut [f64]) {
        values[..2].copy_from_slice(&self.0);
    }

    #[inline(always)]
    fn abs(self) -> Self {
        self.each(f64::abs)
    }

    #[inline(always)]
    fn sqrt(self) -> Self {
        self.each(f64::sqrt)
    }

    #[inline(always)]
    fn min(self, other: Self) -> Self {
        Self::from_lanes(|lane| self.0[lane].min(other.0[lane]))
    }

    #[inline(always)]
    fn max(self, other: Self) -> Self {
        Self::from_lanes(|lane| self.0[lane].max(other.0[lane]))
    }

    #[inline(always)]
    fn choose(test: Self, a: Self, b: Self) -> Self {
        Self::from_lanes(|lane| f64::choose(test.0[lane], a.0[lane], b.0[lane]))
    }

    #[inline(always)]
    fn lane(self, lane: usize) -> f64 {
        self.0[lane]
    }

    #[inline(always)]
    fn from_lanes(of_lane: impl FnMut(usize) -> f64) -> Self {
        Pair(array::from_fn(of_lane))
    }

    #[inline(never)]
    fn apart(part: impl FnOnce()) {
        part();
    }
}
