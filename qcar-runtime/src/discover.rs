//! Where simulation and measurement disagree, and by how much more than they may.
//!
//! The modules stand in the order of the data: what a campaign holds becomes evidence, a model predicts it, sensors may
//! be wrong to the extent of their calibration, a refit takes out what parameters can explain, and what is left is the
//! gap. Nothing here knows an effect, or an axle, by name.

// The numbers of the search that no data give.
pub mod numbers;
// What was measured, beside what a model says of it.
pub mod observe;
// What differs between a measurement and a model that is right.
pub mod noise;
// Parameters given the evidence, and what they leave.
pub mod posterior;
// What would have to be added, and at which place.
pub mod kappa;

// What might be missing.
pub mod candidate;
// What a search answers.
pub mod answer;
// Which effect is missing.
pub mod select;

pub use kappa::{Kappa, Place, Sweeps, kappa_map};
pub use observe::{Evidence, Free};
pub use posterior::{Gap, Refit, refit};
