//! Tables and numbers as text.

use std::iter::repeat_n;

use crate::terminal;

// Tables wider than the terminal.
mod narrow;

/// Rows under a heading, columns aligned: text to the left, numbers to the right.
pub struct Table {
    rows: Vec<Vec<String>>,
}

impl Table {
    /// A table with these headings.
    pub fn new<const N: usize>(headings: [&str; N]) -> Self {
        Table {
            rows: vec![headings.map(String::from).into()],
        }
    }

    /// A table with any number of headings.
    pub fn with_headings(headings: Vec<String>) -> Self {
        Table { rows: vec![headings] }
    }

    /// Adds a row, with as many cells as there are headings.
    pub fn row(&mut self, cells: Vec<String>) {
        assert_eq!(cells.len(), self.rows[0].len());
        self.rows.push(cells);
    }

    /// The text, each line ended; no wider than the terminal.
    pub fn text(&self) -> String {
        self.within(terminal::width())
    }

    fn within(&self, width: Option<usize>) -> String {
        let columns = 0..self.rows[0].len();
        let shapes: Vec<_> = columns.map(|at| (self.width(at), self.is_numeric(at))).collect();
        match width {
            Some(width) if narrow::total(&shapes) > width => narrow::text(&self.rows, &shapes, width),
            _ => lines(&self.rows, &shapes, 1),
        }
    }

    fn width(&self, column: usize) -> usize {
        self.rows
            .iter()
            .map(|row| row[column].chars().count())
            .max()
            .unwrap_or(0)
    }

    fn is_numeric(&self, column: usize) -> bool {
        let mut cells = self.rows[1..]
            .iter()
            .map(|row| row[column].as_str())
            .filter(|cell| !matches!(*cell, "" | "-"));
        cells.all(|cell| cell.parse::<f64>().is_ok())
    }
}

/// Width of a column, and true if it contains numbers.
type Shape = (usize, bool);

/// Space between two columns.
const SPACE: &str = "  ";

/// Lines of a table, of which the first `head` are headings.
fn lines(rows: &[Vec<String>], shapes: &[Shape], head: usize) -> String {
    let lines = rows.iter().map(|row| line(row, shapes)).enumerate();
    let styled = lines.map(|(at, line)| if at < head { terminal::heading(&line) } else { line });
    styled.map(|line| line + "\n").collect()
}

fn line(row: &[String], shapes: &[Shape]) -> String {
    let mut line = String::new();
    for (at, (cell, &(width, numeric))) in row.iter().zip(shapes).enumerate() {
        let space = if at > 0 { SPACE } else { "" };
        let blanks = width.saturating_sub(cell.chars().count());
        let (left, right) = if numeric { (blanks, 0) } else { (0, blanks) };
        line += space;
        line.extend(repeat_n(' ', left));
        line += cell;
        line.extend(repeat_n(' ', right));
    }
    line.truncate(line.trim_end().len());
    line
}

/// A number with this number of significant digits, without exponent if that is short, and without trailing zeros.
pub fn number(value: f64, digits: usize) -> String {
    if value == 0.0 {
        return "0".into();
    }
    if !value.is_finite() {
        return format!("{}", value.abs());
    }
    let scientific = format!("{value:.*e}", digits - 1);
    let (mantissa, exponent) = scientific.split_once('e').expect("`{:e}` writes an exponent");
    let exponent: i32 = exponent.parse().expect("`{:e}` writes a whole exponent");
    if (-4..7).contains(&exponent) {
        let decimals = usize::try_from(digits as i32 - 1 - exponent).unwrap_or(0);
        trimmed(&format!("{:.decimals$}", scientific.parse::<f64>().unwrap_or(value)))
    } else {
        format!("{}e{exponent}", trimmed(mantissa))
    }
}

/// The same, or a dash for `None`.
pub fn or_dash(value: Option<f64>, digits: usize) -> String {
    value.map_or("-".into(), |value| number(value, digits))
}

/// Notices, one per line. Those that differ only by the run that they begin with are one: `a, b: what`.
pub fn noted(of: &[String]) -> String {
    let mut merged: Vec<(String, Option<&str>)> = Vec::new();
    for notice in of {
        let of_run = notice.split_once(": ").filter(|(run, _)| !run.contains(' '));
        let (begin, what) = of_run.map_or((notice.as_str(), None), |(run, what)| (run, Some(what)));
        match merged.iter_mut().find(|(_, other)| what.is_some() && *other == what) {
            Some((runs, _)) => *runs += &format!(", {begin}"),
            None => merged.push((begin.into(), what)),
        }
    }
    let line = |(begin, what): &(String, Option<&str>)| match what {
        Some(what) => format!("note: {begin}: {what}\n"),
        None => format!("note: {begin}\n"),
    };
    merged.iter().map(line).collect()
}

/// Notices below a table, after an empty line; empty without any.
pub fn noted_below(of: &[String]) -> String {
    match noted(of) {
        none if none.is_empty() => none,
        notes => format!("\n{notes}"),
    }
}

/// A count with its noun, in the plural unless it is 1.
pub fn counted(count: usize, what: &str) -> String {
    let ending = if count == 1 { "" } else { "s" };
    format!("{count} {what}{ending}")
}

fn trimmed(text: &str) -> String {
    match text.contains('.') {
        true => text.trim_end_matches('0').trim_end_matches('.').into(),
        false => text.into(),
    }
}

#[cfg(test)]
mod tests {
    use super::{Table, noted, number};

    #[test]
    fn numbers_keep_their_significant_digits() {
        let cases = [
            (0.0, "0"),
            (-0.0, "0"),
            (28110.0, "28110"),
            (1234567.0, "1234570"),
            (-0.0123456789, "-0.0123457"),
            (1.0, "1"),
            (6e-7, "6e-7"),
            (2.43e9, "2.43e9"),
            (0.99999999, "1"),
        ];
        for (value, text) in cases {
            assert_eq!(number(value, 6), text);
        }
    }

    #[test]
    fn a_notice_of_several_runs_is_one() {
        let all = ["a: no input", "the roads differ: why", "b: no input", "b: late"].map(String::from);
        let lines = "note: a, b: no input\nnote: the roads differ: why\nnote: b: late\n";
        assert_eq!(noted(&all), lines);
    }

    #[test]
    fn columns_line_up() {
        let mut table = Table::new(["name", "value"]);
        table.row(vec!["k".into(), "1".into()]);
        table.row(vec!["long".into(), "-12.5".into()]);
        assert_eq!(table.text(), "name  value\nk         1\nlong  -12.5\n");
    }
}
