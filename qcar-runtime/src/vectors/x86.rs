//! The vectors of x86-64: four numbers with AVX, eight with AVX-512.
//!
//! Each method enables the same instructions as the functions that call it, and no others. Only then does rustc inline
//! it; LLVM would take far longer for the thousands of calls of a model. The methods are safe on a machine that has
//! these instructions.
#![expect(unsafe_code, reason = "vectors are loaded and stored through pointers")]
#![expect(
    clippy::missing_safety_doc,
    reason = "all functions need the same instructions, as the module states"
)]

use std::arch::x86_64::*;
use std::array;
use std::ptr;

use super::lines::{LinesMut, place_of_line};
use super::number;
use crate::model::{LANES, Lanes};

/// A function of each lane.
macro_rules! of_each_lane {
    ($instructions:literal: $($name:ident, $function:expr;)*) => {$(
        /// The function of this name, of each lane.
        #[target_feature(enable = $instructions)]
        #[inline]
        pub fn $name(self) -> Self {
            Self::from_lanes(self.lanes().map($function))
        }
    )*};
}

/// The methods of a vector, given the names of its instructions.
macro_rules! vector {
    ($vector:ident, $of:ty, $instructions:literal, $lanes:literal,
     [$add:ident, $sub:ident, $mul:ident, $div:ident, $sqrt:ident, $fill:ident, $load:ident, $store:ident]) => {
        impl $vector {
            /// The same number in every lane.
            #[target_feature(enable = $instructions)]
            #[inline]
            pub fn of(value: f64) -> Self {
                $vector($fill(value))
            }

            /// The values of the sets from `set` on.
            #[target_feature(enable = $instructions)]
            #[inline]
            pub fn load(row: &Lanes, set: usize) -> Self {
                // SAFETY: the masked position is a multiple of the width and less than the length of the row.
                $vector(unsafe {
                    $load(
                        ptr::from_ref(row)
                            .cast::<f64>()
                            .wrapping_add(set & (LANES - $lanes)),
                    )
                })
            }

            /// Stores the values of the sets from `set` on.
            #[target_feature(enable = $instructions)]
            #[inline]
            pub fn store(self, row: &mut Lanes, set: usize) {
                // SAFETY: as in `load`.
                unsafe {
                    $store(
                        ptr::from_mut(row)
                            .cast::<f64>()
                            .wrapping_add(set & (LANES - $lanes)),
                        self.0,
                    )
                }
            }

            #[target_feature(enable = $instructions)]
            #[inline]
            pub(crate) fn from_lanes(values: [f64; $lanes]) -> Self {
                // SAFETY: the array has a value for each lane.
                $vector(unsafe { $load(values.as_ptr()) })
            }

            #[target_feature(enable = $instructions)]
            #[inline]
            pub(crate) fn lanes(self) -> [f64; $lanes] {
                let mut values = [0.0; $lanes];
                // SAFETY: the array has room for each lane.
                unsafe { $store(values.as_mut_ptr(), self.0) };
                values
            }

            /// `a + b`
            #[target_feature(enable = $instructions)]
            #[inline]
            pub fn add(a: Self, b: Self) -> Self {
                $vector($add(a.0, b.0))
            }

            /// `a - b`
            #[target_feature(enable = $instructions)]
            #[inline]
            pub fn sub(a: Self, b: Self) -> Self {
                $vector($sub(a.0, b.0))
            }

            /// `a * b`
            #[target_feature(enable = $instructions)]
            #[inline]
            pub fn mul(a: Self, b: Self) -> Self {
                $vector($mul(a.0, b.0))
            }

            /// `a / b`
            #[target_feature(enable = $instructions)]
            #[inline]
            pub fn div(a: Self, b: Self) -> Self {
                $vector($div(a.0, b.0))
            }

            /// The square root.
            #[target_feature(enable = $instructions)]
            #[inline]
            pub fn sqrt(self) -> Self {
                $vector($sqrt(self.0))
            }

            of_each_lane! { $instructions:
                sign, number::sign;
                exp, f64::exp;
                ln, f64::ln;
                sin, f64::sin;
                cos, f64::cos;
                tan, f64::tan;
                atan, f64::atan;
                tanh, f64::tanh;
            }

            /// `a` to the power of `b`.
            #[target_feature(enable = $instructions)]
            #[inline]
            pub fn powf(a: Self, b: Self) -> Self {
                let (a, b) = (a.lanes(), b.lanes());
                Self::from_lanes(array::from_fn(|lane| a[lane].powf(b[lane])))
            }

            /// [`number::table`] of each lane.
            #[target_feature(enable = $instructions)]
            pub fn table<const N: usize>(
                order: u8,
                x: Self,
                knots: &[f64; N],
                values: &[Self; N],
                slopes: &[Self; N],
            ) -> Self {
                let (x, values, slopes) = (x.lanes(), values.map(|v| v.lanes()), slopes.map(|s| s.lanes()));
                Self::from_lanes(array::from_fn(|lane| {
                    let of_lane = |points: &[[f64; $lanes]; N]| points.map(|point| point[lane]);
                    number::table(order, x[lane], knots, &of_lane(&values), &of_lane(&slopes))
                }))
            }
        }

        impl<const N: usize, const R: usize> LinesMut<'_, $vector, N, R> {
            /// Stores a result.
            #[target_feature(enable = $instructions)]
            #[inline]
            pub fn put(&mut self, place: usize, value: $vector) {
                let (part, row) = place_of_line!(place, N, R);
                // SAFETY: `LinesMut::new` has checked that each part has all rows, and that each row has these lines.
                unsafe { $store(self.parts[part].wrapping_add(row * self.lines), value.0) }
            }
        }
    };
}

/// Four numbers.
#[derive(Clone, Copy)]
pub struct Four(__m256d);

vector!(
    Four,
    __m256d,
    "avx",
    4,
    [
        _mm256_add_pd,
        _mm256_sub_pd,
        _mm256_mul_pd,
        _mm256_div_pd,
        _mm256_sqrt_pd,
        _mm256_set1_pd,
        _mm256_loadu_pd,
        _mm256_storeu_pd
    ]
);

// For zeros and NaN the results are those of Rust's functions.
impl Four {
    /// `-a`
    #[target_feature(enable = "avx")]
    #[inline]
    pub fn neg(self) -> Self {
        Four(_mm256_sub_pd(_mm256_set1_pd(-0.0), self.0))
    }

    /// The magnitude.
    #[target_feature(enable = "avx")]
    #[inline]
    pub fn abs(self) -> Self {
        Four(_mm256_andnot_pd(_mm256_set1_pd(-0.0), self.0))
    }

    /// The smaller of two; the other one if one is NaN.
    #[target_feature(enable = "avx")]
    #[inline]
    pub fn min(a: Self, b: Self) -> Self {
        let unknown = _mm256_cmp_pd::<_CMP_UNORD_Q>(a.0, a.0);
        Four(_mm256_blendv_pd(_mm256_min_pd(b.0, a.0), b.0, unknown))
    }

    /// The larger of two; the other one if one is NaN.
    #[target_feature(enable = "avx")]
    #[inline]
    pub fn max(a: Self, b: Self) -> Self {
        let unknown = _mm256_cmp_pd::<_CMP_UNORD_Q>(a.0, a.0);
        Four(_mm256_blendv_pd(_mm256_max_pd(b.0, a.0), b.0, unknown))
    }

    /// `a` if the test is above zero, else `b`.
    #[target_feature(enable = "avx")]
    #[inline]
    pub fn choose(test: Self, a: Self, b: Self) -> Self {
        let above = _mm256_cmp_pd::<_CMP_GT_OQ>(test.0, _mm256_setzero_pd());
        Four(_mm256_blendv_pd(b.0, a.0, above))
    }
}

/// Eight numbers.
#[derive(Clone, Copy)]
pub struct Eight(__m512d);

vector!(
    Eight,
    __m512d,
    "avx512f",
    8,
    [
        _mm512_add_pd,
        _mm512_sub_pd,
        _mm512_mul_pd,
        _mm512_div_pd,
        _mm512_sqrt_pd,
        _mm512_set1_pd,
        _mm512_loadu_pd,
        _mm512_storeu_pd
    ]
);

impl Eight {
    /// `-a`
    #[target_feature(enable = "avx512f")]
    #[inline]
    pub fn neg(self) -> Self {
        Eight(_mm512_sub_pd(_mm512_set1_pd(-0.0), self.0))
    }

    /// The magnitude.
    #[target_feature(enable = "avx512f")]
    #[inline]
    pub fn abs(self) -> Self {
        Eight(_mm512_abs_pd(self.0))
    }

    /// The smaller of two; the other one if one is NaN.
    #[target_feature(enable = "avx512f")]
    #[inline]
    pub fn min(a: Self, b: Self) -> Self {
        let unknown = _mm512_cmp_pd_mask::<_CMP_UNORD_Q>(a.0, a.0);
        Eight(_mm512_mask_blend_pd(unknown, _mm512_min_pd(b.0, a.0), b.0))
    }

    /// The larger of two; the other one if one is NaN.
    #[target_feature(enable = "avx512f")]
    #[inline]
    pub fn max(a: Self, b: Self) -> Self {
        let unknown = _mm512_cmp_pd_mask::<_CMP_UNORD_Q>(a.0, a.0);
        Eight(_mm512_mask_blend_pd(unknown, _mm512_max_pd(b.0, a.0), b.0))
    }

    /// `a` if the test is above zero, else `b`.
    #[target_feature(enable = "avx512f")]
    #[inline]
    pub fn choose(test: Self, a: Self, b: Self) -> Self {
        let above = _mm512_cmp_pd_mask::<_CMP_GT_OQ>(test.0, _mm512_setzero_pd());
        Eight(_mm512_mask_blend_pd(above, b.0, a.0))
    }
}
