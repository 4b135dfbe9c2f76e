//! Cleat runs: impact and after-shake.

// Measured accelerations.
mod measured;
// Simulated accelerations.
mod predicted;

pub use measured::envelope;
pub use predicted::passage;
