//! From the graph to equations, matrices and responses. No step can fail for a checked model.

// The order of states, inputs and outputs.
pub mod vectors;
// Symbolic elimination of sparse symmetric systems.
pub mod elimination;
// Sums with common factors taken out.
pub mod combination;
// The force of a link as an expression of stretch and rate.
pub mod law;
// From the model graph to equations of motion.
pub mod motion;
// From equations to matrices and their parameter Jacobians.
pub mod linear;
// Complex expressions.
pub mod complex;
// The dynamic stiffness of a link.
pub mod stiffness;
// Frequency response by sparse elimination.
pub mod response;
// Names of entries, for people.
pub mod describe;
// Identifiability: parameters that the outputs cannot determine.
pub mod identifiability;
// A single link as a model of its own.
pub mod alone;
