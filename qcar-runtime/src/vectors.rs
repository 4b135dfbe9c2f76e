//! Loops and straight-line code with the widest vectors of the machine that they run on.

// A single number.
mod number;
// Dot products.
mod dot;
// The results of a response.
mod lines;
// Rows of lanes.
mod rows;
// Four numbers, on any processor.
#[cfg(any(test, not(target_arch = "x86_64")))]
mod portable;
// Four and eight numbers, with the instructions of x86-64.
#[cfg(target_arch = "x86_64")]
mod x86;

pub(crate) use dot::{dot, dots};
pub use lines::LinesMut;
pub use number::{sign, table};
#[cfg(not(target_arch = "x86_64"))]
pub use portable::{Four, Four as Eight};
pub(crate) use rows::Rows;
#[cfg(target_arch = "x86_64")]
pub use x86::{Eight, Four};

/// Loops over plain numbers that run faster with wide vectors.
pub(crate) trait Loops {
    /// Their result.
    type Result;

    /// Must be marked `inline(always)`, since it is compiled once for each instruction set that [`widest`] supports.
    fn run(self) -> Self::Result;
}

/// Runs loops with the widest vectors of this machine. The bits are the same: nothing is fused or reordered.
#[inline]
pub(crate) fn widest<L: Loops>(loops: L) -> L::Result {
    #[cfg(target_arch = "x86_64")]
    if has_avx2() {
        #[allow(unsafe_code, reason = "this machine has the instructions")]
        // SAFETY: this machine has AVX2, and the function needs nothing else.
        return unsafe { with_avx2(loops) };
    }
    loops.run()
}

/// Runs loops over the [lanes](crate::model::LANES) of several systems, which a vector of AVX-512 holds all; without
/// it, as [`widest`]. The bits are the same.
#[inline]
pub(crate) fn over_lanes<L: Loops>(loops: L) -> L::Result {
    #[cfg(target_arch = "x86_64")]
    if has_avx512() {
        #[allow(unsafe_code, reason = "this machine has the instructions")]
        // SAFETY: this machine has both parts of AVX-512, and the function needs nothing else.
        return unsafe { with_avx512(loops) };
    }
    widest(loops)
}

/// Number of values that straight-line code computes together.
#[derive(Clone, Copy)]
#[cfg_attr(
    not(target_arch = "x86_64"),
    allow(dead_code, reason = "other processors always have `Four`")
)]
pub(crate) enum Width {
    /// A single number.
    One,
    /// [`Four`].
    Four,
    /// [`Eight`].
    Eight,
}

/// The widest vectors of this machine.
#[inline]
pub(crate) fn width() -> Width {
    #[cfg(not(target_arch = "x86_64"))]
    return Width::Four;
    #[cfg(target_arch = "x86_64")]
    if has_avx512() {
        Width::Eight
    } else if has_avx2() {
        Width::Four
    } else {
        Width::One
    }
}

#[cfg(target_arch = "x86_64")]
#[inline]
fn has_avx2() -> bool {
    std::arch::is_x86_feature_detected!("avx2")
}

#[cfg(target_arch = "x86_64")]
#[inline]
fn has_avx512() -> bool {
    std::arch::is_x86_feature_detected!("avx512f") && std::arch::is_x86_feature_detected!("avx512dq")
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2")]
fn with_avx2<L: Loops>(loops: L) -> L::Result {
    loops.run()
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx512f,avx512dq")]
fn with_avx512<L: Loops>(loops: L) -> L::Result {
    loops.run()
}
