//! Metrics of an axle: each has a name, a value and a derivative by each parameter.
//!
//! A [`Metric`] has the same name everywhere: `body_x.peak`, `wheel_z.vdv`, `tyre.dynamic_load`, `suspension.travel`,
//! `pad_to_body.peak`, `mode.1.damping`. A [`Ground`] computes them for a model.

// A model with the suspension's travel as an additional output.
mod travel;
// The list of metrics.
mod name;
// The metrics of a time history.
mod record;
// Vibrations and their derivatives.
mod vibration;
// Roads and the speeds at which they are driven.
mod course;
// All metrics of a model over all roads.
mod ground;

pub use course::{Course, SEED};
pub use ground::{Ground, MetricError, Reading, Slopes, Trace};
pub use name::{Measure, Metric, What, metrics};
pub use travel::WithTravel;
