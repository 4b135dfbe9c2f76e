//! Systematic differences between a measurement and a right model: sensor errors within their data sheets, and the
//! model discrepancy.

// Forms and priors of sensor errors.
mod calibration;
// Nuisance parameters of all sensors.
mod nuisance;
// Effect of sensor errors on the prediction itself.
mod misread;
// Effect of sensor errors on the displayed values.
mod shown;
// Gaussian process discrepancy of the model.
mod discrepancy;

pub use calibration::{Form, SENSOR, STRAINED, Shape};
pub use discrepancy::{Discrepancy, Missed};
pub use nuisance::{Beginning, Nuisance, Suspect};
pub use shown::Shown;
