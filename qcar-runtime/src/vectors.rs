//! Loops with the widest vectors of the machine that they run on.

/// Loops over plain numbers that gain by wide vectors.
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
    if std::arch::is_x86_feature_detected!("avx2") {
        #[allow(unsafe_code, reason = "the instruction set was detected above")]
        // SAFETY: this machine has AVX2, and the function requires nothing else.
        return unsafe { with_avx2(loops) };
    }
    loops.run()
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2")]
fn with_avx2<L: Loops>(loops: L) -> L::Result {
    loops.run()
}

/// Runs loops over the [lanes](crate::model::LANES) of several systems with AVX-512, one vector of which holds all
/// lanes; without it, as [`widest`]. The bits are the same.
#[inline]
pub(crate) fn over_lanes<L: Loops>(loops: L) -> L::Result {
    #[cfg(target_arch = "x86_64")]
    if std::arch::is_x86_feature_detected!("avx512f") && std::arch::is_x86_feature_detected!("avx512dq") {
        #[allow(unsafe_code, reason = "the instruction set was detected above")]
        // SAFETY: this machine has both parts of AVX-512, and the function requires nothing else.
        return unsafe { with_avx512(loops) };
    }
    widest(loops)
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx512f,avx512dq")]
fn with_avx512<L: Loops>(loops: L) -> L::Result {
    loops.run()
}
