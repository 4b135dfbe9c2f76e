//! Finds the dynamic stiffness that, added at one place, explains all channels at once by a rank-one update.
//!
//! A dynamic stiffness κ(ω) added across a link with stretch s and force pair F changes every response by `H' - H = -κ
//! / (1 + κ H(s,F)) · H(y,F) H(s,u)`. All channels share the first factor, a scalar. Up to the unit, the rest is the
//! derivative of the response by a parameter of that link, which every model provides. So the parameters of a model are
//! its places. The best scalar of a line follows by linear least squares, without a refit. `H(s,F)` follows from one
//! finite change of the parameter by the same formula.

// Missing dynamic stiffness, run by run.
mod kappa;
// Local straight line through complex values.
mod straight;
// Best change of all responses at one place, line by line.
mod lines;
// Dynamic stiffness at all places of a model.
mod map;
// Places that explain the residual of the sweeps.
mod sweeps;
// Kind of law of a dynamic stiffness.
mod shape;

pub use kappa::{Kappa, KappaRun, Place};
pub use map::kappa_map;
pub use shape::{Shape, shape};
pub use sweeps::Sweeps;
