//! The K&C rig: slow cycles and sines.

// The measured series of a slow cycle.
mod travel;
// The measured series of a sine.
mod sine;
// A model on the K&C rig: prescribed motion and resulting force.
mod bench;
// The predicted series of both.
mod predicted;

pub use predicted::travel;
