//! The complete model of thesis section 3.3 in the time domain, and replays of recorded inputs.
//!
//! [`ride`] simulates a model whose tyre rolls over a road at constant speed (figure 3.2); [`Replay`] drives it with
//! recorded inputs. Positions of a model are displacements from the design position, in which the car is at rest. Every
//! link of the suspension has its static preload there, and its law gives the additional force, as K&C curves do. So
//! gravity and preloads cancel, and the driving force is that of the tyre minus its static load.

mod failure;
// Accuracy of a simulation.
mod settings;
// Interpolation between the samples of a smooth motion.
mod interpolation;
// Sampling through an anti-alias filter.
mod sampling;
// The static equilibrium of a model.
mod equilibrium;
// A model with its tyre and static load.
mod car;
// A point contact between the events at which its force jumps.
mod held;
// The equations of motion while the tyre rolls over a road.
mod rolling;
// Faster integration of linear axles.
mod exponential;
// The signals recorded during a ride.
mod recorder;
// Rides over a road.
mod ride;
// Integration of several smooth motions with common steps.
mod batch;
// Several rides integrated together.
mod abreast;
// Derivatives of rides by parameters.
mod tangent;
// The same for linear axles, faster.
mod variation;
// The cleat runs of a campaign.
mod cleat;
// The cleat runs of the thesis.
mod standard;
// A model driven by records.
pub mod replay;

pub use abreast::{RideCase, rides_abreast};
pub use car::{Car, Variant};
pub use cleat::{Cleat, tyre, tyre_of};
pub use failure::SimulateError;
pub use recorder::RecordedSignals;
pub use replay::{Accuracy, Between, Reading, Recorded, Replay, replay};
pub use ride::{Drive, Ride, end_of_ride, ride, rides};
pub use sampling::AntiAlias;
pub use settings::{Method, Settings};
pub use standard::Standard;
pub use tangent::{Tangent, tangent};
pub use variation::variation;
