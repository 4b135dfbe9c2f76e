//! The K&C rig: slow cycles and sines.

// A slow cycle as it was measured.
mod travel;
// A sine as it was measured.
mod sine;
// What the rig moves in a model, and what follows.
mod bench;
// What a model says of both.
mod predicted;

pub use predicted::travel;
