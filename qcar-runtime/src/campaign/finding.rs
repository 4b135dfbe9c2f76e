//! A reported flaw of measured samples.

use std::fmt;

/// A flaw of a channel of a run.
#[derive(Clone, Debug, PartialEq)]
pub struct Finding {
    /// The run's name.
    pub run: String,
    /// The sensor's name.
    pub channel: String,
    /// Times of the first and last sample concerned, s, on the clock of the file.
    pub span: (f64, f64),
    /// Description, with values in SI.
    pub what: String,
    /// True if a fitted sweep needs the channel and it is dead.
    pub fatal: bool,
}

impl fmt::Display for Finding {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (first, last) = self.span;
        write!(out, "{}, `{}`, {first:.3} s", self.run, self.channel)?;
        if last > first {
            write!(out, " to {last:.3} s")?;
        }
        write!(out, ": {}", self.what)
    }
}
