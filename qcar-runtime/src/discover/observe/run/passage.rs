//! A passage over an obstacle.

use super::means::Means;
use crate::road::Road;
use crate::tyre::Tyre;

/// A passage over an obstacle at constant speed.
#[derive(Clone, Debug, PartialEq)]
pub struct Passage {
    /// Road profile with the obstacle.
    pub road: Road,
    /// Speed, m/s.
    pub speed: f64,
    /// The tyre.
    pub tyre: Tyre,
    /// Static load of the tyre, N.
    pub load: f64,
    /// Duration of the evidence, s after the wheel centre passes x = 0.
    pub duration: f64,
    /// Sampling of the record by weighted means.
    pub means: Means,
    /// Most integration steps for each simulated second.
    pub most_steps: f64,
    /// For a linear axle, points of a sample at which its derivatives are stepped: see
    /// [`variation`](crate::simulate::variation).
    pub points_a_sample: usize,
}

/// Points of a sample for derivatives with an error of a hundredth of the signal.
pub const FINE_POINTS: usize = 2;
/// Points of a sample for derivatives with an error of a twentieth, in half the time: enough for all but the last fit.
pub const COARSE_POINTS: usize = 1;

/// Most steps for a second of a single passage.
pub const PATIENT: f64 = 1e5;
/// Most steps for a second of a passage in a search over many candidates. Realistic cars need 500 to 2000. Dry friction
/// with a vanishing force and the same stiffness takes ten times as many.
pub const HURRIED: f64 = 4e3;
