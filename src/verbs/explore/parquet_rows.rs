//! Rows as Apache Parquet.

use std::fs::File;
use std::io::{self, BufWriter, Read, Seek, SeekFrom, Write};

use super::existing_rows::ExistingRows;
use crate::parquet::{GROUP, MAGIC, Shape};

/// A Parquet file that is written group by group.
pub(super) struct Grouped {
    file: File,
    shape: Shape,
    /// Rows of an incomplete group.
    waiting: Vec<f64>,
    /// Number of all rows.
    rows: u64,
}

impl Grouped {
    /// Continues a file of this shape after its complete groups. An incomplete group is removed.
    ///
    /// # Errors
    /// Fails with the error of the system.
    pub fn open(mut file: File, shape: Shape) -> io::Result<(Self, ExistingRows)> {
        let length = file.metadata()?.len();
        let mut magic = [0; 4];
        let begun = length >= shape.length(0) && file.read_exact(&mut magic).is_ok() && magic == *MAGIC;
        let groups = match begun {
            true => (length - shape.length(0)) / shape.group_length(GROUP),
            false => 0,
        };
        let mut kept = ExistingRows {
            rows: groups * GROUP,
            last: None,
        };
        if groups > 0 {
            kept.last = Some(last_row(&mut file, &shape, groups)?);
        }
        file.set_len(shape.length(groups))?;
        file.seek(SeekFrom::Start(0))?;
        file.write_all(MAGIC)?;
        file.seek(SeekFrom::Start(shape.length(groups)))?;
        let (waiting, rows) = (Vec::new(), kept.rows);
        Ok((
            Grouped {
                file,
                shape,
                waiting,
                rows,
            },
            kept,
        ))
    }

    /// Adds rows and writes the groups that they complete.
    ///
    /// # Errors
    /// Fails with the error of the system.
    pub fn append(&mut self, rows: &[f64]) -> io::Result<()> {
        let width = self.shape.columns.len();
        self.rows += (rows.len() / width) as u64;
        self.waiting.extend(rows);
        let whole = GROUP as usize * width;
        while self.waiting.len() >= whole {
            self.write(whole)?;
        }
        Ok(())
    }

    /// Writes the remaining rows and the end of the file.
    ///
    /// # Errors
    /// Fails with the error of the system.
    pub fn finish(&mut self) -> io::Result<()> {
        if !self.waiting.is_empty() {
            self.write(self.waiting.len())?;
        }
        let mut out = BufWriter::new(&self.file);
        self.shape.write_end(self.rows, &mut out)?;
        out.flush()
    }

    fn write(&mut self, numbers: usize) -> io::Result<()> {
        let mut out = BufWriter::new(&self.file);
        self.shape.write_group(&self.waiting[..numbers], &mut out)?;
        out.flush()?;
        self.waiting.drain(..numbers);
        Ok(())
    }
}

/// The last number of each column in the last of several groups.
fn last_row(file: &mut File, shape: &Shape, groups: u64) -> io::Result<Vec<f64>> {
    let width = shape.columns.len() as u64;
    let column = shape.group_length(GROUP) / width;
    let mut number = |place: u64| {
        let end = shape.length(groups - 1) + (place + 1) * column;
        let mut bytes = [0; 8];
        file.seek(SeekFrom::Start(end - bytes.len() as u64))?;
        file.read_exact(&mut bytes)?;
        Ok(f64::from_le_bytes(bytes))
    };
    (0..width).map(&mut number).collect()
}
