//! Machine code for models that are read at run time.
//!
//! [`Machine`] is the interpreter of `qcar-dsl` with its programs as instructions of x86-64. It runs the same
//! operations in the order of the program, as one instruction each, without fusing any, and calls the functions of
//! Rust. So the bits are those of the interpreter, except for the payload of NaN.

// Shapes of a program: for one point, eight sets, or rows of points.
mod shape;
// Positions of the leaves in the arguments.
#[cfg(target_arch = "x86_64")]
mod reads;
// What is left to Rust's functions.
#[cfg(target_arch = "x86_64")]
mod call;
// Instructions as bytes.
#[cfg(target_arch = "x86_64")]
mod assemble;
// Values in registers.
#[cfg(target_arch = "x86_64")]
mod values;
// Operations as instructions.
#[cfg(target_arch = "x86_64")]
mod translate;
// Instructions run.
#[cfg(target_arch = "x86_64")]
mod code;
// On other processors, where there are none.
#[cfg(not(target_arch = "x86_64"))]
mod elsewhere;
// A model whose programs are machine code.
mod machine;

pub use machine::Machine;
