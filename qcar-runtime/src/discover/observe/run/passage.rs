//! A ride over an obstacle.

use super::means::Means;
use crate::road::Road;
use crate::tyre::Tyre;

/// A ride over an obstacle at constant speed.
#[derive(Clone, Debug, PartialEq)]
pub struct Passage {
    /// What was driven over.
    pub road: Road,
    /// m/s.
    pub speed: f64,
    /// What rolled.
    pub tyre: Tyre,
    /// Static load of the tyre, N.
    pub load: f64,
    /// How long the evidence lasts, s after the wheel's centre was above x = 0.
    pub duration: f64,
    /// How a ride is sampled and read.
    pub means: Means,
    /// The most steps in which a second of it may be simulated.
    pub most_steps: f64,
    /// Points a sample at which its derivatives are stepped, of a linear axle: see [`variation`](crate::simulate::variation).
    pub points_a_sample: usize,
}

/// Derivatives of a ride that are good to a hundredth of the signal,
pub const FINE_POINTS: usize = 2;
/// and to a twentieth, in half the time: enough where the fit is not the last one.
pub const COARSE_POINTS: usize = 1;

/// The most steps for a second of a ride.
pub const PATIENT: f64 = 1e5;
/// The same among many. Five hundred to two thousand are enough for what cars have; dry friction that a search has made next
/// to none, and as stiff as ever, takes ten times as many.
pub const HURRIED: f64 = 4e3;
