//! The complete model of thesis section 3.3 in the time domain, and replays of what a rig has done.
//!
//! [`ride`] drives a model whose tyre rolls over a road at constant speed (figure 3.2); [`replay`] drives it by recorded
//! inputs. Positions of a model are displacements from the design position, in which the car stands at rest: every link
//! of the suspension carries its static preload there, and its law says what it gives beyond it, as K&C curves do. So
//! gravity and preloads cancel out, and what moves the car is the force of the tyre less its static load.

mod failure;
// What both kinds of simulation are held to.
mod settings;
// Signals sampled without aliases.
mod sampling;
// Where a model comes to rest.
mod equilibrium;
// A tyre that rolls over a road, and what is recorded of it.
mod car;
mod recorder;
mod ride;
mod rolling;

pub use car::{Car, Variant};
pub use failure::SimulateError;
pub use ride::{Drive, Ride, ride, rides};
pub use sampling::AntiAlias;
pub use settings::{Method, Settings};
