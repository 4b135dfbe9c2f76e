//! Finds the dynamic stiffness whose addition at one place would explain the residuals of all channels at once.
//!
//! A dynamic stiffness κ(ω) added across a link with stretch s and force pair F changes every response by `H' - H = -κ
//! / (1 + κ H(s,F)) · H(y,F) H(s,u)`. All channels share the first factor, a scalar. Up to the unit, the rest is the
//! derivative of the response by a parameter of that link, which every model provides. Each parameter of a model
//! therefore represents a place. Linear least squares give the best scalar of each line, without a refit. The same
//! formula gives `H(s,F)` from one finite change of the parameter.

// Missing dynamic stiffness, run by run.
mod missing_stiffness;
// Local straight line through complex values.
mod straight;
// Lines of different runs at the same frequency.
mod same_line;
// Best change of all responses at one place, line by line.
mod lines;
// Missing dynamic stiffness at all places of a model.
mod map;
// Places that explain the residual of the sweeps.
mod sweeps;
// Kind of law of a dynamic stiffness.
mod shape;

pub use map::stiffness_map;
pub use missing_stiffness::{MissingStiffness, Place, RunStiffness};
pub use shape::{Shape, shape};
pub use sweeps::Sweeps;
