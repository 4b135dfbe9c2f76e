//! Ensembles: metrics of a model at many parameter sets, all over the same rides.
//!
//! A [`Design`] determines each set from its number alone, and a row of results depends on nothing else. So any part of
//! an ensemble can be computed anywhere, by any number of threads, with the same bits.

// A random order of the strata.
mod permutation;
// Sobol points, which fill a cube evenly.
mod sobol;
// Parameter sets drawn from the posterior of a fit.
mod posterior;
// The parameter sets of an ensemble.
mod design;
// The metrics of one parameter set.
mod metrics;
// The table of the ensemble.
mod rows;

pub use design::{Axis, Design, Scheme};
pub use metrics::{Column, Metric, Metrics, MetricsError, Ratio};
pub use posterior::{Estimate, Posterior, PosteriorError};
pub use rows::{Ensemble, Rows, Track};
pub use sobol::{DIMENSIONS, POINTS};
