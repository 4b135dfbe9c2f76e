//! Metrics of an axle: one name, one value, one derivative by each parameter.
//!
//! A [`Metric`] is spelled the same wherever it is asked for: `body_x.peak`, `wheel_z.vdv`, `tyre.dynamic_load`,
//! `suspension.travel`, `pad_to_body.peak`, `mode.1.damping`. A [`Ground`] measures them of a model.

// A model that tells of the travel of its suspension.
mod watched;
// Which there are.
mod name;
// What one says of a record.
mod record;
// Vibrations and their derivatives.
mod vibration;
// What is driven over.
mod course;
// All metrics of a model.
mod ground;

pub use course::{Course, SEED};
pub use ground::{Ground, MetricError, Reading, Slopes, Trace};
pub use name::{Measure, Metric, What, metrics};
