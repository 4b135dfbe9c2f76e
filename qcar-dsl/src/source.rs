//! Source texts, and positions in them.

/// A position in a source, as plain data, so that models and reports can be sent to other threads.
///
/// For a text it is a range of bytes. For the tokens of an inline macro, which has no text, `start` is the position of
/// the token in the parser's list of compiler spans.
///
/// All positions compare equal, so that two syntax trees are equal if their content is.
#[derive(Clone, Copy, Debug, Default)]
pub struct Span {
    /// Which source: an index into the list of sources of one compilation; the model file itself is the first.
    pub source: u16,
    /// The first byte.
    pub start: u32,
    /// One past the last byte.
    pub end: u32,
}

impl PartialEq for Span {
    fn eq(&self, _: &Span) -> bool {
        true
    }
}

impl Span {
    /// The smallest position that covers both; for positions in different sources, the first.
    pub fn join(self, other: Span) -> Span {
        if self.source != other.source {
            return self;
        }
        Span {
            source: self.source,
            start: self.start.min(other.start),
            end: self.end.max(other.end),
        }
    }
}

/// A text with a name, usually a path as the user wrote it.
#[derive(Clone, Debug)]
pub struct Source {
    /// The name in messages.
    pub name: String,
    /// Empty for the tokens of an inline macro.
    pub text: String,
}

impl Source {
    /// The same source without a byte order mark.
    pub fn without_mark(mut self) -> Source {
        if let Some(text) = self.text.strip_prefix('\u{feff}') {
            self.text = text.to_string();
        }
        self
    }

    /// Line and column of a byte, both counted from 1, columns in characters.
    pub fn line_column(&self, byte: u32) -> (usize, usize) {
        let before = &self.text[..self.border(byte as usize)];
        let line_start = before.rfind('\n').map_or(0, |newline| newline + 1);
        (
            before.matches('\n').count() + 1,
            before[line_start..].chars().count() + 1,
        )
    }

    /// The text of the line that holds a byte.
    pub fn line(&self, byte: u32) -> &str {
        let byte = self.border(byte as usize);
        let start = self.text[..byte].rfind('\n').map_or(0, |newline| newline + 1);
        let end = self.text[byte..]
            .find('\n')
            .map_or(self.text.len(), |newline| byte + newline);
        self.text[start..end].trim_end_matches('\r')
    }

    /// The nearest character boundary at or before a byte.
    fn border(&self, byte: usize) -> usize {
        (0..=byte.min(self.text.len()))
            .rev()
            .find(|&b| self.text.is_char_boundary(b))
            .unwrap_or(0)
    }
}

/// Loads a file that a model names: `(name of the source that names it, path as written there)` to its text, or the
/// reason why it cannot be read. The compiler itself reads no files.
pub type Load<'a> = &'a dyn Fn(&str, &str) -> Result<Source, String>;
