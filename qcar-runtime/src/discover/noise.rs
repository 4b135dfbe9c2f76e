//! What differs between a measurement and a model that is right, beside noise: errors of sensors, which data sheets limit,
//! and what any model of this kind misses.

// How a sensor may be wrong, and by how much.
mod calibration;
// The errors of all sensors as unknowns.
mod nuisance;
// What they change in a prediction itself.
mod misread;
// What they change in what is shown of it.
mod shown;
// What any model of this kind misses.
mod discrepancy;

pub use calibration::{Form, SENSOR, STRAINED, Shape};
pub use discrepancy::{Discrepancy, Missed};
pub use nuisance::{Beginning, Nuisance, Suspect};
pub use shown::Shown;
