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
    /// End of the simulated passage, s after the wheel centre passes x = 0.
    pub duration: f64,
    /// Sampling of the record by weighted means.
    pub means: Means,
    /// Most integration steps for each simulated second.
    pub most_steps: f64,
    /// For a linear axle, integration steps of its derivatives in one sample interval: see
    /// [`variation`](crate::simulate::variation).
    pub points_a_sample: usize,
}

/// Steps in a sample interval for derivatives with an error of a hundredth of the signal.
pub const FINE_POINTS: usize = 2;
/// Steps in a sample interval for derivatives with an error of a twentieth, in half the time: enough for all fits but
/// the last.
pub const COARSE_POINTS: usize = 1;

/// Most integration steps for a second of a single passage.
pub const STEP_LIMIT: f64 = 1e5;
/// Most integration steps for a second of a passage in a search over many candidates. Realistic cars need 500 to 2000.
/// Dry friction of nearly zero force and unchanged stiffness takes ten times as many.
pub const SEARCH_STEP_LIMIT: f64 = 4e3;
