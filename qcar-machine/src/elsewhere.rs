//! Replacement for machine code on other processors: there is none.

use qcar_dsl::derive::vectors::Vectors;
use qcar_dsl::evaluate::arguments::{Arguments, Part};
use qcar_dsl::program::Program;
use qcar_model::Lanes;

use crate::shape::{Breadth, Shape};

/// A program as machine code, of which there is none.
#[derive(Debug)]
pub enum Code {}

impl Code {
    /// No machine code: always `None`.
    pub fn new(_vectors: &Vectors, _program: &Program, _shape: Shape, _breadth: Breadth) -> Option<Code> {
        None
    }

    /// Of no code.
    pub fn run(&self, _given: &Arguments, _into: &mut [f64]) {
        match *self {}
    }

    /// Of no code.
    pub fn sets(&self, _given: &[(Part, &[Lanes])], _into: &mut [Lanes]) {
        match *self {}
    }

    /// Of no code.
    pub fn sweep(&self, _given: &Arguments, _points: usize, _into: &mut [&mut [f64]]) -> bool {
        match *self {}
    }
}
