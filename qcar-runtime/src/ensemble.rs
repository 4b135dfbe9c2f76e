//! Ensembles: a model at many parameter sets, each of them driven over the same rides and measured.
//!
//! A [`Design`] says which sets. It knows each of them by its number alone, and a row of results depends on nothing else: so
//! any part of an ensemble can be computed anywhere, by any number of threads, with the same bits.

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
