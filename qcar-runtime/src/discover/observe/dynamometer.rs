//! A dynamometer: one link alone, without the masses and links around it.

// Forces as they were measured.
mod measured;
// What a model says of them.
mod predicted;

pub use predicted::forces;
