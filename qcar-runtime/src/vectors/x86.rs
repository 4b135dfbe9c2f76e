//! Numbers in the vectors of x86-64: four with AVX2, eight with AVX-512.
//!
//! Only [`super::in_vectors`] hands these out, once it has seen that the machine has the instructions, and what it runs is inlined into a
//! function that may use them.
#![allow(unsafe_code, reason = "an instruction set may not be there")]

use std::arch::x86_64::*;
use std::array;
use std::ops::{Add, Div, Mul, Neg, Sub};

use super::number::Number;

/// Runs it with AVX2, as a function of its own.
///
/// # Safety
/// The machine has AVX2.
#[target_feature(enable = "avx2")]
#[inline(never)]
unsafe fn apart_with_avx2(part: impl FnOnce()) {
    part();
}

/// Runs it with AVX-512, as a function of its own.
///
/// # Safety
/// The machine has both parts of AVX-512.
#[target_feature(enable = "avx512f,avx512dq")]
#[inline(never)]
unsafe fn apart_with_avx512(part: impl FnOnce()) {
    part();
}

/// `a` where the comparison holds, else `b`.
macro_rules! blend_four {
    ($comparison:ident($left:expr, $right:expr), $a:expr, $b:expr) => {
        _mm256_blendv_pd($b, $a, _mm256_cmp_pd::<$comparison>($left, $right))
    };
}

/// The same of eight.
macro_rules! blend_eight {
    ($comparison:ident($left:expr, $right:expr), $a:expr, $b:expr) => {
        _mm512_mask_blend_pd(_mm512_cmp_pd_mask::<$comparison>($left, $right), $b, $a)
    };
}

macro_rules! operators {
    ($vector:ident: $($operator:ident, $function:ident, $instruction:ident;)*) => {$(
        impl $operator for $vector {
            type Output = Self;

            #[inline(always)]
            fn $function(self, other: Self) -> Self {
                // SAFETY: a vector exists where its instructions do.
                $vector(unsafe { $instruction(self.0, other.0) })
            }
        }
    )*};
}

/// A vector from the names of its instructions. What these give of zeros and of what is not a number is what Rust's functions come to.
macro_rules! vector {
    ($vector:ident, $lanes:literal, $of:ty, $apart:ident, $blend:ident, [$add:ident, $sub:ident, $mul:ident, $div:ident],
     [$fill:ident, $load:ident, $store:ident, $sqrt:ident, $min:ident, $max:ident, $xor:ident, $and_not:ident]) => {
        /// As many numbers as a vector of the processor holds.
        #[derive(Clone, Copy)]
        pub(super) struct $vector($of);

        operators! { $vector:
            Add, add, $add;
            Sub, sub, $sub;
            Mul, mul, $mul;
            Div, div, $div;
        }

        impl Neg for $vector {
            type Output = Self;

            #[inline(always)]
            fn neg(self) -> Self {
                // SAFETY: a vector exists where its instructions do.
                $vector(unsafe { $xor(self.0, $fill(-0.0)) })
            }
        }

        impl Number for $vector {
            const LANES: usize = $lanes;

            #[inline(always)]
            fn of(value: f64) -> Self {
                // SAFETY: only what runs with these instructions asks for such a vector.
                $vector(unsafe { $fill(value) })
            }

            #[inline(always)]
            fn load(values: &[f64]) -> Self {
                let values = &values[..$lanes];
                // SAFETY: only what runs with these instructions asks for such a vector, and there are so many values.
                $vector(unsafe { $load(values.as_ptr()) })
            }

            #[inline(always)]
            fn store(self, values: &mut [f64]) {
                let values = &mut values[..$lanes];
                // SAFETY: a vector exists where its instructions do, and there is room for so many values.
                unsafe { $store(values.as_mut_ptr(), self.0) }
            }

            #[inline(always)]
            fn abs(self) -> Self {
                // SAFETY: a vector exists where its instructions do.
                $vector(unsafe { $and_not($fill(-0.0), self.0) })
            }

            #[inline(always)]
            fn sqrt(self) -> Self {
                // SAFETY: a vector exists where its instructions do.
                $vector(unsafe { $sqrt(self.0) })
            }

            #[inline(always)]
            fn min(self, other: Self) -> Self {
                // SAFETY: a vector exists where its instructions do.
                $vector(unsafe { $blend!(_CMP_UNORD_Q(self.0, self.0), other.0, $min(other.0, self.0)) })
            }

            #[inline(always)]
            fn max(self, other: Self) -> Self {
                // SAFETY: a vector exists where its instructions do.
                $vector(unsafe { $blend!(_CMP_UNORD_Q(self.0, self.0), other.0, $max(other.0, self.0)) })
            }

            #[inline(always)]
            fn choose(test: Self, a: Self, b: Self) -> Self {
                // SAFETY: a vector exists where its instructions do.
                $vector(unsafe { $blend!(_CMP_GT_OQ(test.0, $fill(0.0)), a.0, b.0) })
            }

            #[inline(always)]
            fn lane(self, lane: usize) -> f64 {
                let mut values = [0.0; $lanes];
                self.store(&mut values);
                values[lane]
            }

            #[inline(always)]
            fn from_lanes(of_lane: impl FnMut(usize) -> f64) -> Self {
                Self::load(&array::from_fn::<f64, $lanes, _>(of_lane))
            }

            #[inline(always)]
            fn apart(part: impl FnOnce()) {
                // SAFETY: only what runs with these instructions asks for such vectors.
                unsafe { $apart(part) }
            }
        }
    };
}

vector!(
    Four,
    4,
    __m256d,
    apart_with_avx2,
    blend_four,
    [_mm256_add_pd, _mm256_sub_pd, _mm256_mul_pd, _mm256_div_pd],
    [
        _mm256_set1_pd,
        _mm256_loadu_pd,
        _mm256_storeu_pd,
        _mm256_sqrt_pd,
        _mm256_min_pd,
        _mm256_max_pd,
        _mm256_xor_pd,
        _mm256_andnot_pd
    ]
);

vector!(
    Eight,
    8,
    __m512d,
    apart_with_avx512,
    blend_eight,
    [_mm512_add_pd, _mm512_sub_pd, _mm512_mul_pd, _mm512_div_pd],
    [
        _mm512_set1_pd,
        _mm512_loadu_pd,
        _mm512_storeu_pd,
        _mm512_sqrt_pd,
        _mm512_min_pd,
        _mm512_max_pd,
        _mm512_xor_pd,
        _mm512_andnot_pd
    ]
);
