//! Dot products.

/// A dot product with eight independent sums, since one sum cannot be vectorised without reordering it.
#[inline(always)]
pub(crate) fn dot(a: &[f64], b: &[f64]) -> f64 {
    let [product] = dots(a, [b]);
    product
}

/// The same of one row with several of its length, bit by bit. Together they hide the time that each addition takes.
#[inline(always)]
pub(crate) fn dots<const N: usize>(a: &[f64], b: [&[f64]; N]) -> [f64; N] {
    let (a, rest_of_a) = a.as_chunks::<8>();
    let b = b.map(|b| b.as_chunks::<8>());
    let mut sums = [[0.0; 8]; N];
    for (at, a) in a.iter().enumerate() {
        for (sums, (b, _)) in sums.iter_mut().zip(&b) {
            (0..8).for_each(|lane| sums[lane] += a[lane] * b[at][lane]);
        }
    }
    std::array::from_fn(|own| {
        let rest = rest_of_a.iter().zip(b[own].1).map(|(a, b)| a * b);
        sums[own].iter().sum::<f64>() + rest.sum::<f64>()
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Of whole numbers every order of the sums has the same bits.
    #[test]
    fn dot_products_of_whole_numbers_are_exact() {
        let row = |seed: i64, length: i64| (0..length).map(|at| ((at * seed) % 17 - 8) as f64).collect::<Vec<_>>();
        for length in [0, 1, 7, 8, 9, 192] {
            let [a, b, c] = [3, 5, 7].map(|seed| row(seed, length));
            let plain = |b: &[f64]| a.iter().zip(b).fold(0.0, |sum, (a, b)| sum + a * b);
            assert_eq!(dots(&a, [&b, &c]), [plain(&b), plain(&c)]);
            assert_eq!(dot(&a, &b), plain(&b));
        }
    }
}
