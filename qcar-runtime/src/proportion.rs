//! The factor between two measurements of the same quantity, which is 1 unless a unit or a sign is wrong.

/// Largest factor, either way, between measurements that agree. A choice: rigs and filtered sensors deviate by less, and
/// units that are confused (ft for m, 3.28) and wrong signs by more.
const ALIKE: f64 = 2.0;

/// The first measurement over the second, in pairs of values; `None` if one of them is zero throughout, or not finite.
///
/// The second values may contain noise, which does not bias the factor; noise of the first ones increases it.
pub fn factor(pairs: impl Iterator<Item = (f64, f64)>) -> Option<f64> {
    let sums = |[aa, ab, bb]: [f64; 3], (a, b): (f64, f64)| [aa + a * a, ab + a * b, bb + b * b];
    let [aa, ab, bb] = pairs.fold([0.0; 3], sums);
    let size = aa * bb;
    (size > 0.0 && size.is_finite()).then(|| aa / ab)
}

/// True for a factor between measurements of one quantity that agree.
pub fn is_alike(factor: f64) -> bool {
    (1.0 / ALIKE..=ALIKE).contains(&factor)
}
