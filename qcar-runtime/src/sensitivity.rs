//! How metrics depend on parameters, locally by derivatives and over a range by shares of variance, and how uncertain they are.

// Derivatives at a design.
mod local;
// Shares of the variance over a range.
mod sobol;
// Intervals of uncertain parameters, and of the metrics that follow.
mod interval;
// Distributions of metrics under uncertain parameters.
mod chance;

pub use chance::Chance;
pub use interval::{Doubt, Interval, Source};
pub use local::{Elasticities, direction, elasticities, size};
pub use sobol::{Index, Indices, Plan, indices};
