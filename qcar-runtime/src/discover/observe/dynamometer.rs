//! Dynamometer tests of a single link, without the masses and links around it.

// Measured forces.
mod measured;
// Predicted forces.
mod predicted;

pub use predicted::forces;
