//! Searches for the effects that a model lacks: compares sets of effects by their evidence for the measured data.
//!
//! The modules stand in the order of the data. `observe` turns a campaign into a data set and predicts it. `noise`
//! describes sensor errors within their calibration and the discrepancy of the model. `posterior` fits parameters
//! together with these nuisance parameters. `locate` shows where something is missing. `select` compares sets of
//! effects by their evidence. No code in these modules depends on the name of an effect or of an axle.

// Assumptions of a search that the data do not determine.
pub mod numbers;
// Measured data and their predictions.
pub mod observe;
// Sensor errors and the model discrepancy.
pub mod noise;
// Parameter posterior, model evidence and residuals.
pub mod posterior;
// Place and dynamic stiffness of a missing element.
pub mod locate;
// Effects that might be missing.
pub mod candidate;
// Results of a search.
pub mod answer;
// The search itself.
pub mod select;

pub use locate::{MissingStiffness, Place, Sweeps, stiffness_map};
pub use observe::{Evidence, Free};
pub use posterior::{Misfit, Refit, refit};
