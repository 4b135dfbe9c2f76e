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

/// A model and the values that its parameters have until somebody changes them.
#[derive(Clone, Copy)]
pub struct Subject<'a> {
    /// All that the compiler derives of it.
    pub compiled: &'a Compiled,
    /// One for each parameter, SI.
    pub values: &'a [f64],
}

/// A file that is to be written.
pub struct File {
    /// Its name, without a folder.
    pub name: String,
    /// All of it.
    pub content: Vec<u8>,
}
