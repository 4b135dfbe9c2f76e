//! Equations and programs as other people and programs read them.

// How an expression is written.
pub mod notation;
// Equations as an engineer writes them.
pub mod equations;
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
