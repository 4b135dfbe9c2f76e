//! Machine code for models that are read at run time.
//!
//! [`Machine`] translates the programs of a compiled model to instructions of x86-64. Each operation becomes one
//! instruction in the order of the program, multiplications and additions are not fused, and functions such as `sin`
//! are calls to Rust. So results have the bits of the interpreter of `qcar-dsl`, except for the payload of NaN.

// Shapes of a program: for one point, eight sets, or rows of points.
mod shape;
// Where a program finds its inputs in the arguments.
#[cfg(target_arch = "x86_64")]
mod reads;
// Operations by functions of Rust.
#[cfg(target_arch = "x86_64")]
mod call;
// The encoding of instructions.
#[cfg(target_arch = "x86_64")]
mod assemble;
// Register allocation.
#[cfg(target_arch = "x86_64")]
mod values;
// Translation of operations to instructions.
#[cfg(target_arch = "x86_64")]
mod translate;
// Executable memory, and calls of its code.
#[cfg(target_arch = "x86_64")]
mod code;
// The replacement on other processors: no machine code.
#[cfg(not(target_arch = "x86_64"))]
mod unsupported;
// The trait `Model` by machine code.
mod machine;

pub use machine::Machine;
