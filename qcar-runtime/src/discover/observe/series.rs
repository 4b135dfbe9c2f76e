//! Values of one sensor in one run.

use nalgebra::Complex;

use crate::transmissibility::Point;

/// The least noise of a value, in parts of the signal: that of a converter of twelve bits.
pub(super) const LEAST_NOISE: f64 = 2.4e-4;

/// Values of one kind that one sensor gave in one run.
#[derive(Clone, Debug, PartialEq)]
pub struct Series {
    /// Place in [`Evidence::runs`](super::Evidence::runs).
    pub run: usize,
    /// The sensor: the mean of all sides of a location, or an end of it.
    pub sensor: Point,
    /// What the values are.
    pub kind: Kind,
    /// Where each value belongs; see [`Kind`].
    pub at: Vec<f64>,
    /// The values; the imaginary part is zero where they are real.
    pub value: Vec<Complex<f64>>,
    /// Standard deviation of the noise of each value: `E|error|²` is its square.
    pub sigma: Vec<f64>,
    /// The part of it that is independent from value to value.
    pub noise: Vec<f64>,
    /// What no calibration and no model gets right, in parts of the signal: the other part, which neighbours have in common.
    pub least_discrepancy: f64,
}

/// What the values of a series are.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Kind {
    /// Responses at `order` times the frequency (Hz) of the excitation at which they stand, over its amplitude there.
    Harmonic(usize),
    /// Samples at a time (s).
    Time,
    /// Means around a time (s) of a passage, as [`Means`](super::Means) takes them.
    Passage,
    /// Forces at a travel (m), both positive in compression, or forwards.
    Travel,
    /// Half of what the force is larger at that travel while it grows than while it falls.
    Width,
    /// Forces at a speed (m/s) of a link alone, both positive as it gets longer.
    Speed,
    /// Forces at `order` times the frequency (Hz) of a sine of travel at which they stand, over its amplitude.
    Cycle(usize),
}

impl Kind {
    /// Which harmonic the values are; `None` for other than harmonics.
    pub fn order(self) -> Option<usize> {
        match self {
            Kind::Harmonic(order) | Kind::Cycle(order) => Some(order),
            _ => None,
        }
    }

    /// True where values have an imaginary part.
    pub fn complex(self) -> bool {
        match self {
            Kind::Harmonic(_) | Kind::Cycle(_) => true,
            Kind::Time | Kind::Passage | Kind::Travel | Kind::Width | Kind::Speed => false,
        }
    }

    /// The frequency (Hz) at which a sensor of motion reads a value at `at`, where it has one.
    pub fn frequency(self, at: f64) -> Option<f64> {
        match self {
            Kind::Harmonic(order) => Some(order as f64 * at),
            Kind::Time | Kind::Passage | Kind::Travel | Kind::Width | Kind::Speed | Kind::Cycle(_) => None,
        }
    }
}

impl Series {
    /// Half a period of the mean frequency of a record, s: of the root of the ratio of the mean squares of its slope and
    /// itself (Rice's formula for a Gaussian process).
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

    /// Keeps every so many-th value.
    pub fn thin(&mut self, step: usize) {
        self.keep((0..self.at.len()).step_by(step));
    }

    pub(super) fn keep(&mut self, places: impl Iterator<Item = usize> + Clone) {
        self.at = places.clone().map(|k| self.at[k]).collect();
        self.value = places.clone().map(|k| self.value[k]).collect();
        self.sigma = places.clone().map(|k| self.sigma[k]).collect();
        self.noise = places.map(|k| self.noise[k]).collect();
    }

    /// Number of real residuals.
    pub fn residuals(&self) -> usize {
        self.value.len() * if self.kind.complex() { 2 } else { 1 }
    }
}
