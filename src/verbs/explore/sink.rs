//! The destination of rows: a file with a temporary name until it is complete, which an interrupted run resumes.

use std::fs::{File, OpenOptions};
use std::io;
use std::path::{Path, PathBuf};

use qcar_runtime::error::{InputError, Place, Problem};

use super::csv::Csv;
use super::existing_rows::ExistingRows;
use super::parquet_rows::Grouped;
use crate::files::finish;
use crate::parquet::Shape;

/// A table that is written row by row.
pub(super) struct Sink {
    path: PathBuf,
    table: Table,
}

enum Table {
    Csv(Csv),
    Grouped(Grouped),
}

/// Endings of the kinds of files.
const ENDINGS: [&str; 2] = ["csv", "parquet"];

/// A file for results, whose kind follows from its ending: the value of `--out`.
///
/// # Errors
/// Fails if the ending is unknown.
pub(super) fn table_for_results(name: &str) -> Result<PathBuf, String> {
    let path = PathBuf::from(name);
    match ending(&path).is_some_and(|own| ENDINGS.contains(&own)) {
        true => Ok(path),
        false => Err("expected a name that ends with .csv or .parquet; rename the file".into()),
    }
}

fn ending(path: &Path) -> Option<&str> {
    path.extension()?.to_str()
}

/// The name of a file until it is complete.
pub(super) fn unfinished(path: &Path) -> PathBuf {
    let mut name = path.as_os_str().to_owned();
    name.push(".part");
    name.into()
}

impl Sink {
    /// The table at a path with these columns, and its existing rows; `first` is the first column of a row. `about` is
    /// a text for the metadata of the file.
    ///
    /// # Errors
    /// Fails if the file cannot be written, or if another qcar writes it.
    pub fn open(
        path: &Path,
        columns: &[String],
        about: &str,
        first: impl Fn(u64) -> f64,
    ) -> Result<(Self, ExistingRows), InputError> {
        let wrong = |error: io::Error| of_file(path, &error);
        let file = growing(path)?;
        let (table, kept) = if ending(path) == Some("csv") {
            let (table, kept) = Csv::open(file, columns, first).map_err(wrong)?;
            (Table::Csv(table), kept)
        } else {
            let shape = Shape {
                columns: columns.to_vec(),
                about: ("qcar".into(), about.into()),
            };
            let (table, kept) = Grouped::open(file, shape).map_err(wrong)?;
            (Table::Grouped(table), kept)
        };
        let path = path.into();
        Ok((Sink { path, table }, kept))
    }

    /// Adds rows.
    ///
    /// # Errors
    /// Fails if the file can no longer be written.
    pub fn append(&mut self, rows: &[f64]) -> Result<(), InputError> {
        let written = match &mut self.table {
            Table::Csv(csv) => csv.append(rows),
            Table::Grouped(grouped) => grouped.append(rows),
        };
        written.map_err(|error| of_file(&self.path, &error))
    }

    /// Completes the file and gives it its final name.
    ///
    /// # Errors
    /// Fails if the file can no longer be written.
    pub fn finish(self) -> Result<(), InputError> {
        if let Table::Grouped(mut grouped) = self.table {
            grouped.finish().map_err(|error| of_file(&self.path, &error))?;
        }
        finish(&unfinished(&self.path), &self.path)
    }
}

/// The file under its temporary name, locked by this process.
fn growing(path: &Path) -> Result<File, InputError> {
    let part = unfinished(path);
    let mut options = OpenOptions::new();
    let file = options.read(true).write(true).create(true).truncate(false).open(&part);
    let file = file.map_err(|error| of_file(&part, &error))?;
    match file.try_lock() {
        Ok(()) => Ok(file),
        Err(error) => {
            let remedy = "wait for the other qcar, or choose another file";
            let expected = "a file that no other process is writing";
            Err(Problem::new(part, Place::File, error.to_string(), expected, remedy).into())
        }
    }
}

fn of_file(path: &Path, error: &io::Error) -> InputError {
    let remedy =
        "choose another place, or free some space there; the same command resumes from the rows that are written";
    Problem::new(path, Place::File, error.to_string(), "a writable place", remedy).into()
}
