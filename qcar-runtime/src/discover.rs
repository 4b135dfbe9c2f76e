//! Which effect a model lacks: sets of effects compared by their evidence, given what was measured.
//!
//! The modules stand in the order of the data. What a campaign holds becomes a data set beside its predictions; sensors are
//! wrong to the extent of their calibration, and any model misses something; a fit finds what parameters and these can
//! explain together; the residuals say where something is missing; and sets of effects compete by their evidence.
//! Nothing here knows an effect, or an axle, by name.

// The numbers of the search that no data give.
pub mod numbers;
// What was measured, beside what a model says of it.
pub mod observe;
// What differs between a measurement and a right model: errors of sensors, and the discrepancy.
pub mod noise;
// Parameters given the data, the evidence of a model, and what is left.
pub mod posterior;
// What would have to be added, and at which place.
pub mod locate;
// What might be missing.
pub mod candidate;
// What a search answers.
pub mod answer;
// Which effect is missing.
pub mod select;

pub use locate::{Kappa, Place, Sweeps, kappa_map};
pub use observe::{Evidence, Free};
pub use posterior::{Gap, Refit, refit};
