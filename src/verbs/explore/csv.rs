//! Rows as CSV.

use std::fmt::Write as _;
use std::fs::File;
use std::io::{self, BufRead, BufReader, Seek, SeekFrom, Write};

use super::existing_rows::ExistingRows;

/// A CSV file that is written row by row.
pub(super) struct Csv {
    file: File,
    width: usize,
}

impl Csv {
    /// Continues a file with these columns after its complete rows, whose first column must be as `first` says. An
    /// incomplete row is removed.
    ///
    /// # Errors
    /// Fails with the error of the system.
    pub fn open(mut file: File, columns: &[String], first: impl Fn(u64) -> f64) -> io::Result<(Self, ExistingRows)> {
        let header = columns.join(",") + "\n";
        let (mut kept, mut end) = (ExistingRows::default(), 0);
        let mut reader = BufReader::new(&file);
        let mut line = Vec::new();
        if reader.read_until(b'\n', &mut line)? > 0 && line == header.as_bytes() {
            end = line.len() as u64;
            while let Some(row) = whole_row(&mut reader, &mut line, columns.len())? {
                if row[0] != first(kept.rows) {
                    break;
                }
                end += line.len() as u64;
                kept.rows += 1;
                kept.last = Some(row);
            }
        }
        file.set_len(end)?;
        file.seek(SeekFrom::Start(end))?;
        if end == 0 {
            file.write_all(header.as_bytes())?;
        }
        let width = columns.len();
        Ok((Csv { file, width }, kept))
    }

    /// Appends rows, all or none as far as the system allows.
    ///
    /// # Errors
    /// Fails with the error of the system.
    pub fn append(&mut self, rows: &[f64]) -> io::Result<()> {
        let mut text = String::new();
        for row in rows.chunks_exact(self.width) {
            for (place, number) in row.iter().enumerate() {
                text.push_str(if place == 0 { "" } else { "," });
                if number.is_finite() {
                    let _ = write!(text, "{number}");
                }
            }
            text.push('\n');
        }
        self.file.write_all(text.as_bytes())
    }
}

/// The numbers of the next row; `None` if there is no further complete row.
fn whole_row(reader: &mut impl BufRead, line: &mut Vec<u8>, width: usize) -> io::Result<Option<Vec<f64>>> {
    line.clear();
    reader.read_until(b'\n', line)?;
    let text = line.strip_suffix(b"\n").and_then(|line| std::str::from_utf8(line).ok());
    let number = |cell: &str| match cell {
        "" => Some(f64::NAN),
        cell => cell.parse().ok(),
    };
    let row = text.and_then(|text| text.split(',').map(number).collect::<Option<Vec<f64>>>());
    Ok(row.filter(|row| row.len() == width))
}
