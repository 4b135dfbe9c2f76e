//! Equations and programs in forms that people and other programs read.

// Notation of expressions.
pub mod notation;
// Equations of motion in an engineer's notation.
pub mod equations;
// The functions of a model, whatever the language.
pub mod straight;
// Rust.
pub mod rust;
// C99.
pub mod c;
// MATLAB.
pub mod matlab;
// JavaScript.
pub mod javascript;
// Modelica.
pub mod modelica;
// Output for people: equations, matrices, LaTeX, dot.
pub mod show;
