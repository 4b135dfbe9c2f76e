//! Any other excitation: the responses themselves.

// What a sensor shows beside the motion.
mod noise;
// From where a model sets out, and how well that is known.
mod restarts;
// What was measured.
mod measured;
// What a model says.
mod predicted;

pub use predicted::{history, replayed};
