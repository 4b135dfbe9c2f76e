//! Random numbers that are the same on every machine, and for any number of threads.

use std::f64::consts::TAU;

/// The generator SplitMix64 (Steele, Lea and Flood 2014).
#[derive(Clone, Debug)]
pub struct SplitMix(u64);

impl SplitMix {
    /// The numbers of a seed.
    pub fn new(seed: u64) -> Self {
        Self(seed)
    }

    /// Independent numbers for each `stream` of a seed.
    pub fn stream(seed: u64, stream: u64) -> Self {
        Self(Self(seed).bits() ^ Self(!stream).bits())
    }

    /// Uniform in [0, 1).
    pub fn uniform(&mut self) -> f64 {
        (self.bits() >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// A whole number below `count`, which must be at least one.
    pub fn below(&mut self, count: usize) -> usize {
        ((self.uniform() * count as f64) as usize).min(count - 1)
    }

    /// A Latin hypercube: points of a unit cube, one in each slice along every axis (McKay, Beckman and Conover,
    /// Technometrics 21, 1979).
    pub fn hypercube(&mut self, points: usize, axes: usize) -> Vec<Vec<f64>> {
        let mut all = vec![vec![0.0; axes]; points];
        for axis in 0..axes {
            let mut slices: Vec<usize> = (0..points).collect();
            for last in (1..points).rev() {
                slices.swap(last, self.below(last + 1));
            }
            for (point, slice) in all.iter_mut().zip(slices) {
                point[axis] = (slice as f64 + self.uniform()) / points as f64;
            }
        }
        all
    }

    /// Standard normal (Box and Muller 1958).
    pub fn normal(&mut self) -> f64 {
        let radius = (-2.0 * (1.0 - self.uniform()).ln()).sqrt();
        radius * (TAU * self.uniform()).cos()
    }

    /// Sixty-four random bits.
    pub fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }
}

#[cfg(test)]
mod tests {
    use super::SplitMix;

    #[test]
    fn every_slice_holds_one_point() {
        let points = SplitMix::new(7).hypercube(50, 3);
        for axis in 0..3 {
            let mut slices: Vec<usize> = points.iter().map(|point| (point[axis] * 50.0) as usize).collect();
            slices.sort_unstable();
            assert_eq!(slices, (0..50).collect::<Vec<_>>());
        }
    }
}
