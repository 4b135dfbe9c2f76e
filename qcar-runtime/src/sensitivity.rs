//! What metrics depend on: locally by derivatives, all over a range by shares of variance, and how sure they are.

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
