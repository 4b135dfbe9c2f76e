//! A model with its values as files for other tools.

// C99.
pub mod c;
// A Functional Mock-up Unit.
pub mod fmu;
// JavaScript.
pub mod javascript;
// MATLAB.
pub mod matlab;

use qcar_dsl::schedule::Compiled;

/// A model and the initial values of its parameters.
#[derive(Clone, Copy)]
pub struct Subject<'a> {
    /// All results of the compiler.
    pub compiled: &'a Compiled,
    /// A value for each parameter, SI.
    pub values: &'a [f64],
}

/// A file to be written.
pub struct File {
    /// Name without folder.
    pub name: String,
    /// Content.
    pub content: Vec<u8>,
}
