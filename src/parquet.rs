//! Tables as Apache Parquet: numbers without gaps, plain and uncompressed, in groups of rows of one size.
//!
//! So the position of every number follows from the shape of the table, and an incomplete table can be continued after
//! its last complete group. General writers cannot do that, since they keep the positions of the groups in memory.
//! The format: <https://parquet.apache.org/docs/file-format/>.

// The encoding of metadata (Thrift compact protocol).
mod thrift;
// Metadata of pages and of the file.
mod records;

use std::io::{self, Write};

use records::page_header;

/// Rows of a complete group.
pub const GROUP: u64 = 16_384;

/// First and last bytes of a file.
pub const MAGIC: &[u8; 4] = b"PAR1";

/// The columns of a table and its metadata.
pub struct Shape {
    /// Names of the columns, all of doubles.
    pub columns: Vec<String>,
    /// Key and text of the metadata.
    pub about: (String, String),
}

impl Shape {
    /// Bytes of a group with this number of rows.
    pub fn group_length(&self, rows: u64) -> u64 {
        self.columns.len() as u64 * chunk_length(rows)
    }

    /// Bytes of the beginning of a file with this number of complete groups.
    pub fn length(&self, groups: u64) -> u64 {
        MAGIC.len() as u64 + groups * self.group_length(GROUP)
    }

    /// Writes a group, with the numbers row by row.
    ///
    /// # Errors
    /// Fails with the error of the system.
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

    /// Writes the end of a file with this number of rows.
    ///
    /// # Errors
    /// Fails with the error of the system.
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
