//! Permutations of any number of elements, evaluated at single elements.

use crate::random::SplitMix;

/// Number of rounds: with fewer than six, small permutations are visibly regular.
const ROUNDS: u64 = 6;

/// Image of `place` under a permutation of `0..count`: a Feistel network over the next power of four, repeated until
/// the result is below `count` (Black and Rogaway, "Ciphers with arbitrary finite domains", CT-RSA 2002).
pub(super) fn permuted(place: u64, count: u64, seed: u64) -> u64 {
    let half = (u64::BITS - (count - 1).leading_zeros()).div_ceil(2).max(1);
    let mut at = place;
    loop {
        at = shuffled(at, half, seed);
        if at < count {
            return at;
        }
    }
}

/// A permutation of all numbers of twice `half` bits.
fn shuffled(number: u64, half: u32, seed: u64) -> u64 {
    let mask = (1_u64 << half) - 1;
    let (mut left, mut right) = (number >> half, number & mask);
    for round in 0..ROUNDS {
        let mixed = SplitMix::stream(seed, right ^ (round << 40)).bits() & mask;
        (left, right) = (right, left ^ mixed);
    }
    (left << half) | right
}

#[cfg(test)]
mod tests {
    use super::permuted;
    use std::collections::BTreeSet;

    #[test]
    fn every_number_comes_once() {
        for count in [1, 2, 3, 7, 64, 1000, 4097] {
            let all: BTreeSet<u64> = (0..count).map(|place| permuted(place, count, 5)).collect();
            assert_eq!(all, (0..count).collect(), "{count}");
        }
    }

    /// Images of neighbours are far apart: their mean distance in a random permutation of n is n/3, here within 5
    /// standard errors (the distance of two random positions has a standard deviation of n/√18).
    #[test]
    fn the_order_is_no_order() {
        let count = 10_000;
        let apart = |place: u64| permuted(place, count, 1).abs_diff(permuted(place + 1, count, 1)) as f64;
        let mean = (0..count - 1).map(apart).sum::<f64>() / (count as f64 - 1.0);
        let error = count as f64 / 18f64.sqrt() / (count as f64).sqrt();
        assert!((mean - count as f64 / 3.0).abs() < 5.0 * error, "{mean}");
    }
}
