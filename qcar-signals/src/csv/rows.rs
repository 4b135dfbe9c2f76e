//! Rows of a text table: cells between separators, in quotation marks or not.
//!
//! Source: RFC 4180, with any separator.

use std::borrow::Cow;

use memchr::{memchr, memchr2, memchr3};

use crate::error::{Fault, Place, Read, counted};

/// Most cells of a row: four times as many as a sheet of Excel has. A row of separators alone would take many times its
/// length in memory.
const MOST_CELLS: usize = 1 << 16;

/// The cells of a row without spaces around them, and its line.
#[derive(Clone, Default)]
pub(super) struct Row<'a> {
    pub(super) line: u64,
    pub(super) cells: Vec<Cow<'a, str>>,
}

impl Row<'_> {
    pub(super) fn is_empty(&self) -> bool {
        self.cells.iter().all(|cell| cell.is_empty())
    }

    /// Refuses a row that has not the columns of its table, as the line `widest` has; cells after them may be empty.
    pub(super) fn check_width(&self, width: usize, widest: u64) -> Read<()> {
        let after = self.cells.get(width..);
        if after.is_some_and(|after| after.iter().all(|cell| cell.is_empty())) {
            return Ok(());
        }
        let found = counted(self.cells.len(), "column");
        let remedy = "complete the row, or delete what is no part of the table";
        let expected = format!("{width} columns as in line {widest}");
        Err(Fault::new(Place::Line(self.line), found, expected, remedy))
    }
}

/// The rows from a byte of a text on. Empty lines are no rows; if spaces separate cells, several count as one.
pub(super) struct Rows<'a> {
    text: &'a str,
    at: usize,
    line: u64,
    delimiter: u8,
}

impl<'a> Rows<'a> {
    pub(super) fn new(text: &'a str, delimiter: u8) -> Self {
        Rows {
            text,
            at: 0,
            line: 1,
            delimiter,
        }
    }

    pub(super) fn delimiter(&self) -> u8 {
        self.delimiter
    }

    pub(super) fn bytes_left(&self) -> usize {
        self.text.len() - self.at
    }

    /// Number and text of the next line that is not empty, without its end; it is not passed over. `None` at the end of
    /// the text.
    pub(super) fn line(&mut self) -> Option<(u64, &'a [u8])> {
        while self.end_of_line() {}
        let rest = &self.text.as_bytes()[self.at..];
        let length = memchr2(b'\n', b'\r', rest).unwrap_or(rest.len());
        (!rest.is_empty()).then_some((self.line, &rest[..length]))
    }

    /// Passes over the next `length` bytes, which end a line.
    pub(super) fn skip(&mut self, length: usize) {
        self.at += length;
        self.end_of_line();
    }

    /// Replaces `row` by the next one; false at the end of the text.
    pub(super) fn read(&mut self, row: &mut Row<'a>) -> Read<bool> {
        while self.end_of_line() {}
        if self.at == self.text.len() {
            return Ok(false);
        }
        row.line = self.line;
        row.cells.clear();
        loop {
            let cell = self.cell()?;
            if self.delimiter != b' ' || !cell.is_empty() {
                row.cells.push(cell);
            }
            if row.cells.len() > MOST_CELLS {
                let found = format!("more than {MOST_CELLS} cells in a row");
                let remedy = "export the table with one row a sample";
                return Err(Fault::new(
                    Place::Line(row.line),
                    found,
                    "a column for each channel",
                    remedy,
                ));
            }
            if self.byte() != Some(self.delimiter) {
                self.end_of_line();
                return Ok(true);
            }
            self.at += 1;
        }
    }

    fn byte(&self) -> Option<u8> {
        self.text.as_bytes().get(self.at).copied()
    }

    /// Skips the end of a line, if it is next.
    fn end_of_line(&mut self) -> bool {
        let length = match &self.text.as_bytes()[self.at..] {
            [b'\r', b'\n', ..] => 2,
            [b'\r' | b'\n', ..] => 1,
            _ => return false,
        };
        self.at += length;
        self.line += 1;
        true
    }

    /// The cell up to the next separator or end of a line, which is not skipped.
    fn cell(&mut self) -> Read<Cow<'a, str>> {
        let spaces = self.text.as_bytes()[self.at..].iter().take_while(|byte| **byte == b' ');
        let begin = self.at + spaces.count();
        if self.text.as_bytes().get(begin) == Some(&b'"') {
            self.at = begin + 1;
            let mut cell = self.quoted()?;
            let rest = self.plain();
            if !rest.is_empty() {
                cell.to_mut().push_str(rest);
            }
            return Ok(cell);
        }
        Ok(Cow::Borrowed(self.plain()))
    }

    fn plain(&mut self) -> &'a str {
        let rest = &self.text[self.at..];
        let length = memchr3(self.delimiter, b'\n', b'\r', rest.as_bytes()).unwrap_or(rest.len());
        self.at += length;
        rest[..length].trim()
    }

    /// The content up to the closing quotation mark; two marks stand for one.
    fn quoted(&mut self) -> Read<Cow<'a, str>> {
        let opened = self.line;
        let mut cell = Cow::Borrowed("");
        loop {
            let rest = &self.text[self.at..];
            let Some(length) = memchr(b'"', rest.as_bytes()) else {
                let remedy = "close it, or remove it";
                let found = "a quotation mark that is never closed";
                return Err(Fault::new(
                    Place::Line(opened),
                    found,
                    "a second quotation mark",
                    remedy,
                ));
            };
            let piece = &rest[..length];
            self.line += piece.bytes().filter(|byte| *byte == b'\n').count() as u64;
            self.at += length + 1;
            cell += piece;
            if self.byte() != Some(b'"') {
                return Ok(match cell {
                    Cow::Borrowed(cell) => Cow::Borrowed(cell.trim()),
                    Cow::Owned(cell) => Cow::Owned(cell.trim().into()),
                });
            }
            cell += "\"";
            self.at += 1;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{Row, Rows};

    /// The line of a row and its cells.
    type Expected = (u64, &'static [&'static str]);

    fn all(text: &str, delimiter: u8) -> Vec<(u64, Vec<String>)> {
        let (mut rows, mut row, mut all) = (Rows::new(text, delimiter), Row::default(), Vec::new());
        while rows.read(&mut row).unwrap() {
            all.push((row.line, row.cells.iter().map(ToString::to_string).collect()));
        }
        all
    }

    #[test]
    fn cells_are_separated_and_lines_counted() {
        let cases: [(&str, u8, &[Expected]); 8] = [
            ("a;b\r\n\r\n1; 2 \r\n", b';', &[(1, &["a", "b"]), (3, &["1", "2"])]),
            ("a,,c\n1,,\n", b',', &[(1, &["a", "", "c"]), (2, &["1", "", ""])]),
            ("1\r2\r", b',', &[(1, &["1"]), (2, &["2"])]),
            ("  1   2 \n3 4", b' ', &[(1, &["1", "2"]), (2, &["3", "4"])]),
            (
                "\"a,b\", \"c\"\"d\"\n1,2",
                b',',
                &[(1, &["a,b", "c\"d"]), (2, &["1", "2"])],
            ),
            (
                "\"two\nlines\",x\n1,2",
                b',',
                &[(1, &["two\nlines", "x"]), (3, &["1", "2"])],
            ),
            ("5\" pipe,\"in\"ch\n", b',', &[(1, &["5\" pipe", "inch"])]),
            ("", b',', &[]),
        ];
        for (text, delimiter, expected) in cases {
            let expected: Vec<(u64, Vec<String>)> = expected
                .iter()
                .map(|(line, cells)| (*line, cells.iter().map(ToString::to_string).collect()))
                .collect();
            assert_eq!(all(text, delimiter), expected, "{text:?}");
        }
    }

    #[test]
    fn a_row_without_end_is_refused() {
        let text = "1,".repeat(super::MOST_CELLS + 1);
        let fault = Rows::new(&text, b',')
            .read(&mut Row::default())
            .unwrap_err()
            .to_string();
        assert!(fault.contains("more than 65536 cells"), "{fault}");
    }

    #[test]
    fn a_quotation_mark_that_is_never_closed_is_refused() {
        let fault = Rows::new("\n\"a,b\n1,2\n", b',')
            .read(&mut Row::default())
            .unwrap_err()
            .to_string();
        assert!(fault.contains("line 2"), "{fault}");
    }
}
