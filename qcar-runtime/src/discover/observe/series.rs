//! Values of one sensor in one run.

use std::ops::Range;

use nalgebra::Complex;

use crate::campaign::Role;
use crate::random::SplitMix;
use crate::transmissibility::Point;

/// Smallest noise of a value relative to the signal: that of a 12-bit converter.
pub(super) const LEAST_NOISE: f64 = 2.4e-4;

/// Values of one kind from one sensor in one run.
#[derive(Clone, Debug, PartialEq)]
pub struct Series {
    /// Position in [`Evidence::runs`](super::Evidence::runs).
    pub run: usize,
    /// The sensor: the mean of all sides of a location, or one end of it.
    pub sensor: Point,
    /// Kind of the values.
    pub kind: Kind,
    /// Abscissa of each value; see [`Kind`] for its unit.
    pub at: Vec<f64>,
    /// The values; real values have a zero imaginary part.
    pub value: Vec<Complex<f64>>,
    /// Standard deviation of each value: its square is `E|error|²`.
    pub sigma: Vec<f64>,
    /// The part of `sigma` that is independent from value to value.
    pub noise: Vec<f64>,
    /// The other part of `sigma`, which neighbouring values share, relative to the signal: the smallest error of any
    /// calibration and any model.
    pub least_discrepancy: f64,
}

/// Kind of the values of a series.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Kind {
    /// Response at `order` times the excitation frequency, over the excitation amplitude; the abscissa is the
    /// excitation frequency (Hz).
    Harmonic(usize),
    /// Sample at a time (s).
    Time,
    /// Weighted mean at a time (s) of a passage: see [`Means`](super::Means).
    Passage,
    /// Force (N) at a travel (m), both positive in compression or forwards.
    Travel,
    /// Half the force difference (N) between increasing and decreasing travel, at a travel (m).
    Width,
    /// Force (N) of a single link at a speed (m/s), both positive in extension.
    Speed,
    /// Force at `order` times the frequency of a travel sine, over its amplitude; the abscissa is the frequency (Hz) of
    /// the sine.
    Cycle(usize),
}

impl Kind {
    /// Order of the harmonic; `None` if the values are no harmonics.
    pub fn order(self) -> Option<usize> {
        match self {
            Kind::Harmonic(order) | Kind::Cycle(order) => Some(order),
            _ => None,
        }
    }

    /// True if the values are complex.
    pub fn complex(self) -> bool {
        match self {
            Kind::Harmonic(_) | Kind::Cycle(_) => true,
            Kind::Time | Kind::Passage | Kind::Travel | Kind::Width | Kind::Speed => false,
        }
    }

    /// Number of real parts of a value.
    pub fn parts(self) -> usize {
        if self.complex() { 2 } else { 1 }
    }

    /// Frequency (Hz) at which a motion sensor reads the value at `at`; `None` if it has none.
    pub fn frequency(self, at: f64) -> Option<f64> {
        match self {
            Kind::Harmonic(order) => Some(order as f64 * at),
            Kind::Time | Kind::Passage | Kind::Travel | Kind::Width | Kind::Speed | Kind::Cycle(_) => None,
        }
    }
}

impl Series {
    /// Half the mean period of a record, s, from the mean squares of the signal and its derivative (Rice's formula for
    /// a Gaussian process).
    pub fn half_a_period(&self) -> f64 {
        let count = self.at.len() as f64;
        let mean = self.value.iter().map(|value| value.re).sum::<f64>() / count;
        let power: f64 = self.value.iter().map(|value| (value.re - mean).powi(2)).sum();
        let pairs = self.value.windows(2).zip(self.at.windows(2));
        let slope = pairs
            .map(|(y, t)| ((y[1].re - y[0].re) / (t[1] - t[0])).powi(2))
            .sum::<f64>();
        std::f64::consts::PI * (power / slope.max(f64::MIN_POSITIVE)).sqrt()
    }

    /// Keeps one of each `step` values.
    pub(super) fn thin(&mut self, step: usize, choice: Choice) {
        self.keep(choice.of(0..self.at.len(), step).into_iter());
    }

    pub(super) fn keep(&mut self, places: impl Iterator<Item = usize> + Clone) {
        self.at = places.clone().map(|k| self.at[k]).collect();
        self.value = places.clone().map(|k| self.value[k]).collect();
        self.sigma = places.clone().map(|k| self.sigma[k]).collect();
        self.noise = places.map(|k| self.noise[k]).collect();
    }

    /// Number of real residuals.
    pub fn residuals(&self) -> usize {
        self.value.len() * self.kind.parts()
    }
}

/// Which one of so many samples is compared.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Choice {
    /// The first, in the fitted runs.
    Even,
    /// One at random, always the same, in the held-out runs. At even steps a motion that is too fast for them looks like a
    /// slow one, and a fit may explain a slow one by it. At random ones it is seen as what it is.
    Scattered,
}

impl Choice {
    /// The choice for the runs of a role.
    pub fn for_role(role: Role) -> Self {
        match role {
            Role::Fit => Choice::Even,
            Role::HeldOut => Choice::Scattered,
        }
    }

    /// A place in each `step` of a range.
    pub fn of(self, range: Range<usize>, step: usize) -> Vec<usize> {
        let mut random = SplitMix::new(step as u64);
        let one = |first: usize| match self {
            Choice::Even => first,
            Choice::Scattered => first + random.below(step.min(range.end - first)),
        };
        range.clone().step_by(step).map(one).collect()
    }
}

/// Position of the abscissa nearest to `wanted`. They increase, and there is at least one.
pub fn nearest(at: &[f64], wanted: f64) -> usize {
    let after = at.partition_point(|at| *at < wanted).min(at.len() - 1);
    let before = after.saturating_sub(1);
    if (at[before] - wanted).abs() < (at[after] - wanted).abs() {
        before
    } else {
        after
    }
}
