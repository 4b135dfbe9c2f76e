//! The axle compiler: model text in, equations, matrices and Rust out.
//!
//! The modules are stages, in the order of the data; a file uses only modules declared above it. The public items of a
//! stage have a short path beside the one through the stage.

pub mod source;
// The catalogue of mistakes.
pub mod diagnostic;
// Units of every expression.
pub mod units;
// Hash tables for small keys.
pub mod hash;
// Expressions: one hash-consed graph for a model.
pub mod expr;
// Masses, links and channels over that graph.
pub mod model;
// Text to graph.
pub mod front;
// Rules of the structure: support, solvability, passivity.
pub mod check;
// Graph to equations, matrices and responses; identifiability of parameters.
pub mod derive;
// Expressions to straight-line programs, interpreted at run time.
pub mod program;
// Output for other programs and for people.
pub mod back;
// Models with effects added.
pub mod patch;
// The whole compiler in one function.
pub mod compile;
// Model files from disk, for the command line, the macro and build scripts.
pub mod disk;

pub use back::{c, equations, javascript, matlab, modelica, notation, rust, show, straight};
pub use derive::response;
pub use front::{parse, print, resolve, syntax};
pub use patch::difference;
pub use program::{evaluate, schedule};
/// How a compiled model is described.
pub use qcar_model as about;
