//! Tables as Apache Parquet: numbers without gaps, plain and uncompressed, in groups of rows of one size.
//!
//! So the place of every number follows from the shape of the table. A table that was cut off while it grew is continued
//! after its last whole group, which no general writer of the format does, since it keeps the places of its groups in memory.
//! The format: <https://parquet.apache.org/docs/file-format/>.

// The encoding of metadata (Thrift compact protocol).
mod thrift;
// Metadata of pages and of the file.
mod records;

use std::io::{self, Write};

use records::page_header;

/// Rows of a whole group.
pub const GROUP: u64 = 16_384;

/// What a file begins and ends with.
pub const MAGIC: &[u8; 4] = b"PAR1";

/// The columns of a table, and what is said of it.
pub struct Shape {
    /// Names, each of a column of doubles.
    pub columns: Vec<String>,
    /// A key and a text for those who ask the file what it is.
    pub about: (String, String),
}

impl Shape {
    /// Bytes of a group with so many rows.
    pub fn group_length(&self, rows: u64) -> u64 {
        self.columns.len() as u64 * chunk_length(rows)
    }

    /// Bytes of the beginning of a file and of its first groups, all of them whole.
    pub fn length(&self, groups: u64) -> u64 {
        MAGIC.len() as u64 + groups * self.group_length(GROUP)
    }

    /// Writes a group: numbers row by row.
    ///
    /// # Errors
    /// What the system says.
    pub fn write_group(&self, rows: &[f64], out: &mut impl Write) -> io::Result<()> {
        let width = self.columns.len();
        let header = page_header((rows.len() / width) as u64);
        for column in 0..width {
            out.write_all(&header)?;
            let numbers = rows.iter().skip(column).step_by(width);
            let bytes: Vec<u8> = numbers.flat_map(|number| number.to_le_bytes()).collect();
            out.write_all(&bytes)?;
        }
        Ok(())
    }

    /// Writes the end of a file with so many rows.
    ///
    /// # Errors
    /// What the system says.
    pub fn write_end(&self, rows: u64, out: &mut impl Write) -> io::Result<()> {
        let record = records::of_file(self, rows);
        out.write_all(&record)?;
        out.write_all(&(record.len() as u32).to_le_bytes())?;
        out.write_all(MAGIC)
    }
}

/// Bytes of a column in a group.
fn chunk_length(rows: u64) -> u64 {
    page_header(rows).len() as u64 + rows * size_of::<f64>() as u64
}
