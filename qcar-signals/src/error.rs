//! Errors of reading a file, with the position in it.

use std::fmt;
use std::path::PathBuf;

use thiserror::Error;

/// A file that cannot be read.
#[derive(Clone, Debug, Error, PartialEq)]
#[error("{file}{separator} {fault}", file = .file.display(), separator = .fault.separator())]
pub struct ReadError {
    /// The path as it was opened.
    pub file: PathBuf,
    /// The fault.
    pub fault: Box<Fault>,
}

/// A fault of a file. The texts are fragments of one sentence, as `Display` joins them.
#[derive(Clone, Debug, PartialEq)]
pub struct Fault {
    /// Position in the file.
    pub place: Place,
    /// The channel, if it is known.
    pub channel: Option<String>,
    /// What was found.
    pub found: String,
    /// What was expected.
    pub expected: String,
    /// Remedy.
    pub remedy: String,
}

/// A position in a file. Lines count from 1, bytes from 0.
#[derive(Clone, Debug, PartialEq)]
pub enum Place {
    /// The file as a whole.
    File,
    /// A byte of the file.
    Byte(u64),
    /// A line of a text file.
    Line(u64),
    /// A cell of a text table: its line and the name or number of its column.
    Cell(u64, String),
    /// A named part: a variable of a MAT file, a dataset of a UFF file or the like.
    Item(String),
    /// A cell or a range of a worksheet: sheet, and cell as Excel writes it.
    Sheet(String, String),
}

/// Result of a reader.
pub(crate) type Read<T> = Result<T, Box<Fault>>;

/// A count with its noun, in the plural unless it is 1.
pub(crate) fn counted(count: usize, what: &str) -> String {
    let ending = if count == 1 { "" } else { "s" };
    format!("{count} {what}{ending}")
}

/// What is left of a file that ends in its next part: `; the 2 segments before it are whole`, or nothing.
pub(crate) fn whole_before(count: usize, part: &str) -> String {
    match count {
        0 => String::new(),
        1 => format!("; the {part} before it is whole"),
        _ => format!("; the {count} {part}s before it are whole"),
    }
}

impl fmt::Display for Place {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Place::File => out.write_str("the whole file"),
            Place::Byte(at) => write!(out, "byte {at}"),
            Place::Line(line) => write!(out, "line {line}"),
            Place::Cell(line, column) => write!(out, "line {line}, column `{column}`"),
            Place::Item(name) => write!(out, "`{name}`"),
            Place::Sheet(sheet, cell) => write!(out, "sheet `{sheet}`, cell {cell}"),
        }
    }
}

impl fmt::Display for Fault {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let place = (self.place != Place::File).then(|| self.place.to_string());
        let channel = self.channel.as_ref().map(|channel| format!("channel `{channel}`"));
        let location: Vec<String> = place.into_iter().chain(channel).collect();
        if !location.is_empty() {
            write!(out, "{}: ", location.join(", "))?;
        }
        write!(out, "found {}, expected {}; {}", self.found, self.expected, self.remedy)
    }
}

impl Fault {
    /// Text between the name of the file and the fault; the fault may begin with a position.
    fn separator(&self) -> char {
        if self.place == Place::File && self.channel.is_none() {
            ':'
        } else {
            ','
        }
    }

    /// A fault without a channel; see the fields for the wording.
    pub(crate) fn new(
        place: Place,
        found: impl Into<String>,
        expected: impl Into<String>,
        remedy: impl Into<String>,
    ) -> Box<Self> {
        Box::new(Fault {
            place,
            channel: None,
            found: found.into(),
            expected: expected.into(),
            remedy: remedy.into(),
        })
    }

    /// The file ends before its declared content.
    pub(crate) fn cut_off(place: Place, found: impl Into<String>, expected: impl Into<String>) -> Box<Self> {
        Fault::new(
            place,
            found,
            expected,
            "the file was cut off: copy it again from where it was recorded",
        )
    }

    /// Parts of the file contradict each other.
    pub(crate) fn damaged(place: Place, found: impl Into<String>, expected: impl Into<String>) -> Box<Self> {
        Fault::new(place, found, expected, "the file is damaged: copy or export it again")
    }

    /// The same fault for this channel, unless it already names one, or the channel has no name.
    pub(crate) fn of(mut self: Box<Self>, channel: &str) -> Box<Self> {
        if !channel.is_empty() {
            self.channel.get_or_insert_with(|| channel.into());
        }
        self
    }
}
