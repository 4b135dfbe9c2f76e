//! Sensitivity of metrics to parameters (local derivatives, and shares of the variance over a range), and their
//! uncertainty.

// Derivatives at a design.
mod local;
// Shares of the variance over a range.
mod sobol;
// Intervals of metrics that follow from uncertain parameters.
mod interval;
// Distributions of metrics under uncertain parameters.
mod chance;

pub use chance::Chance;
pub use interval::{Interval, ParameterUncertainty, Source};
pub use local::{Elasticities, direction, elasticities, size};
pub use sobol::{Index, Indices, Plan, indices};
