//! Parameters and sensor errors that explain the evidence best: maximum a posteriori by least squares.
//!
//! The residuals are those of all fitted runs over their noise, and the coefficients of the sensors' errors over their
//! prior. Held-out runs are never seen.
//!
//! A rig shakes both sides of a car and its sensors are averaged over them, while a cleat run records one side. The two
//! corners of an axle differ by a percent or two, which shifts the modes of the after-shake by more than its noise: so
//! each free parameter has a factor of its own on the recorded side, held by a prior. A ratio is of the design, and both
//! sides share it: were one that stands at 1 for no effect free to differ, an effect could act on one side alone.

// What is known before any measurement.
mod prior;
// Residuals in units of their uncertainty.
mod residual;
// What a fit gives.
mod refit;
// The least-squares problem.
mod problem;
// What its maximum says: covariance and evidence.
mod laplace;
// The way to the maximum.
mod search;
// The residuals there, and how they change.
mod linearised;
// No offset twice.
mod offset;
// All of that in one call.
mod fit;
// How far its parameters may be off.
mod profile;
// What further measurements would say of them.
mod prospect;
// With what sweeps show beyond their steady harmonics.
mod settle;
// Where records begin that only judge.
mod beginning;
// What is left, in units of uncertainty: how much, and where.
mod gap;
// How well a model explains the evidence.
mod explain;

pub use beginning::beginnings;
pub use explain::{Explanation, Given, Setting};
pub use fit::{Start, fit, refit, refit_with};
pub use gap::{Gap, Tile, rms};
pub use prospect::prospects;
pub use refit::Refit;
pub use settle::settle;
