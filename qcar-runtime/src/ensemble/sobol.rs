//! Sobol's sequence: points that cover a cube more uniformly than random ones (Sobol 1967; Bratley and Fox, "Algorithm
//! 659", ACM Trans. Math. Softw. 14, 1988).

mod directions;

use directions::TABLE;

use crate::random::SplitMix;

/// Number of dimensions with direction numbers.
pub const DIMENSIONS: usize = TABLE.len() + 1;

/// Number of distinct points.
pub const POINTS: u64 = 1 << BITS;

const BITS: u32 = 32;

/// The direction numbers of some dimensions.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Sobol {
    directions: Vec<[u32; BITS as usize]>,
    /// Random shift of the points of each dimension, bit by bit.
    shifts: Vec<u32>,
}

impl Sobol {
    /// The sequence in a cube of at most [`DIMENSIONS`] dimensions. Seed 0 is the original sequence; any other shifts
    /// all points by random bits, which keeps their uniformity (Owen, "Monte Carlo theory, methods and examples",
    /// section 17.4).
    pub fn new(dimensions: usize, seed: u64) -> Self {
        assert!(dimensions <= DIMENSIONS, "the caller has counted the dimensions");
        let shift = |dimension: usize| match seed {
            0 => 0,
            _ => (SplitMix::stream(seed, dimension as u64).bits() >> BITS) as u32,
        };
        Self {
            directions: (0..dimensions).map(directions).collect(),
            shifts: (0..dimensions).map(shift).collect(),
        }
    }

    /// A coordinate of a point, in [0, 1). Points come in the order of Gray's code.
    pub fn coordinate(&self, point: u64, dimension: usize) -> f64 {
        let gray = point ^ (point >> 1);
        let chosen = self.directions[dimension].iter().enumerate();
        let chosen = chosen.filter(|(bit, _)| gray >> bit & 1 == 1);
        let bits = chosen.fold(self.shifts[dimension], |bits, (_, direction)| bits ^ direction);
        f64::from(bits) / POINTS as f64
    }
}

/// The direction numbers of a dimension as binary fractions: those of the table, and further ones by the recurrence of
/// its polynomial. The first dimension is the van der Corput sequence.
fn directions(dimension: usize) -> [u32; BITS as usize] {
    let mut found = std::array::from_fn(|bit| 1 << (BITS - 1 - bit as u32));
    let Some((coefficients, first)) = dimension.checked_sub(1).map(|row| TABLE[row]) else {
        return found;
    };
    let degree = first.len();
    for bit in 0..found.len() {
        found[bit] = match bit.checked_sub(degree) {
            None => first[bit] << (BITS - 1 - bit as u32),
            Some(back) => {
                let inner = (1..degree).filter(|term| coefficients >> (degree - 1 - term) & 1 == 1);
                let start = found[back] ^ (found[back] >> degree);
                inner.fold(start, |sum, term| sum ^ found[bit - term])
            }
        };
    }
    found
}

#[cfg(test)]
mod tests {
    use super::{DIMENSIONS, Sobol};

    /// The points of Joe and Kuo's own program.
    #[test]
    fn the_first_points_are_those_of_the_literature() {
        let sobol = Sobol::new(3, 0);
        let point = |at| [0, 1, 2].map(|dimension| sobol.coordinate(at, dimension));
        let first = [0, 1, 2, 3, 4].map(point);
        let expected = [
            [0.0, 0.0, 0.0],
            [0.5, 0.5, 0.5],
            [0.75, 0.25, 0.25],
            [0.25, 0.75, 0.75],
            [0.375, 0.375, 0.625],
        ];
        assert_eq!(first, expected);
    }

    /// Of 2^k points each interval of length 2^-k holds one, in every dimension, shifted or not.
    #[test]
    fn every_dimension_is_even() {
        const COUNT: usize = 256;
        for seed in [0, 7] {
            let sobol = Sobol::new(DIMENSIONS, seed);
            for dimension in 0..DIMENSIONS {
                let mut seen = [false; COUNT];
                for point in 0..COUNT as u64 {
                    seen[(sobol.coordinate(point, dimension) * COUNT as f64) as usize] = true;
                }
                assert!(seen.iter().all(|seen| *seen), "dimension {dimension}, seed {seed}");
            }
        }
    }
}
