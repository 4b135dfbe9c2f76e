//! Any other excitation: the responses themselves.

// The noise of a sensor.
mod noise;
// Initial states with their uncertainty, and resets of states that drift.
mod restarts;
// The measured series.
mod measured;
// The predicted series.
mod predicted;

pub use predicted::{history, replayed};
