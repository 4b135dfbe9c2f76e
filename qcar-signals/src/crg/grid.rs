//! The data in each of the formats.

use crate::bytes::{Number, Order, text};
use crate::error::{Fault, Place, Read};

use super::header::Header;

/// Bytes of a record of binary numbers; the last record is padded.
const BINARY_RECORD: usize = 80;

/// The data by columns.
pub(super) struct Grid {
    /// Name of the format.
    pub format: &'static str,
    /// A number for each row; NaN if it is missing.
    pub columns: Vec<Vec<f64>>,
}

/// How numbers are stored.
enum Stored {
    Binary(Number),
    /// As text: characters of a number, and numbers in a line.
    Text(usize, usize),
}

/// The format by the line `#:`; without this line, binary numbers of single precision.
fn format(header: &Header) -> Read<(&'static str, Stored)> {
    let Some((line, name)) = header.defined("#:").next() else {
        return Ok(("KRBI", Stored::Binary(Number::F32)));
    };
    Ok(match name.to_ascii_uppercase().as_str() {
        "KRBI" => ("KRBI", Stored::Binary(Number::F32)),
        "KDBI" => ("KDBI", Stored::Binary(Number::F64)),
        "LRFI" => ("LRFI", Stored::Text(10, 8)),
        "LDFI" => ("LDFI", Stored::Text(20, 4)),
        other => {
            let remedy = "save the road in one of these formats";
            let found = format!("the format `{other}`");
            return Err(Fault::new(Place::Line(line), found, "KRBI, KDBI, LRFI or LDFI", remedy));
        }
    })
}

impl Grid {
    /// Reads the data after the header.
    pub fn read(data: &[u8], columns: usize, header: &Header) -> Read<Self> {
        let (format, stored) = format(header)?;
        let columns = match stored {
            Stored::Binary(number) => binary(data, number, columns, header)?,
            Stored::Text(width, of_line) => written(data, (width, of_line), columns, header)?,
        };
        let rows = columns[0].len();
        let found = format!("{rows} rows of data");
        let expected = |declared: f64| format!("{declared} rows, as REFERENCE_LINE_END_U says");
        match header.declared_rows()? {
            Some(declared) if declared > rows as f64 => Err(Fault::cut_off(Place::File, found, expected(declared))),
            Some(declared) if declared < rows as f64 => Err(Fault::damaged(Place::File, found, expected(declared))),
            _ if rows < 2 => Err(Fault::cut_off(Place::File, found, "a road of two at least")),
            _ => Ok(Grid { format, columns }),
        }
    }
}

/// Numbers one after another; the last record is padded with numbers that are ignored.
fn binary(data: &[u8], number: Number, columns: usize, header: &Header) -> Read<Vec<Vec<f64>>> {
    let row = columns * number.size();
    let declared = header
        .declared_rows()?
        .filter(|rows| rows * row as f64 <= data.len() as f64);
    let whole = declared.map_or(data.len() / row, |rows| rows as usize);
    if declared.is_some() && data.len() - whole * row >= BINARY_RECORD {
        let place = Place::Byte((header.end + whole * row) as u64);
        return Err(Fault::damaged(
            place,
            format!("{} bytes more", data.len() - whole * row),
            "the end of the file",
        ));
    }
    let data = &data[..whole * row];
    let column = |at: usize| number.strided(data.get(at * number.size()..).unwrap_or_default(), row, Order::Big);
    let mut grid: Vec<Vec<f64>> = (0..columns).map(column).collect();
    if declared.is_none() {
        let is_filled = |row: usize| grid.iter().any(|column| !column[row].is_nan());
        let rows = (0..whole).rev().find(|&row| is_filled(row)).map_or(0, |last| last + 1);
        grid.iter_mut().for_each(|column| column.truncate(rows));
    }
    Ok(grid)
}

/// Lines of numbers of equal width. Each row begins on a new line.
fn written(data: &[u8], (width, of_line): (usize, usize), columns: usize, header: &Header) -> Read<Vec<Vec<f64>>> {
    let mut grid = vec![Vec::new(); columns];
    let mut at = 0;
    for (line, bytes) in (header.lines + 1..).zip(data.split(|&byte| byte == b'\n')) {
        let bytes = bytes.trim_ascii_end();
        if bytes.is_empty() {
            continue;
        }
        let wanted = (columns - at).min(of_line);
        let fields: Vec<&[u8]> = bytes.chunks(width).collect();
        if fields.len() != wanted {
            let (found, expected) = (
                format!("{} numbers", fields.len()),
                format!("{wanted}, of {width} characters each"),
            );
            return Err(Fault::damaged(Place::Line(line), found, expected));
        }
        for field in fields {
            grid[at].push(value(field, line)?);
            at += 1;
        }
        at %= columns;
    }
    match at {
        0 => Ok(grid),
        _ => Err(Fault::cut_off(
            Place::File,
            format!("a last row of {at} numbers"),
            format!("{columns} numbers"),
        )),
    }
}

/// A number; NaN for a text that begins with a star.
fn value(field: &[u8], line: u64) -> Read<f64> {
    let own = text(field);
    let own = own.trim();
    if own.starts_with('*') {
        return Ok(f64::NAN);
    }
    let number = own.parse().ok().filter(|number: &f64| !number.is_infinite());
    number.ok_or_else(|| Fault::damaged(Place::Line(line), format!("`{own}`"), "a number or `*missing*`"))
}
