//! The workbench: from a measurement campaign to a finding.
//!
//! The modules stand in the order of the data, here and in every list below; a file uses only what is declared above it.

pub use nalgebra;
/// What a compiled axle model offers: one trait, and its description.
pub use qcar_model as model;

// What records have for a size.
pub mod mean;
// Dense matrices of a model at rest.
pub mod matrices;
// Loops for every instruction set.
mod vectors;
// What generated models stand on.
pub mod generated;
// What every part reports through.
pub mod error;
// What a misspelt name was meant to be.
pub mod spelling;
// Random numbers, the same everywhere.
pub mod random;
// Files that are read no further than a limit.
pub mod bounded;
// How far long work is.
pub mod progress;
// The measurement as it lies on disk.
pub mod campaign;
// Which part of a model is the wheel, its road and its body.
pub mod roles;
// From time histories to transmissibilities.
pub mod spectrum;
// Sweeps to transmissibilities, with their uncertainty.
pub mod transmissibility;
// The model seen as the measurement sees it.
pub mod response;
// What it does when nothing drives it.
pub mod modes;
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
// The whole model over a cleat, and replays of the rig.
pub mod simulate;
// Peak and after-shake errors, comfort metrics.
pub mod compare;
// Thousands of parameter sets, each driven over rides and measured.
pub mod ensemble;
// Numbers that say how an axle feels, and their derivatives.
pub mod metric;
// What they depend on.
pub mod sensitivity;
// What an axle must be for them to be as they are wanted.
pub mod target;
// Gradients of K&C curves.
pub mod kc;
// Where the measurement disagrees with the model, and what would explain it.
pub mod discover;
