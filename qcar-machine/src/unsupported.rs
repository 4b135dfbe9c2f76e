//! On other processors than x86-64 there is no machine code, and the interpreter runs every program.

use qcar_dsl::derive::vectors::Vectors;
use qcar_dsl::evaluate::arguments::{Arguments, Part};
use qcar_dsl::program::Program;
use qcar_model::Lanes;

use crate::shape::{Shape, VectorWidth};

/// The machine code of a program; it has no values.
#[derive(Debug)]
pub enum Code {}

impl Code {
    /// Always `None`.
    pub fn new(_vectors: &Vectors, _program: &Program, _shape: Shape, _vector_width: VectorWidth) -> Option<Code> {
        None
    }

    /// Computes the program at one point. Never called, since there is no code.
    pub fn run(&self, _given: &Arguments, _into: &mut [f64]) {
        match *self {}
    }

    /// Computes the program for each of the sets. Never called, since there is no code.
    pub fn sets(&self, _given: &[(Part, &[Lanes])], _into: &mut [Lanes]) {
        match *self {}
    }

    /// Computes the program at many points. Never called, since there is no code.
    pub fn sweep(&self, _given: &Arguments, _points: usize, _into: &mut [&mut [f64]]) -> bool {
        match *self {}
    }
}
