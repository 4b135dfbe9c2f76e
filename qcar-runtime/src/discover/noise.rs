//! Systematic differences between a measurement and a correct model: sensor errors within their data sheets, and the
//! model discrepancy.

// Forms and priors of sensor errors.
mod calibration;
// Nuisance parameters of all sensors.
mod nuisance;
// Unknown test conditions, which change the prediction itself.
mod conditions;
// Readings of sensors with errors.
mod sensor_output;
// Gaussian process discrepancy of the model.
mod discrepancy;

pub use calibration::{AccuracyClass, CALIBRATION_BOUND, Form, SENSOR, Shape};
pub use discrepancy::{Discrepancy, Factors, GroupDiscrepancy};
pub use nuisance::{InitialState, Known, Nuisance, Suspect};
pub use sensor_output::SensorOutput;
