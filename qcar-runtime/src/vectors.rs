//! Loops and straight-line code with the widest vectors of the machine that they run on.

// A number, or several at a time.
mod number;
// Several at a time, with the vectors of x86-64.
#[cfg(target_arch = "x86_64")]
mod x86;

use std::marker::PhantomData;

pub use number::Number;

/// Loops over plain numbers that gain by wide vectors.
pub(crate) trait Loops {
    /// What comes of them.
    type Result;

    /// To be inlined always: it is compiled once for each instruction set that [`widest`] knows.
    fn run(self) -> Self::Result;
}

/// Runs loops with the widest vectors of this machine. The bits are the same: nothing is fused or reordered.
#[inline]
pub(crate) fn widest<L: Loops>(loops: L) -> L::Result {
    #[cfg(target_arch = "x86_64")]
    if has_avx2() {
        #[allow(unsafe_code, reason = "the instruction set is there: it has just been asked for")]
        // SAFETY: this machine has AVX2, and the function asks for nothing else.
        return unsafe { with_avx2(loops) };
    }
    loops.run()
}

/// Runs loops over the [lanes](crate::model::LANES) of several systems, which a vector of AVX-512 holds all; without it, as
/// [`widest`]. The bits are the same.
#[inline]
pub(crate) fn over_lanes<L: Loops>(loops: L) -> L::Result {
    #[cfg(target_arch = "x86_64")]
    if has_avx512() {
        #[allow(unsafe_code, reason = "the instruction set is there: it has just been asked for")]
        // SAFETY: this machine has both parts of AVX-512, and the function asks for nothing else.
        return unsafe { with_avx512(loops) };
    }
    widest(loops)
}

/// Straight-line code over numbers of any width.
pub(crate) trait Straight {
    /// To be inlined always: it is compiled once for each width that [`in_vectors`] knows.
    fn run<V: Number>(self);
}

/// Runs straight-line code over the widest vectors of this machine. The bits are the same.
#[inline]
pub(crate) fn in_vectors<S: Straight>(code: S) {
    #[cfg(target_arch = "x86_64")]
    {
        if has_avx512() {
            #[allow(unsafe_code, reason = "the instruction set is there: it has just been asked for")]
            // SAFETY: this machine has both parts of AVX-512, and the function asks for nothing else.
            return unsafe { with_avx512(Over::<x86::Eight, S>::new(code)) };
        }
        if has_avx2() {
            #[allow(unsafe_code, reason = "the instruction set is there: it has just been asked for")]
            // SAFETY: this machine has AVX2, and the function asks for nothing else.
            return unsafe { with_avx2(Over::<x86::Four, S>::new(code)) };
        }
    }
    Over::<number::Pair, S>::new(code).run();
}

/// Straight-line code over numbers of one width.
struct Over<V, S> {
    code: S,
    width: PhantomData<V>,
}

impl<V: Number, S: Straight> Over<V, S> {
    fn new(code: S) -> Self {
        let width = PhantomData;
        Over { code, width }
    }
}

impl<V: Number, S: Straight> Loops for Over<V, S> {
    type Result = ();

    #[inline(always)]
    fn run(self) {
        self.code.run::<V>();
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

#[cfg(test)]
mod tests {
    use super::number::Pair;
    use super::*;

    const VALUES: [f64; 8] = [1.5, -0.25, 0.0, -0.0, f64::NAN, 1e300, -7.0, f64::INFINITY];

    /// All operations of a vector on two of eight values each, by pairs, fours or eights.
    struct Operations<'a>(&'a mut [[f64; 8]]);

    impl Straight for Operations<'_> {
        #[inline(always)]
        fn run<V: Number>(self) {
            let mut turned = VALUES;
            turned.rotate_left(3);
            for first in (0..8).step_by(V::LANES) {
                let (a, b) = (V::load(&VALUES[first..]), V::load(&turned[first..]));
                let found = [
                    -a,
                    a + b,
                    a - b,
                    a * b,
                    a / b,
                    a.abs(),
                    a.sqrt(),
                    V::min(a, b),
                    V::max(a, b),
                    V::choose(a, b, V::of(3.0)),
                    a.sign(),
                    a.tanh(),
                    V::powf(a, b),
                ];
                let rows = self.0.iter_mut().zip(found);
                rows.for_each(|(row, found)| found.store(&mut row[first..]));
            }
        }
    }

    #[test]
    fn a_vector_of_any_width_has_the_bits_of_its_numbers() {
        let rows = || [[9.0; 8]; 13];
        let of = |run: fn(Operations)| {
            let mut found = rows();
            run(Operations(&mut found));
            found.map(|row| row.map(|value| if value.is_nan() { None } else { Some(value.to_bits()) }))
        };
        let alone = of(|code| code.run::<f64>());
        assert_eq!(of(|code| code.run::<Pair>()), alone);
        assert_eq!(of(|code| in_vectors(code)), alone);
        #[cfg(target_arch = "x86_64")]
        if has_avx2() {
            #[allow(unsafe_code, reason = "the instruction set is there: it has just been asked for")]
            // SAFETY: this machine has AVX2, and the function asks for nothing else.
            let four = of(|code| unsafe { with_avx2(Over::<x86::Four, _>::new(code)) });
            assert_eq!(four, alone);
        }
    }
}
