//! K&C tests: slow cycles and sines.

// Measured slow cycle.
mod travel;
// Measured sine.
mod sine;
// Model on a K&C rig.
mod bench;
// Its forces, with their derivatives.
mod tangent;
// Prediction of both tests.
mod predicted;

pub use predicted::travel;
