//! The complete model of thesis section 3.3 in the time domain, and replays of what a rig has done.
//!
//! [`ride`] drives a model whose tyre rolls over a road at constant speed (figure 3.2); [`Replay`] drives it by recorded
//! inputs. Positions of a model are displacements from the design position, in which the car stands at rest: every link
//! of the suspension carries its static preload there, and its law says what it gives beyond it, as K&C curves do. So
//! gravity and preloads cancel out, and what moves the car is the force of the tyre less its static load.

mod failure;
// What both kinds of simulation are held to.
mod settings;
// Signals between the samples of a smooth motion.
mod gap;
// Signals sampled without aliases.
mod sampling;
// Where a model comes to rest.
mod equilibrium;
// A model on its tyre.
mod car;
// What moves it while the tyre rolls over a road.
mod rolling;
// What is faster for a linear axle.
mod shortcut;
// What is recorded meanwhile.
mod recorder;
// Rides over a road.
mod ride;
// Several smooth motions in step,
mod formation;
// and rides that go on so.
mod abreast;
// How they change with the parameters,
mod tangent;
// and how those of linear axles do, faster.
mod variation;
// Those that a campaign has measured.
mod cleat;
// Those of the thesis.
mod standard;
// A model driven by records.
pub mod replay;

pub use abreast::{Ridden, rides_abreast};
pub use car::{Car, Variant};
pub use cleat::{Cleat, tyre, tyre_of};
pub use failure::SimulateError;
pub use recorder::Kept;
pub use replay::{Between, Reading, Recorded, Replay, replay};
pub use ride::{Drive, Ride, end_of_ride, ride, rides};
pub use sampling::AntiAlias;
pub use settings::{Method, Settings};
pub use standard::Standard;
pub use tangent::{Tangent, tangent};
pub use variation::variation;
