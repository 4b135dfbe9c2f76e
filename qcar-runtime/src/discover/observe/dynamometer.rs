//! A dynamometer: one link alone, without the masses and links around it.

// The measured forces.
mod measured;
// The predicted forces.
mod predicted;

pub use predicted::forces;
