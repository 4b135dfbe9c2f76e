//! Ensembles: a model at many parameter sets, each of them driven over the same rides and measured.
//!
//! A [`Design`] says which sets. It knows each of them by its number alone, and a row of results depends on nothing else: so
//! any part of an ensemble can be computed anywhere, by any number of threads, with the same bits.

// The order of strata.
mod permutation;
// Points that fill a cube evenly.
mod sobol;
// Parameter sets that are as probable as a fit says.
mod posterior;
// Which parameter sets.
mod design;
// What is measured of each.
mod metrics;
// All of it.
mod rows;

pub use design::{Axis, Design, Scheme};
pub use metrics::{Column, Metric, Metrics, MetricsError, Ratio};
pub use posterior::{Estimate, Posterior, PosteriorError};
pub use rows::{Ensemble, Rows, Track};
pub use sobol::{DIMENSIONS, POINTS};
