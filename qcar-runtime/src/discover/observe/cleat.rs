//! Rides over an obstacle: their impact and after-shake.

// What was measured.
mod measured;
// What a model says.
mod predicted;

pub use predicted::passage;
