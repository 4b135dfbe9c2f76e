//! How metrics depend on parameters, locally by derivatives and over a range by shares of variance, and how uncertain they are.

// Derivatives at a design.
mod local;
// Shares of the variance over a range.
mod sobol;
// What is not known of parameters, and of metrics for it,
mod interval;
// and what it may turn out as.
mod chance;

pub use chance::Chance;
pub use interval::{Doubt, Interval, Source};
pub use local::{Elasticities, direction, elasticities, size};
pub use sobol::{Index, Indices, Plan, indices};
