//! Workbooks of Excel (.xlsx): tables of numbers on their sheets, and named cells.

use std::collections::{BTreeMap, HashMap};
use std::io::{Cursor, Read as _};
use std::panic::catch_unwind;

use calamine::{DataRef, Reader, Xlsx, XlsxError};
use zip::ZipArchive;

use crate::clock;
use crate::error::{Fault, Place, Read};
use crate::limit::Budget;
use crate::signal::{Recording, Scalar, Value};
use crate::table::{Cell, Column, Filled, Layout};

/// The first bytes of a ZIP file.
pub(crate) const MAGIC: &[u8] = b"PK\x03\x04";
/// The first bytes of workbooks of Excel before 2007.
pub(crate) const OLD_MAGIC: &[u8] = b"\xd0\xcf\x11\xe0";
/// The signature of the directory at the end of a ZIP file, and its largest distance from the end, bytes.
const DIRECTORY_END: (&[u8], usize) = (b"PK\x05\x06", 65_557);
/// Number of rows that are searched for the first numbers of a sheet.
const HEAD: usize = 64;
/// Largest number of columns of a sheet.
const MOST_COLUMNS: u32 = 16_384;
/// Largest number of cells of a table for each filled cell.
const MOST_EMPTY: usize = 64;

/// Refuses a workbook of a kind that is not supported.
pub(crate) fn refuse_old() -> Box<Fault> {
    let remedy = "open it in Excel and save it as .xlsx";
    Fault::new(
        Place::File,
        "a workbook of Excel before 2007 (.xls), or a document of that time",
        "an .xlsx file",
        remedy,
    )
}

/// Reads all sheets and named cells of a workbook.
pub(crate) fn read(bytes: &[u8]) -> Read<Recording> {
    let (end, within) = DIRECTORY_END;
    let tail = &bytes[bytes.len().saturating_sub(within)..];
    if !tail.windows(end.len()).any(|window| window == end) {
        let place = Place::Byte(bytes.len() as u64);
        return Err(Fault::cut_off(
            place,
            "no ZIP directory at the end",
            "a whole .xlsx file, which ends with one",
        ));
    }
    // Some sums in that crate are not checked and may panic on a damaged workbook.
    catch_unwind(|| workbook(bytes)).unwrap_or_else(|_| {
        let remedy = "open it in Excel and save it again as .xlsx";
        Err(Fault::new(
            Place::File,
            "references to cells that do not exist",
            "a workbook of Excel (.xlsx)",
            remedy,
        ))
    })
}

fn workbook(bytes: &[u8]) -> Read<Recording> {
    let budget = Budget::of_file(bytes.len() as u64);
    count_unpacked(bytes, &budget)?;
    let mut workbook: Xlsx<_> = Xlsx::new(Cursor::new(bytes)).map_err(|error| match error {
        XlsxError::FileNotFound(part) => no_workbook(&part),
        error => unreadable(Place::File, &error),
    })?;
    let mut recording = Recording::new("xlsx");
    let mut sheets = HashMap::new();
    for name in workbook.sheet_names() {
        let sheet = Sheet::read(&mut workbook, &name, &budget)?;
        sheet.add_table(&mut recording)?;
        sheets.insert(name, sheet);
    }
    if sheets.values().all(|sheet: &Sheet| sheet.rows.is_empty()) {
        recording.pass_over("workbook", Place::File, "no sheet has a cell");
    }
    for (name, reference) in workbook.defined_names() {
        let Some((sheet, row, column)) = single_cell(reference) else {
            continue;
        };
        if let Some(sheet) = sheets.get(&sheet) {
            recording.scalars.push(sheet.scalar(name, row, column));
        }
    }
    Ok(recording)
}

/// Counts what the parts of a workbook give, before any of it is kept. A damaged part is left to the reader.
fn count_unpacked(bytes: &[u8], budget: &Budget) -> Read<()> {
    let Ok(mut archive) = ZipArchive::new(Cursor::new(bytes)) else {
        return Ok(());
    };
    let mut piece = vec![0; 1 << 16];
    for index in 0..archive.len() {
        let Ok(mut part) = archive.by_index(index) else {
            continue;
        };
        let place = Place::Item(part.name().unwrap_or_default().into());
        while let Ok(count @ 1..) = part.read(&mut piece) {
            budget.count(count as u64, &place)?;
        }
    }
    Ok(())
}

fn unreadable(place: Place, error: &XlsxError) -> Box<Fault> {
    let remedy = "open it in Excel and save it again as .xlsx";
    Fault::new(
        place,
        format!("what is no workbook: {error}"),
        "a workbook of Excel (.xlsx)",
        remedy,
    )
}

/// A ZIP file that lacks a part of each workbook.
fn no_workbook(part: &str) -> Box<Fault> {
    let found = format!("a ZIP file without `{part}`");
    let remedy =
        "if it is an archive, unpack it and give a file in it; if it is a workbook, open it in Excel and save it again";
    Fault::new(Place::File, found, "a workbook of Excel (.xlsx)", remedy)
}

/// A sheet: its filled cells, by row and column from 0.
struct Sheet {
    name: String,
    rows: BTreeMap<u32, BTreeMap<u32, Cell>>,
    /// Formulas whose result was never computed.
    uncomputed: HashMap<(u32, u32), String>,
}

impl Sheet {
    fn read(workbook: &mut Xlsx<Cursor<&[u8]>>, name: &str, budget: &Budget) -> Read<Sheet> {
        let mut sheet = Sheet {
            name: name.into(),
            rows: BTreeMap::new(),
            uncomputed: HashMap::new(),
        };
        let unreadable = |error| unreadable(Place::Sheet(name.into(), "A1".into()), &error);
        let mut cells = match workbook.worksheet_cells_reader(name) {
            Ok(cells) => cells,
            // A sheet that is a chart has no cells.
            Err(XlsxError::NotAWorksheet(_)) => return Ok(sheet),
            Err(error) => return Err(unreadable(error)),
        };
        while let Some(cell) = cells.next_cell_with_formula().map_err(unreadable)? {
            let (row, column) = cell.pos;
            if column >= MOST_COLUMNS {
                let found = format!("a cell in column {}", u64::from(column) + 1);
                let place = Place::Sheet(name.into(), format!("row {}", u64::from(row) + 1));
                return Err(Fault::damaged(
                    place,
                    found,
                    format!("at most {MOST_COLUMNS} columns, as Excel allows"),
                ));
            }
            let value = match cell.value {
                DataRef::Int(number) => Cell::Number(number as f64),
                DataRef::Float(number) => Cell::Number(number),
                DataRef::Bool(flag) => Cell::Number(f64::from(u8::from(flag))),
                DataRef::String(text) if !text.trim().is_empty() => Cell::Text(text),
                DataRef::SharedString(text) if !text.trim().is_empty() => Cell::Text(text.into()),
                DataRef::DateTimeIso(text) => clock::seconds(&text).map_or(Cell::Text(text), Cell::Stamp),
                DataRef::DurationIso(text) => Cell::Text(text),
                DataRef::DateTime(time) => Cell::Stamp(time.as_f64() * clock::DAY),
                DataRef::Error(_) => Cell::Missing,
                _ => {
                    if let Some(formula) = cell.formula {
                        sheet.uncomputed.insert((row, column), formula);
                        sheet.rows.entry(row).or_default().insert(column, Cell::Uncomputed);
                    }
                    continue;
                }
            };
            // Any number of cells may refer to one long text.
            if let Cell::Text(text) = &value {
                budget.count(text.len() as u64, &sheet.place(row, column))?;
            }
            sheet.rows.entry(row).or_default().insert(column, value);
        }
        Ok(sheet)
    }

    fn place(&self, row: u32, column: u32) -> Place {
        Place::Sheet(self.name.clone(), cell_name(row, column))
    }

    /// Adds the columns of the table of the sheet, if it has one. A row without cells ends it.
    fn add_table(&self, recording: &mut Recording) -> Read<()> {
        let head: Vec<Vec<Cell>> = self.rows.values().take(HEAD).map(dense).collect();
        let numbers: Vec<u32> = self.rows.keys().copied().collect();
        let Some(layout) = Layout::find(&head) else {
            if !self.rows.is_empty() {
                let (place, why) = self.no_table();
                recording.pass_over(&self.name, place, why);
            }
            return Ok(());
        };
        let first = numbers[layout.first];
        let count = numbers[layout.first..]
            .iter()
            .zip(first..)
            .take_while(|(row, expected)| *row == expected)
            .count();
        let filled: usize = self.rows.range(first..).take(count).map(|(_, row)| row.len()).sum();
        if count * layout.columns.len() > MOST_EMPTY * filled {
            let found = format!(
                "{count} rows of {} columns with {filled} cells in them",
                layout.columns.len()
            );
            return Err(Fault::damaged(self.place(first, 0), found, "a table that is filled"));
        }
        let filled = self.fill(layout.columns, first, count)?;
        if let Some(&below) = numbers.get(layout.first + count) {
            let place = self.place(below, 0);
            recording.pass_over(&self.name, place, "the cells below the table, after an empty row");
        }
        filled.add_to(recording, &self.name, &|column, row| {
            let row = row.map_or(first.saturating_sub(1), |row| first + row as u32);
            self.place(row, column.index as u32)
        })
    }

    /// Why the sheet has no table, with the cell that shows it.
    fn no_table(&self) -> (Place, String) {
        let texts = self.rows.iter().flat_map(|(row, cells)| {
            let cell = move |(column, cell): (&u32, &Cell)| match cell {
                Cell::Text(text) => Some(((*row, *column), text.clone())),
                _ => None,
            };
            cells.iter().filter_map(cell)
        });
        let is_number = |text: &str| text.trim().replace(',', ".").parse().is_ok_and(f64::is_finite);
        let mut numbers = texts.filter(|(_, text)| is_number(text));
        match numbers.next() {
            Some(((row, column), text)) => {
                let why = format!("no table of numbers, but numbers as texts, such as `{text}`: convert them in Excel");
                (self.place(row, column), why)
            }
            None => (self.place(0, 0), "no table of numbers".into()),
        }
    }

    fn fill(&self, columns: Vec<Column>, first: u32, count: usize) -> Read<Filled> {
        let mut numbers = vec![Vec::with_capacity(count); columns.len()];
        for (row, cells) in self.rows.range(first..).take(count) {
            for (column, numbers) in columns.iter().zip(&mut numbers) {
                let index = column.index as u32;
                let found = match (cells.get(&index), self.uncomputed.get(&(*row, index))) {
                    (Some(Cell::Number(number)), _) if !column.stamped => {
                        numbers.push(*number);
                        continue;
                    }
                    (Some(Cell::Stamp(seconds)), _) if column.stamped => {
                        numbers.push(*seconds);
                        continue;
                    }
                    (Some(Cell::Number(number)), _) => format!("the number {number} among dates and times"),
                    (Some(Cell::Stamp(_)), _) => "a date or a time among numbers".into(),
                    (_, Some(formula)) => format!("the formula `={formula}` without a result"),
                    (Some(Cell::Text(text)), _) => format!("the text `{text}`"),
                    (Some(Cell::Missing | Cell::Uncomputed) | None, None) => {
                        numbers.push(f64::NAN);
                        continue;
                    }
                };
                let remedy = "write a number, leave the cell empty, or open and save the file in Excel to compute it";
                return Err(Fault::new(self.place(*row, index), found, "a number", remedy).of(&column.name));
            }
        }
        Ok(Filled { columns, numbers })
    }

    /// A named cell; its unit is the text to the right of it.
    fn scalar(&self, name: &str, row: u32, column: u32) -> Scalar {
        let cell = |column: u32| self.rows.get(&row).and_then(|cells| cells.get(&column));
        let unit = match cell(column + 1) {
            Some(Cell::Text(text)) => text.trim().into(),
            _ => String::new(),
        };
        let value = match (cell(column), self.uncomputed.get(&(row, column))) {
            (Some(Cell::Number(number)), _) => Value::Number(*number),
            (Some(Cell::Text(text)), _) => Value::Text(text.clone()),
            (Some(Cell::Stamp(_)), _) => Value::Text("a date or a time".into()),
            (_, Some(formula)) => Value::Formula(formula.clone()),
            (_, None) => Value::Empty,
        };
        Scalar {
            name: name.into(),
            unit,
            value,
            place: self.place(row, column),
        }
    }
}

/// A row including its empty cells, up to the last filled one.
fn dense(row: &BTreeMap<u32, Cell>) -> Vec<Cell> {
    let width = row.keys().next_back().map_or(0, |last| *last as usize + 1);
    let mut cells = vec![Cell::Missing; width];
    for (column, cell) in row {
        cells[*column as usize] = cell.clone();
    }
    cells
}

/// The name of a cell in Excel: B7 for row 6 and column 1, counted from 0.
fn cell_name(row: u32, mut column: u32) -> String {
    let mut letters = Vec::new();
    loop {
        letters.push(char::from(b'A' + (column % 26) as u8));
        match column / 26 {
            0 => break,
            next => column = next - 1,
        }
    }
    format!("{}{}", letters.iter().rev().collect::<String>(), u64::from(row) + 1)
}

/// Sheet, row and column of a reference such as `'Front axle'!$C$3`.
fn single_cell(reference: &str) -> Option<(String, u32, u32)> {
    let (sheet, cell) = reference.rsplit_once('!')?;
    let sheet = sheet
        .strip_prefix('\'')
        .and_then(|sheet| sheet.strip_suffix('\''))
        .unwrap_or(sheet);
    let cell = cell.replace('$', "");
    let digits = cell.find(|c: char| c.is_ascii_digit())?;
    let (letters, row) = cell.split_at(digits);
    let value = |letter: u8| letter.is_ascii_uppercase().then(|| u32::from(letter - b'A') + 1);
    let column = letters
        .bytes()
        .try_fold(0_u32, |all, letter| all.checked_mul(26)?.checked_add(value(letter)?))?;
    Some((
        sheet.replace("''", "'"),
        row.parse::<u32>().ok()?.checked_sub(1)?,
        column.checked_sub(1)?,
    ))
}

#[cfg(test)]
mod tests {
    use super::{cell_name, single_cell};

    #[test]
    fn cells_are_named_as_excel_names_them() {
        for (row, column, name) in [
            (0, 0, "A1"),
            (6, 25, "Z7"),
            (0, 26, "AA1"),
            (99, 701, "ZZ100"),
            (0, 702, "AAA1"),
        ] {
            assert_eq!(cell_name(row, column), name);
            assert_eq!(
                single_cell(&format!("'a b'!${name}")),
                Some(("a b".into(), row, column))
            );
        }
        assert_eq!(single_cell("Vehicle!$A$6:$D$86"), None);
    }
}
