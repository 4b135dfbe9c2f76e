//! A CSV file, plain or compressed by gzip, as named columns of finite numbers.

use std::collections::HashSet;
use std::io::{ErrorKind, Read};
use std::path::{Path, PathBuf};

use csv::{ByteRecord, ReaderBuilder, Terminator};

use super::unit::{Declared, examples, says_its_angle};
use crate::bounded;
use crate::error::{InputError, Place, Problem};
use crate::spelling;

/// A complete file.
pub(super) struct Table {
    pub file: PathBuf,
    pub names: Vec<String>,
    /// Values in SI; one column for each name, all of one length of at least 1; every number is finite.
    pub columns: Vec<Vec<f64>>,
    /// Line of each row in the file, since blank lines are skipped.
    pub lines: Vec<u64>,
}

impl Table {
    /// The place of a cell.
    pub fn cell(&self, row: usize, name: &str) -> Place {
        Place::Cell(self.lines[row], name.to_string())
    }

    /// Removes a column that [`check_names`] has found.
    pub fn take(&mut self, name: &str) -> Vec<f64> {
        let at = self
            .names
            .iter()
            .position(|n| n == name)
            .expect("the header was checked for this column");
        std::mem::take(&mut self.columns[at])
    }
}

/// A column of the header line: `time`, or `time [ms]`.
pub(super) struct Heading {
    pub name: String,
    /// Text in brackets after the name.
    pub unit: Option<String>,
}

impl Heading {
    fn of(text: &str) -> Heading {
        let parts = text.strip_suffix(']').and_then(|text| text.rsplit_once('['));
        match parts.filter(|(name, _)| !name.trim().is_empty()) {
            Some((name, unit)) => Heading {
                name: name.trim().into(),
                unit: Some(unit.trim().into()),
            },
            None => Heading {
                name: text.into(),
                unit: None,
            },
        }
    }
}

/// The header line of `file`.
pub(super) fn header(file: &Path) -> Result<Vec<Heading>, InputError> {
    headings(file, &mut open(file)?)
}

fn headings(file: &Path, reader: &mut csv::Reader<Box<dyn Read>>) -> Result<Vec<Heading>, InputError> {
    Ok(names(file, reader)?.iter().map(|name| Heading::of(name)).collect())
}

/// Problems of the units of columns; `si` gives the unit of the required kind.
pub(super) fn check_units(
    file: &Path,
    headings: &[Heading],
    si: impl Fn(&str) -> Option<&'static str>,
) -> Vec<Problem> {
    let stated = headings
        .iter()
        .filter_map(|own| Some((&own.name, own.unit.as_ref()?, si(&own.name)?)));
    let fits = |unit: &str, si: &str| Declared::of(unit).is_some_and(|own| own.is_like(si)) && says_its_angle(unit, si);
    let wrong = stated.filter(|(_, unit, si)| !fits(unit, si));
    wrong
        .map(|(name, unit, si)| {
            let place = Place::Cell(1, name.clone());
            let remedy = "write the unit of the column into the brackets, or leave them out for SI";
            Problem::new(file, place, format!("the unit \"{unit}\""), examples(si), remedy)
        })
        .collect()
}

/// Reads all of `file`.
pub(super) fn read(file: &Path) -> Result<Table, InputError> {
    let mut reader = open(file)?;
    let headings = headings(file, &mut reader)?;
    let units: Vec<Option<Declared>> = headings.iter().map(|own| Declared::of(own.unit.as_ref()?)).collect();
    let names: Vec<String> = headings.into_iter().map(|own| own.name).collect();
    let mut table = Table {
        file: file.into(),
        columns: vec![Vec::new(); names.len()],
        names,
        lines: Vec::new(),
    };
    let mut record = ByteRecord::new();
    while reader
        .read_byte_record(&mut record)
        .map_err(|e| unreadable(file, table.lines.last(), &e))?
    {
        if !is_blank(&record) {
            push(&mut table, &record, line(&reader))?;
        }
    }
    if table.lines.is_empty() {
        return Err(Problem::new(
            file,
            Place::Line(2),
            "the end of the file",
            "rows of numbers",
            "export the data again",
        )
        .into());
    }
    for (column, unit) in table.columns.iter_mut().zip(&units) {
        if let Some(unit) = unit {
            column.iter_mut().for_each(|value| *value = unit.si(*value));
        }
    }
    Ok(table)
}

/// Problems of one file that are reported one by one, and names in a list.
const MOST_PROBLEMS: usize = 20;

/// Problems of the columns of a file, whose names must be `required` and may be `allowed`.
pub(super) fn check_names(file: &Path, names: &[String], required: &[&str], allowed: &[&str]) -> Vec<Problem> {
    let mut problems = Vec::new();
    let known: Vec<&str> = required.iter().chain(allowed).copied().collect();
    let is_known = |name: &String| known.contains(&name.as_str());
    // A misspelt name is reported once, at its own place.
    let misspelt = |name: &String| nearest(name, &known).filter(|own| !names.iter().any(|other| other == own));
    let meant: Vec<&str> = names
        .iter()
        .filter(|name| !is_known(name))
        .filter_map(misspelt)
        .collect();
    let missing = required.iter().filter(|name| !names.iter().any(|n| n == *name));
    for name in missing.filter(|name| !meant.contains(name)) {
        let found = format!("the columns {}", list(names));
        let remedy = format!("add the column `{name}`, or correct the header line (columns are separated by commas)");
        problems.push(Problem::new(
            file,
            Place::Line(1),
            found,
            format!("a column `{name}`"),
            remedy,
        ));
    }
    let mut seen = HashSet::new();
    for name in names {
        if problems.len() == MOST_PROBLEMS {
            let (found, expected) = (format!("{} columns", names.len()), "the columns of the campaign alone");
            let remedy = "further columns of these are wrong too: choose the right file, or export it again";
            problems.push(Problem::new(file, Place::Line(1), found, expected, remedy));
            break;
        }
        let place = || Place::Cell(1, name.clone());
        if !seen.insert(name) {
            problems.push(Problem::new(
                file,
                place(),
                "a second column of this name",
                "each name once",
                "rename or remove one",
            ));
        } else if !is_known(name) {
            let otherwise =
                "rename or remove the column; if it is a sensor of a time history, declare it as a [[channel]]";
            let remedy = match misspelt(name) {
                Some(own) => format!("did you mean `{own}`? Otherwise {otherwise}"),
                None => otherwise.into(),
            };
            problems.push(Problem::new(
                file,
                place(),
                "an unknown column",
                format!("one of {}", list(&known)),
                remedy,
            ));
        }
    }
    problems
}

fn nearest<'a>(name: &str, known: &[&'a str]) -> Option<&'a str> {
    spelling::nearest(name, known.iter().copied())
}

fn list<T: AsRef<str>>(names: &[T]) -> String {
    let first = names.iter().take(MOST_PROBLEMS);
    let first: Vec<_> = first.map(|name| format!("`{}`", name.as_ref())).collect();
    match names.len() - first.len() {
        0 => first.join(", "),
        more => format!("{} and {more} more", first.join(", ")),
    }
}

fn open(file: &Path) -> Result<csv::Reader<Box<dyn Read>>, InputError> {
    let bytes = bounded::table(file).map_err(|error| missing(file, &error.to_string()))?;
    Ok(ReaderBuilder::new()
        .flexible(true)
        .terminator(Terminator::Any(b'\n'))
        .has_headers(false)
        .from_reader(Box::new(bytes.chain(&b"\n"[..]))))
}

/// Line of the record that was just read. Only line feeds end a record, and the last line gets one if the file has
/// none, so the reader is always on the next line.
fn line(reader: &csv::Reader<Box<dyn Read>>) -> u64 {
    reader.position().line() - 1
}

/// The cells without white space around them; the last one may end with a carriage return.
fn cells(record: &ByteRecord) -> impl Iterator<Item = &[u8]> {
    record.iter().map(<[u8]>::trim_ascii)
}

fn is_blank(record: &ByteRecord) -> bool {
    record.len() < 2 && cells(record).all(<[u8]>::is_empty)
}

fn missing(file: &Path, found: &str) -> InputError {
    let remedy = "correct the path (relative to the folder of campaign.toml), or put the file there";
    Problem::new(file, Place::File, found, "a readable file", remedy).into()
}

fn unreadable(file: &Path, last_line: Option<&u64>, error: &csv::Error) -> InputError {
    let place = last_line.map_or(Place::File, |line| Place::Line(line + 1));
    let expected = "UTF-8 comma-separated numbers (gzip-compressed if the name ends in .gz)";
    let too_large = matches!(error.kind(), csv::ErrorKind::Io(error) if error.kind() == ErrorKind::FileTooLarge);
    let remedy = match too_large {
        true => "if the file is the right one, raise the limit",
        false => "the file is damaged or incomplete; copy or export it again",
    };
    Problem::new(file, place, error.to_string(), expected, remedy).into()
}

fn names(file: &Path, reader: &mut csv::Reader<Box<dyn Read>>) -> Result<Vec<String>, InputError> {
    let mut record = ByteRecord::new();
    if !reader
        .read_byte_record(&mut record)
        .map_err(|e| unreadable(file, None, &e))?
    {
        let remedy = "the file is empty; export the data again";
        return Err(Problem::new(
            file,
            Place::Line(1),
            "the end of the file",
            "a header line of column names",
            remedy,
        )
        .into());
    }
    if cells(&record).any(|name| name.contains(&b'\r')) {
        let (found, expected) = (
            "lines that end with a carriage return alone",
            "lines that end with a line feed",
        );
        let remedy = "save the file with the line ends of Windows or Unix";
        return Err(Problem::new(file, Place::Line(1), found, expected, remedy).into());
    }
    let names: Vec<String> = cells(&record)
        .map(|name| text(file, || Place::Line(1), name))
        .map(|name| Ok(unmarked(name?).to_string()))
        .collect::<Result<_, InputError>>()?;
    match names.as_slice() {
        [only] => separated_by_commas(file, only).map(|()| names),
        _ => Ok(names),
    }
}

/// Refuses a header line in which something other than commas separates the names.
fn separated_by_commas(file: &Path, only: &str) -> Result<(), InputError> {
    let separators = [(';', "semicolons"), ('\t', "tabulators"), ('|', "bars")];
    let found = separators.into_iter().find(|(separator, _)| only.contains(*separator));
    let Some((_, name)) = found else { return Ok(()) };
    let remedy = "export it with commas and decimal points; or rename it to end in .txt, which is read with any separator \
                  and with decimal commas like a file of a rig (`qcar inspect` shows its channels)";
    let (found, expected) = (
        format!("columns that are separated by {name}"),
        "commas, as in a plain table",
    );
    Err(Problem::new(file, Place::Line(1), found, expected, remedy).into())
}

/// Spreadsheets put a byte-order mark before the first name.
fn unmarked(name: &str) -> &str {
    name.trim_start_matches('\u{feff}')
}

fn text<'a>(file: &Path, place: impl Fn() -> Place, bytes: &'a [u8]) -> Result<&'a str, InputError> {
    let remedy = "save the file as UTF-8 text; a compressed file needs a name that ends in .gz";
    std::str::from_utf8(bytes)
        .map_err(|_| Problem::new(file, place(), "bytes that are not text", "UTF-8 text", remedy).into())
}

fn push(table: &mut Table, record: &ByteRecord, line: u64) -> Result<(), InputError> {
    if record.len() != table.names.len() {
        let (found, expected) = (
            format!("{} cells", record.len()),
            format!("{} as in the header line", table.names.len()),
        );
        let remedy = "complete the line; decimals take a point and columns a comma";
        return Err(Problem::new(&table.file, Place::Line(line), found, expected, remedy).into());
    }
    for (at, bytes) in cells(record).enumerate() {
        let number = number(&table.file, || Place::Cell(line, table.names[at].clone()), bytes)?;
        table.columns[at].push(number);
    }
    table.lines.push(line);
    Ok(())
}

/// Remedy for a cell that is no finite number.
fn remedy_of_cell(text: &str) -> &'static str {
    let is_missing = text.is_empty() || ["na", "n/a", "null", "-"].contains(&text.to_lowercase().as_str());
    match text.parse::<f64>() {
        Err(_) if !is_missing => "write a number such as 1000.0, without a unit, blanks or a decimal comma",
        _ => "a missing sample cannot be filled in: repair the record, or leave out the column or the run",
    }
}

fn number(file: &Path, place: impl Fn() -> Place, bytes: &[u8]) -> Result<f64, InputError> {
    if let Ok(number) = fast_float2::parse::<f64, _>(bytes)
        && number.is_finite()
    {
        return Ok(number);
    }
    let text = text(file, &place, bytes)?;
    match text.parse::<f64>() {
        Ok(number) if number.is_finite() => Ok(number),
        _ => {
            let found = if text.is_empty() {
                "an empty cell".into()
            } else {
                format!("\"{text}\"")
            };
            Err(Problem::new(file, place(), found, "a finite number", remedy_of_cell(text)).into())
        }
    }
}
