//! Graph to equations, matrices and responses. All of it is total: a checked model has them.

// What is at which place of the vectors.
pub mod vectors;
// Sparse symmetric systems solved symbolically.
pub mod elimination;
// Sums with common factors taken out.
pub mod combination;
// The force of a link in its own terms.
pub mod law;
// Graph to equations.
pub mod motion;
// Equations to matrices and their parameter Jacobians.
pub mod linear;
// Complex expressions.
pub mod complex;
// What a link is at one frequency.
pub mod stiffness;
// Frequency response by sparse elimination.
pub mod response;
// Names for what stands at each place.
pub mod describe;
// What outputs can see.
pub mod visible;
// A part of a model on its own.
pub mod alone;
