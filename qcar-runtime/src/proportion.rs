//! The factor between two measurements of the same quantity, which is 1 unless a unit or a sign is wrong.

/// Largest factor, either way, between measurements that agree. A choice: rigs and filtered sensors deviate by less, and
/// units that are confused (ft for m, 3.28) and wrong signs by more.
const ALIKE: f64 = 2.0;

/// How one measurement is proportional to another.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Proportion {
    /// The first measurement over the second.
    pub factor: f64,
    /// Correlation about zero, from -1 to 1: near zero if the factor is that of noise.
    pub correlation: f64,
}

impl Proportion {
    /// The proportion in pairs of values; `None` if one of the measurements is zero throughout, or not finite.
    ///
    /// The second values may contain noise, which does not bias the factor; noise of the first ones increases it.
    pub fn of(pairs: impl Iterator<Item = (f64, f64)>) -> Option<Proportion> {
        let sums = |[aa, ab, bb]: [f64; 3], (a, b): (f64, f64)| [aa + a * a, ab + a * b, bb + b * b];
        let [aa, ab, bb] = pairs.fold([0.0; 3], sums);
        let size = (aa * bb).sqrt();
        (size > 0.0 && size.is_finite()).then(|| Proportion {
            factor: aa / ab,
            correlation: ab / size,
        })
    }
}

/// True for a factor between measurements of one quantity that agree.
pub fn is_alike(factor: f64) -> bool {
    (1.0 / ALIKE..=ALIKE).contains(&factor)
}
