//! Missing dynamic stiffness, run by run.

use nalgebra::Complex;

use crate::transmissibility::Point;

/// A place where something may be missing.
#[derive(Clone, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Place {
    /// The link or mass with this parameter in its law or inertia, by the position of the parameter in the model.
    Parameter(usize),
    /// A sensor whose signal is wrong by a free factor at every frequency.
    Sensor(Point),
}

/// Missing dynamic stiffness at one place.
#[derive(Clone, Debug, PartialEq)]
pub struct MissingStiffness {
    /// The place.
    pub place: Place,
    /// Share of the squared residual of the first harmonics that the best smooth κ at this place explains, free for
    /// each run. No effect at this place alone explains more.
    pub ceiling: f64,
    /// The same share for the mean κ of all runs. If κ depends on amplitude, it is far below `ceiling` or negative.
    pub common: f64,
    /// κ in each run with first harmonics.
    pub runs: Vec<RunStiffness>,
}

/// κ in one run, line by line.
#[derive(Clone, Debug, PartialEq)]
pub struct RunStiffness {
    /// Position in [`Evidence::runs`](crate::discover::Evidence::runs).
    pub run: usize,
    /// Level of the run: peak velocity of the pad, m/s.
    pub level: f64,
    /// Frequencies, Hz.
    pub frequency: Vec<f64>,
    /// Added dynamic stiffness, N/m; for a sensor, the factor on its signal minus 1.
    pub value: Vec<Complex<f64>>,
    /// Standard deviation of each value, in its unit.
    pub sigma: Vec<f64>,
}
