//! Errors of unusable input.

use std::fmt;
use std::path::PathBuf;

use thiserror::Error;

/// The input cannot be used: every problem that was found, in the order of the files.
///
/// The command line prints it and exits with status 2.
#[derive(Clone, Debug, Error, PartialEq)]
#[error("{}", paragraphs(.problems))]
pub struct InputError {
    /// At least one.
    pub problems: Vec<Problem>,
}

/// A problem of the input, its place, and a remedy.
///
/// The texts are fragments of one sentence: `found "mm/s", expected "m/s"; convert the column and declare m/s`. Of a
/// [refusal](Problem::refused), `found` is the whole sentence.
#[derive(Clone, Debug, Error, PartialEq)]
pub struct Problem {
    /// The file as it was opened.
    pub file: PathBuf,
    /// Place in the file.
    pub place: Place,
    /// What was found.
    pub found: String,
    /// What was expected.
    pub expected: String,
    /// Remedy.
    pub remedy: String,
}

impl fmt::Display for Problem {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Problem {
            place,
            found,
            expected,
            remedy,
            ..
        } = self;
        let file = self.file.display();
        match expected.is_empty() {
            true => write!(out, "{file}{place}: {found}"),
            false => write!(out, "{file}{place}: found {found}, expected {expected}; {remedy}"),
        }
    }
}

/// A place in a file. Lines and columns count from 1.
#[derive(Clone, Debug, PartialEq)]
pub enum Place {
    /// The file as a whole.
    File,
    /// A line of a table.
    Line(u64),
    /// A cell of a table: its line and the name of its column.
    Cell(u64, String),
    /// A whole column of a table, or a named item that has no line of its own.
    Name(String),
    /// A channel of a measured file, and the time (s).
    Channel(String, Option<f64>),
    /// A place in a measured file, in the words of its reader.
    Words(String),
    /// A key of a TOML file: line, column in characters, and path such as `run[2].kind` (empty for broken syntax).
    Key(usize, usize, String),
}

impl fmt::Display for Place {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Place::File => Ok(()),
            Place::Line(line) => write!(out, ", line {line}"),
            Place::Cell(line, column) => write!(out, ", line {line}, column `{column}`"),
            Place::Name(name) => write!(out, ", `{name}`"),
            Place::Channel(name, None) => write!(out, ", channel `{name}`"),
            Place::Channel(name, Some(time)) => write!(out, ", channel `{name}` at {time:.4} s"),
            Place::Words(words) => write!(out, ", {words}"),
            Place::Key(line, column, key) if key.is_empty() => write!(out, ", line {line}, column {column}"),
            Place::Key(line, column, key) => write!(out, ", line {line}, column {column}, `{key}`"),
        }
    }
}

impl Place {
    /// A key of a TOML file, by its offset in bytes.
    pub fn in_text(text: &str, offset: usize, key: impl Into<String>) -> Self {
        let before = &text[..offset.min(text.len())];
        let line = before.matches('\n').count() + 1;
        let column = before.rsplit('\n').next().unwrap_or_default().chars().count() + 1;
        Place::Key(line, column, key.into())
    }
}

impl Problem {
    /// A problem; see the fields of [`Problem`] for how to word it.
    pub fn new(
        file: impl Into<PathBuf>,
        place: Place,
        found: impl Into<String>,
        expected: impl Into<String>,
        remedy: impl Into<String>,
    ) -> Self {
        let (found, expected, remedy) = (found.into(), expected.into(), remedy.into());
        Problem {
            file: file.into(),
            place,
            found,
            expected,
            remedy,
        }
    }
}

impl Problem {
    /// A problem from an error that states what is expected and the remedy.
    pub fn refused(file: impl Into<PathBuf>, place: Place, what: &str, error: impl fmt::Display) -> Self {
        Problem::new(file, place, format!("{what}: {error}"), "", "")
    }
}

impl From<Problem> for InputError {
    fn from(problem: Problem) -> Self {
        InputError {
            problems: vec![problem],
        }
    }
}

impl InputError {
    /// `value` without problems, otherwise an error with all `problems`.
    ///
    /// # Errors
    /// Fails if `problems` is not empty.
    pub fn unless_empty<T>(problems: Vec<Problem>, value: Option<T>) -> Result<T, InputError> {
        match value {
            Some(value) if problems.is_empty() => Ok(value),
            _ => Err(InputError { problems }),
        }
    }
}

fn paragraphs(problems: &[Problem]) -> String {
    problems.iter().map(Problem::to_string).collect::<Vec<_>>().join("\n")
}
