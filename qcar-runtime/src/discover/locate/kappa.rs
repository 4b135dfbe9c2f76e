//! A dynamic stiffness that would have to be there, run by run.

use nalgebra::Complex;

use crate::transmissibility::Point;

/// Where something may be missing.
#[derive(Clone, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Place {
    /// Across the link, or at the mass, whose law or inertia this parameter of the model is.
    Parameter(usize),
    /// In a sensor: its signal alone is wrong, by a factor of its own at every frequency.
    Sensor(Point),
}

/// What would have to be there.
#[derive(Clone, Debug, PartialEq)]
pub struct Kappa {
    /// Where.
    pub place: Place,
    /// Share of the squared gap of the first harmonics that the best smooth κ at this place explains, run by run freely:
    /// no effect at this place alone explains more.
    pub ceiling: f64,
    /// The same for the mean κ of all runs: far below `ceiling`, even negative, where κ depends on amplitude.
    pub common: f64,
    /// For each run with first harmonics.
    pub runs: Vec<KappaRun>,
}

/// κ in one run.
#[derive(Clone, Debug, PartialEq)]
pub struct KappaRun {
    /// Place in [`Evidence::runs`](crate::discover::Evidence::runs).
    pub run: usize,
    /// The level of the run.
    pub level: f64,
    /// Hz.
    pub frequency: Vec<f64>,
    /// The added dynamic stiffness, N/m; of a sensor the factor on its signal, less 1.
    pub value: Vec<Complex<f64>>,
    /// Standard deviation of each.
    pub sigma: Vec<f64>,
}
