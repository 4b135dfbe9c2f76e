//! What metrics depend on: locally by derivatives, all over a range by shares of variance, and how sure they are.

// Derivatives at a design.
mod local;
// Shares of the variance over a range.
mod sobol;
// What is not known of parameters, and of metrics for it.
mod interval;

pub use interval::{Doubt, Interval};
pub use local::{Elasticities, direction, elasticities};
pub use sobol::{Index, Indices, Plan, indices};
