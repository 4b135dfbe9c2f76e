//! Machine code, judged by the interpreter bit by bit.

mod comparison;
mod models;
mod programs;
#[path = "../../qcar-dsl/tests/common/programs.rs"]
mod random;
