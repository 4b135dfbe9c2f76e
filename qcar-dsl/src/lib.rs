//! The axle compiler: model text in, equations, matrices and Rust out.
//!
//! The modules stand in the order of the data; a file uses only what is declared above it.

pub mod source;
// Mistakes are a catalogue.
pub mod diagnostic;
// Units of every expression.
pub mod units;
// Hash tables for small keys.
pub mod hash;
// Expressions: one hash-consed graph for a model.
pub mod expr;
// Text to tree.
pub mod syntax;
// Comes after the tree that it builds.
pub mod parse;
// The tree as canonical text.
pub mod print;
// Tree to graph: options taken, elements expanded, names resolved, units checked.
pub mod model;
pub mod resolve;
// One member of a family as a file of its own.
pub mod canonical;
// The structure: what is held, what is solvable, what can be seen.
pub mod check;
// The front end in one function.
pub mod front;
// Models with effects in them.
pub mod patch;
// All that follows is total. What is at which place of the vectors.
pub mod about;
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
// Expressions to straight-line programs.
pub mod program;
pub mod schedule;
// Programs interpreted at run time.
pub mod evaluate;
// How an expression is written.
pub mod notation;
// Equations as an engineer writes them.
pub mod equations;
// Two models side by side.
pub mod difference;
// Programs as functions, in no language yet.
pub mod straight;
// Printed as Rust.
pub mod rust;
// Printed as C.
pub mod c;
// The matrices as a function of MATLAB.
pub mod matlab;
// Functions of JavaScript.
pub mod javascript;
// A flat model of Modelica.
pub mod modelica;
// For people: equations, matrices, LaTeX, dot.
pub mod show;
// The whole compiler in one function.
pub mod compile;
// Model files from disk, for the doors.
pub mod disk;
