//! Rides over an obstacle: their impact and after-shake.

// The measured series.
mod measured;
// The predicted series.
mod predicted;

pub use predicted::passage;
