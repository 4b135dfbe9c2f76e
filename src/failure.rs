//! Reasons why a verb stops, and their exit status.

use std::fmt;

use qcar_runtime::error::{InputError, Place, Problem};

/// Reason why a verb stops.
#[derive(Debug)]
pub enum Failure {
    /// The verb has found a fault: the text for standard output. Exit status 1.
    Finding(String),
    /// The input cannot be used: the text for standard error. Exit status 2.
    Input(String),
}

impl Failure {
    /// Exit status for the shell.
    pub fn exit_status(&self) -> u8 {
        match self {
            Failure::Finding(_) => 1,
            Failure::Input(_) => 2,
        }
    }
}

impl fmt::Display for Failure {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (Failure::Finding(text) | Failure::Input(text)) = self;
        out.write_str(text)
    }
}

impl std::error::Error for Failure {}

impl From<InputError> for Failure {
    fn from(error: InputError) -> Self {
        Failure::Input(error.to_string())
    }
}

impl From<Problem> for Failure {
    fn from(problem: Problem) -> Self {
        InputError::from(problem).into()
    }
}

/// A problem with a flag.
pub fn flag(name: &str, found: impl fmt::Display, expected: &str, remedy: &str) -> Problem {
    Problem::new(
        "command line",
        Place::Name(name.into()),
        found.to_string(),
        expected,
        remedy,
    )
}
