//! Maximum a posteriori fit of model parameters and sensor errors by least squares.
//!
//! The residuals are those of all fitted runs over their noise, and the distances of nuisance coefficients and
//! parameters from the centres of their priors over the prior standard deviations. Held-out runs are never used.
//!
//! A rig shakes both sides of a car and its sensors are averaged over them, while a cleat run records one side. The two
//! corners of an axle differ by one or two percent, which shifts the modes of the after-shake by more than its noise.
//! So each free parameter with a unit has a factor of its own on the recorded side, limited by a prior. A ratio belongs
//! to the design, and both sides share it. Otherwise an effect whose ratio is 1 on one side could act on the other side
//! alone.

// Priors of parameters and sides.
mod prior;
// Normalised real residuals.
mod residual;
// Result of a fit.
mod refit;
// Least-squares problem.
mod problem;
// Laplace approximation: covariance and evidence.
mod laplace;
// Accuracy class of the calibration curves.
mod accuracy;
// Search for the maximum.
mod search;
// Residuals and Jacobian at a fit.
mod linearised;
// Offsets that are confounded with a parameter.
mod offset;
// Initial states of records, estimated with all parameters fixed.
mod initial_states;
// A complete fit in one call.
mod fit;
// Profile intervals of parameters.
mod profile;
// Optimal design of further measurements.
mod design;
// Non-steady part of sweep responses.
mod unsteady;
// Residuals over all runs, and where they are large.
mod misfit;
// The residual of each sensor as a share of its signal.
mod sensor_share;
// Sensors whose sign is probably wrong.
mod reversed;
// Explanation of the evidence by a model.
mod explain;

pub use design::expected_gains;
pub use explain::{Explanation, Given, Setting};
pub use fit::{Start, fit, refit, refit_with};
pub use initial_states::estimate_initial_states;
pub use misfit::{Misfit, Tile};
pub use refit::Refit;
pub use reversed::ReversedSensor;
pub use search::DECREMENT;
pub use sensor_share::SensorShare;
pub use unsteady::add_unsteady;
