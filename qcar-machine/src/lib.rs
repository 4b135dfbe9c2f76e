//! Machine code for models that are read at run time.
//!
//! [`Machine`] is the interpreter of `qcar-dsl` with its programs as instructions of x86-64. The operations are the same, in the order of
//! the program, one instruction each and none fused, and functions are those of Rust: the bits are those of the interpreter, but that no
//! two ways of computing need agree on which not-a-number is none.

// Shapes of a program: for one point, eight sets, or rows of points.
mod shape;
// Where leaves are read.
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
