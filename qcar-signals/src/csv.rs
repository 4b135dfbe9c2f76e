//! Text tables: comma, semicolon, tab, bar or spaces between columns, decimal point or comma, with or without a row of
//! units, in UTF-8, UTF-16 or Windows-1252.

mod plain;
mod rows;

use std::borrow::Cow;

use plain::PlainRows;
use rows::{Row, Rows};

use crate::bytes::text;
use crate::clock;
use crate::error::{Fault, Place, Read};
use crate::signal::Recording;
use crate::table::{Cell, Column, Filled, Layout};

/// Number of rows from which the form of a table and the first row of numbers are determined.
const HEAD: usize = 200;

/// Reads a table of numbers with names.
pub(crate) fn read(bytes: &[u8]) -> Read<Recording> {
    let text = decoded(bytes)?;
    let delimiter = delimiter(&text);
    let head = match head(&text, delimiter) {
        Err(_) if is_binary(&text) => return Err(of_no_format(bytes)),
        head => head?,
    };
    let decimals = Decimals::of(&head, delimiter)?;
    let cells: Vec<Vec<Cell>> = head
        .iter()
        .map(|row| row.cells.iter().map(|cell| decimals.cell(cell)).collect())
        .collect();
    let Some(layout) = Layout::find(&cells) else {
        if is_binary(&text) {
            return Err(of_no_format(bytes));
        }
        let found = match head.len() {
            1 => "one line without numbers".into(),
            lines => format!("no row of numbers among the first {lines} lines"),
        };
        let remedy = "export the table with one row a sample; separators may be , ; tab | or spaces";
        return Err(Fault::new(Place::File, found, "names and columns of numbers", remedy));
    };
    let names_line = head[..layout.first].last().map_or(1, |row| row.line);
    let (filled, lines) = fill(Rows::new(&text, delimiter), decimals, layout, &head)?;
    let mut recording = Recording::new("text table");
    let place = |column: &Column, row: Option<usize>| {
        let line = row.and_then(|row| lines.get(row)).copied().unwrap_or(names_line);
        Place::Cell(line, column.name.clone())
    };
    filled.add_to(&mut recording, "", &place)?;
    Ok(recording)
}

/// True if the text has characters that do not occur in tables. (`1a` marked the end of texts in DOS.)
fn is_binary(text: &str) -> bool {
    text.contains(|letter: char| letter.is_control() && !letter.is_whitespace() && letter != '\u{1a}')
}

/// The fault of binary data of an unknown format, with their beginning.
fn of_no_format(bytes: &[u8]) -> Box<Fault> {
    let beginning = bytes[..bytes.len().min(8)].escape_ascii();
    Fault::new(
        Place::Byte(0),
        format!("binary data that begin with `{beginning}`"),
        "the beginning of MDF (`MDF`), RPC III (`FORMAT`), TDMS (`TDSm`), MAT (`MATLAB`), UFF (`-1`) or .xlsx (`PK`), or a text",
        "export the recording in one of these formats; if it is in one, its beginning is damaged: copy it again",
    )
}

/// The text, without its byte order mark.
fn decoded(bytes: &[u8]) -> Read<Cow<'_, str>> {
    let utf16 = |order: fn([u8; 2]) -> u16| {
        let units = bytes[2..].chunks_exact(2).map(|two| order([two[0], two[1]]));
        let decoded = char::decode_utf16(units).collect::<Result<Cow<'_, str>, _>>();
        decoded.ok().filter(|_| bytes.len().is_multiple_of(2)).ok_or_else(|| {
            let place = Place::Byte(bytes.len() as u64);
            Fault::cut_off(place, "a UTF-16 text with half a character", "whole characters")
        })
    };
    match bytes {
        [0xff, 0xfe, ..] => utf16(u16::from_le_bytes),
        [0xfe, 0xff, ..] => utf16(u16::from_be_bytes),
        [0xef, 0xbb, 0xbf, rest @ ..] => Ok(text(rest)),
        _ => Ok(text(bytes)),
    }
}

/// The separator of columns: the first of these that most lines contain. The comma is last, since numbers may contain
/// it; spaces if there is no other.
fn delimiter(text: &str) -> u8 {
    let lines: Vec<&str> = text.lines().filter(|line| !line.trim().is_empty()).take(HEAD).collect();
    let has_most = |delimiter: &char| 2 * lines.iter().filter(|line| line.contains(*delimiter)).count() > lines.len();
    [';', '\t', '|', ',']
        .into_iter()
        .find(has_most)
        .map_or(b' ', |delimiter| delimiter as u8)
}

fn head(text: &str, delimiter: u8) -> Read<Vec<Row<'_>>> {
    let (mut rows, mut row, mut head) = (Rows::new(text, delimiter), Row::default(), Vec::new());
    while head.len() < HEAD && rows.read(&mut row)? {
        head.push(row.clone());
    }
    Ok(head)
}

/// The columns of numbers, and the line of each row.
fn fill(mut rows: Rows<'_>, decimals: Decimals, layout: Layout, head: &[Row<'_>]) -> Read<(Filled, Vec<u64>)> {
    let Layout { first, columns } = layout;
    let width = columns.last().map_or(0, |column| column.index + 1);
    let (first, body) = (head[first].line, &head[first.saturating_sub(1)..]);
    let widest = body
        .iter()
        .find(|row| row.cells.len() >= width)
        .map_or(first, |row| row.line);
    let mut numbers = vec![Vec::new(); columns.len()];
    let (mut row, mut lines) = (Row::default(), Vec::new());
    let mut plain_rows = PlainRows::new(rows.delimiter(), decimals);
    while let Some((line, text)) = rows.line() {
        if line >= first
            && let Some(plain) = plain_rows.read(text, width)
        {
            if lines.is_empty() {
                // As if all rows were so long, but in no more memory than the text has.
                let count = rows.bytes_left() / text.len().max(size_of::<f64>() * columns.len());
                numbers.iter_mut().for_each(|numbers| numbers.reserve_exact(count));
            }
            for (column, numbers) in columns.iter().zip(&mut numbers) {
                numbers.push(plain[column.index]);
            }
            lines.push(line);
            rows.skip(text.len());
        } else if rows.read(&mut row)? && row.line >= first && !row.is_empty() {
            row.check_width(width, widest)?;
            for (column, numbers) in columns.iter().zip(&mut numbers) {
                numbers.push(decimals.number_of(&row, column)?);
            }
            lines.push(row.line);
        }
    }
    numbers.iter_mut().for_each(Vec::shrink_to_fit);
    Ok((Filled { columns, numbers }, lines))
}

/// Notation of numbers.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Decimals {
    /// 1234.5 or 1,234.5
    Point,
    /// 1234,5 or 1.234,5
    Comma,
}

impl Decimals {
    /// The notation of the numbers in the upper rows. If both are possible, a single comma or point is the decimal
    /// separator.
    fn of(head: &[Row<'_>], delimiter: u8) -> Read<Decimals> {
        if delimiter == b',' {
            return Ok(Decimals::Point);
        }
        let mut comma = None;
        let mut point = None;
        for (line, cell) in head
            .iter()
            .flat_map(|row| row.cells.iter().map(move |cell| (row.line, cell)))
        {
            match (Decimals::Point.number(cell), Decimals::Comma.number(cell)) {
                (None, Some(_)) => comma = comma.or(Some((line, cell))),
                (Some(_), None) => point = point.or(Some((line, cell))),
                _ => {}
            }
        }
        match (comma, point) {
            (Some((line, comma)), Some((other, point))) => {
                let found = format!("`{comma}`, and `{point}` in line {other}");
                let remedy = "export all numbers with the same decimal sign";
                Err(Fault::new(
                    Place::Line(line),
                    found,
                    "decimal commas or decimal points",
                    remedy,
                ))
            }
            (Some(_), None) => Ok(Decimals::Comma),
            (None, Some(_)) => Ok(Decimals::Point),
            (None, None) => {
                let numbers = || {
                    head.iter()
                        .flat_map(|row| &row.cells)
                        .filter(|cell| looks_like_a_number(cell))
                };
                let only_commas = numbers().any(|cell| cell.contains(',')) && !numbers().any(|cell| cell.contains('.'));
                Ok(if only_commas { Decimals::Comma } else { Decimals::Point })
            }
        }
    }

    fn cell(self, cell: &str) -> Cell {
        match self.number(cell) {
            Some(number) if number.is_nan() => Cell::Missing,
            Some(number) => Cell::Number(number),
            None => clock::seconds(cell).map_or_else(|| Cell::Text(cell.into()), Cell::Stamp),
        }
    }

    /// The number in a column of a row.
    fn number_of(self, row: &Row<'_>, column: &Column) -> Read<f64> {
        let cell = &row.cells[column.index];
        let read = match column.stamped {
            true if !is_missing(cell) => clock::seconds(cell),
            _ => self.number(cell),
        };
        read.ok_or_else(|| {
            let place = Place::Cell(row.line, column.name.clone());
            let expected = match column.stamped {
                true => "a date or a clock time such as 12:30:05.25",
                false => self.expected(),
            };
            let remedy = "correct the cell, or leave it empty";
            Fault::new(place, format!("`{cell}`"), expected, remedy)
        })
    }

    /// The number in a cell, NaN for a missing one; `None` if the cell contains anything else.
    fn number(self, cell: &str) -> Option<f64> {
        let (decimal, thousands) = self.signs();
        if let Some(number) = self.plain_number(cell) {
            return Some(number);
        }
        let cell = cell.trim();
        if is_missing(cell) {
            return Some(f64::NAN);
        }
        if !looks_like_a_number(cell) {
            return None;
        }
        if !cell.contains(thousands) {
            return cell.replace(decimal, ".").replace(['d', 'D'], "e").parse().ok();
        }
        let (whole, fraction) = cell.split_once(decimal).unwrap_or((cell, ""));
        let digits = whole.trim_start_matches(['+', '-']);
        let mut groups = digits.split(thousands);
        let leading = groups.next().unwrap_or("");
        let grouped = (1..=3).contains(&leading.len()) && leading != "0" && groups.all(|group| group.len() == 3);
        let plain = format!("{}.{fraction}", whole.replace(thousands, ""));
        grouped.then(|| plain.parse().ok()).flatten()
    }

    /// The number in a cell without separated thousands and with at most 32 characters, as almost all are.
    fn plain_number(self, cell: &str) -> Option<f64> {
        let number = match self {
            Decimals::Point => fast_float2::parse(cell).ok(),
            Decimals::Comma => {
                let mut with_point = [0; 32];
                let with_point = with_point.get_mut(..cell.len())?;
                for (own, byte) in with_point.iter_mut().zip(cell.bytes()) {
                    *own = match byte {
                        b',' => b'.',
                        b'.' => b',',
                        other => other,
                    };
                }
                fast_float2::parse(with_point).ok()
            }
        };
        // `inf` and `nan` are numbers to the parser.
        number.filter(|number: &f64| number.is_finite())
    }

    /// The sign before decimals, and that between thousands.
    fn signs(self) -> (char, char) {
        match self {
            Decimals::Point => ('.', ','),
            Decimals::Comma => (',', '.'),
        }
    }

    fn expected(self) -> &'static str {
        match self {
            Decimals::Point => "a number with a decimal point, or an empty cell",
            Decimals::Comma => "a number with a decimal comma, or an empty cell",
        }
    }
}

/// True for a text of digits, signs, separators and an exponent.
fn looks_like_a_number(cell: &str) -> bool {
    cell.contains(|c: char| c.is_ascii_digit())
        && cell.starts_with(|c: char| c.is_ascii_digit() || matches!(c, '+' | '-' | '.' | ','))
        && cell
            .chars()
            .all(|c| c.is_ascii_digit() || matches!(c, '+' | '-' | '.' | ',' | 'e' | 'E' | 'd' | 'D'))
}

fn is_missing(cell: &str) -> bool {
    const MISSING: [&str; 9] = ["", "nan", "na", "n/a", "#n/a", "#nv", "null", "-", "--"];
    MISSING.iter().any(|missing| cell.eq_ignore_ascii_case(missing))
}

#[cfg(test)]
mod tests {
    use super::Decimals::{Comma, Point};

    #[test]
    fn numbers_are_read_as_they_are_written() {
        let cases = [
            (Comma, "1.812,8", Some(1812.8)),
            (Comma, "-80,00", Some(-80.0)),
            (Comma, "12.5", None),
            (Comma, "1.234", Some(1234.0)),
            (Point, "1,234.5", Some(1234.5)),
            (Point, "1.234", Some(1.234)),
            (Point, "12,5", None),
            (Point, "-1.5E-3", Some(-1.5e-3)),
            (Point, "-1.5D-03", Some(-1.5e-3)),
            (Point, "05.03.2024", None),
            (Point, "12 mm", None),
        ];
        for (decimals, cell, number) in cases {
            assert_eq!(decimals.number(cell), number, "{cell}");
        }
    }
}
