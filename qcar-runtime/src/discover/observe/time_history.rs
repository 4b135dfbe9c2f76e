//! Time histories: sample-by-sample responses to any other excitation.

// Sensor noise of a record.
mod noise;
// Initial states and restarts of a record.
mod restarts;
// Measured records.
mod measured;
// Predicted records.
mod predicted;

pub use noise::noise;
pub use predicted::{history, replayed};
