//! Which dynamic stiffness, added at one place, would explain every channel at once by a rank-one update.
//!
//! A dynamic stiffness κ(ω) added across a link with stretch s and force pair F changes every response by
//! `H' - H = -κ / (1 + κ H(s,F)) · H(y,F) H(s,u)`. All channels share the scalar in front, and what follows it is, up
//! to the unit, the derivative of the response by a parameter of that link, which every model gives. So the parameters
//! of a model are its places, the best scalar of a line is linear least squares, and no refit is needed. `H(s,F)`
//! comes from one finite change of the parameter, by the same formula.

// What would have to be there.
mod kappa;
// A straight line through a few complex values.
mod straight;
// The responses of all sensors line by line, and what explains them.
mod lines;
// All places of a model.
mod map;
// Those that explain the sweeps.
mod sweeps;
// Which kind of law that is.
mod shape;

pub use kappa::{Kappa, KappaRun, Place};
pub use map::kappa_map;
pub use shape::{Shape, shape};
pub use sweeps::Sweeps;
