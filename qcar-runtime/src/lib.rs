//! The workbench: reads a measurement campaign, fits and simulates models, and finds missing effects.
//!
//! The modules stand in the order of the data, here and in every list below; a file uses only what is declared above
//! it.

pub use nalgebra;
/// What a compiled axle model offers: one trait, and its description.
pub use qcar_model as model;

// Means and RMS values.
pub mod mean;
// The factor between two measurements of one quantity.
mod proportion;
// Matrices of a model at rest.
pub mod matrices;
// Sparse matrices as narrow bands.
mod banded;
// Loops compiled for each instruction set.
mod vectors;
// Support for generated models.
pub mod generated;
// Quantities in messages.
pub mod shown;
// Errors of every part.
pub mod error;
// Suggestions for misspelt names.
pub mod spelling;
// Errors of the readers of TOML and JSON.
pub mod syntax;
// Random numbers that are the same on every machine.
pub mod random;
// Reading of files up to a limit of size.
pub mod bounded;
// Progress reports of long work.
pub mod progress;
// The measured campaign on disk.
pub mod campaign;
// Which part of a model is the wheel, its road and its body.
pub mod roles;
// Vehicle data at rest that contradict each other.
pub mod statics;
// Fourier transforms of time histories.
pub mod spectrum;
// Sweeps to transmissibilities, with their uncertainty.
pub mod transmissibility;
// Responses of the model at the measured points.
pub mod response;
// Free vibration of the model.
pub mod modes;
// All free motions, also those that do not oscillate.
pub mod free_motions;
// The peak of a ratio over frequency.
mod resonance;
// Bounded nonlinear least squares.
pub mod least_squares;
// The rig fit of thesis section 3.5.
pub mod fit;
// The road under a rolling tyre.
pub mod road;
// Contact geometry of the tyre.
pub mod tyre;
// Time integration.
pub mod solver;
// Rides over roads, and replays of records.
pub mod simulate;
// Peak and after-shake errors, comfort metrics.
pub mod compare;
// Metrics of thousands of parameter sets over rides.
pub mod ensemble;
// Metrics of comfort, load and travel, with their derivatives.
pub mod metric;
// Sensitivity of metrics to parameters.
pub mod sensitivity;
// Designs whose metrics meet targets.
pub mod target;
// Gradients of K&C curves.
pub mod kc;
// What explains the difference between measurement and model.
pub mod discover;
