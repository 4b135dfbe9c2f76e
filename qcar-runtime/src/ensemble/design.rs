//! The parameter sets of an ensemble.

use super::permutation::permuted;
use super::posterior::Posterior;
use super::sobol::Sobol;
use crate::random::SplitMix;

/// A varied parameter.
#[derive(Clone, Debug, PartialEq)]
pub struct Axis {
    /// Position in the model.
    pub parameter: usize,
    /// Lower and upper end, SI.
    pub range: (f64, f64),
}

impl Axis {
    /// The value at a position from 0 (lower bound) to 1 (upper bound); both bounds are exact.
    fn at(&self, part: f64) -> f64 {
        self.range.0 * (1.0 - part) + self.range.1 * part
    }
}

/// Kind of design.
#[derive(Clone, Debug, PartialEq)]
pub enum Scheme {
    /// This number of equally spaced values of each axis; the last axis varies fastest. A single value is the middle.
    Grid(u64),
    /// This number of sets in a Latin hypercube: each axis has one value in each interval (McKay, Beckman and Conover
    /// 1979).
    LatinHypercube(u64),
    /// This number of points of Sobol's sequence.
    Sobol(u64),
    /// This number of draws from the posterior of a fit.
    Posterior(u64, Posterior),
}

/// The parameter sets of an ensemble, each determined by its number.
#[derive(Clone, Debug, PartialEq)]
pub struct Design {
    axes: Vec<Axis>,
    scheme: Scheme,
    seed: u64,
    sobol: Sobol,
}

impl Design {
    /// A design on these axes; a posterior has an axis for each of its estimates, in that order.
    ///
    /// # Panics
    /// If Sobol's sequence has fewer dimensions, or a posterior another number of estimates.
    pub fn new(axes: Vec<Axis>, scheme: Scheme, seed: u64) -> Self {
        let dimensions = match &scheme {
            Scheme::Sobol(_) => axes.len(),
            _ => 0,
        };
        if let Scheme::Posterior(_, posterior) = &scheme {
            assert_eq!(posterior.estimates().len(), axes.len(), "an axis for each estimate");
        }
        Self {
            sobol: Sobol::new(dimensions, seed),
            axes,
            scheme,
            seed,
        }
    }

    /// The axes.
    pub fn axes(&self) -> &[Axis] {
        &self.axes
    }

    /// The posterior of the draws; `None` for other designs.
    pub fn posterior(&self) -> Option<&Posterior> {
        match &self.scheme {
            Scheme::Posterior(_, posterior) => Some(posterior),
            _ => None,
        }
    }

    /// Number of sets; `None` if it overflows.
    pub fn count(&self) -> Option<u64> {
        match self.scheme {
            Scheme::Grid(values) => values.checked_pow(self.axes.len() as u32),
            Scheme::LatinHypercube(count) | Scheme::Sobol(count) | Scheme::Posterior(count, _) => Some(count),
        }
    }

    /// The values of the axes in a set, SI.
    pub fn set(&self, number: u64) -> Vec<f64> {
        let mut values = vec![0.0; self.axes.len()];
        match &self.scheme {
            Scheme::Grid(each) => self.grid(number, *each, &mut values),
            Scheme::LatinHypercube(count) => self.fill(&mut values, |axis| self.stratum(number, *count, axis)),
            Scheme::Sobol(_) => self.fill(&mut values, |axis| self.sobol.coordinate(number, axis)),
            Scheme::Posterior(_, posterior) => posterior.draw(number, self.seed, &mut values),
        }
        values
    }

    fn fill(&self, values: &mut [f64], part: impl Fn(usize) -> f64) {
        for (place, (value, axis)) in values.iter_mut().zip(&self.axes).enumerate() {
            *value = axis.at(part(place));
        }
    }

    fn grid(&self, number: u64, each: u64, values: &mut [f64]) {
        let mut left = number;
        for (value, axis) in values.iter_mut().zip(&self.axes).rev() {
            let part = match each {
                1 => 0.5,
                _ => (left % each) as f64 / (each - 1) as f64,
            };
            *value = axis.at(part);
            left /= each;
        }
    }

    /// A random position in the interval of a set.
    fn stratum(&self, number: u64, count: u64, axis: usize) -> f64 {
        let seed = SplitMix::stream(self.seed, axis as u64).bits();
        let interval = permuted(number, count, seed);
        (interval as f64 + SplitMix::stream(!seed, number).uniform()) / count as f64
    }
}

#[cfg(test)]
mod tests {
    use super::{Axis, Design, Scheme};

    fn design(scheme: Scheme) -> Design {
        let axis = |parameter, range| Axis { parameter, range };
        Design::new(vec![axis(0, (1.0, 2.0)), axis(3, (-10.0, 30.0))], scheme, 1)
    }

    #[test]
    fn a_grid_has_all_pairs_and_its_ends_are_exact() {
        let grid = design(Scheme::Grid(3));
        assert_eq!(grid.count(), Some(9));
        let sets: Vec<Vec<f64>> = (0..9).map(|number| grid.set(number)).collect();
        let expected = [1.0, 1.5, 2.0]
            .iter()
            .flat_map(|a| [-10.0, 10.0, 30.0].map(|b| vec![*a, b]));
        assert_eq!(sets, expected.collect::<Vec<_>>());
        assert_eq!(design(Scheme::Grid(1)).set(0), [1.5, 10.0]);
        assert_eq!(design(Scheme::Grid(u64::MAX)).count(), None);
    }

    #[test]
    fn a_latin_hypercube_has_a_set_in_every_interval_of_every_axis() {
        const COUNT: usize = 37;
        let hypercube = design(Scheme::LatinHypercube(COUNT as u64));
        for axis in 0..2 {
            let (low, high) = hypercube.axes()[axis].range;
            let mut seen = [0; COUNT];
            for number in 0..COUNT as u64 {
                let part = (hypercube.set(number)[axis] - low) / (high - low);
                seen[(part * COUNT as f64) as usize] += 1;
            }
            assert_eq!(seen, [1; COUNT], "axis {axis}");
        }
    }

    #[test]
    fn a_seed_makes_another_design() {
        for scheme in [Scheme::LatinHypercube(8), Scheme::Sobol(8)] {
            let one = design(scheme.clone());
            let other = Design::new(one.axes().to_vec(), scheme, 2);
            assert_ne!(one.set(3), other.set(3));
            assert_eq!(one.set(3), one.clone().set(3));
        }
    }
}
