//! Contents of a table in any format: headings, then names and units, then columns of numbers.

use crate::clock::since_first;
use crate::error::{Fault, Place, Read};
use crate::signal::{Recording, Signal, Source, TimeBase};
use crate::units::{bare, in_seconds, is_time, is_unit, name_and_unit, seconds};

/// A cell of a table.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Cell {
    /// Empty, or a text for a missing value.
    Missing,
    Number(f64),
    /// A date or a clock time, s.
    Stamp(f64),
    /// A formula whose result was never computed.
    Uncomputed,
    Text(String),
}

/// Start and columns of the numbers.
pub(crate) struct Layout {
    /// First row of numbers, counted in the scanned rows.
    pub(crate) first: usize,
    /// Name and unit of each column that has numbers, with the index of the column.
    pub(crate) columns: Vec<Column>,
}

/// A column of numbers.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Column {
    pub(crate) index: usize,
    pub(crate) name: String,
    pub(crate) unit: String,
    /// True if its cells are dates or clock times.
    pub(crate) stamped: bool,
}

impl Layout {
    /// Finds the numbers of a table from its upper rows; `None` if there are none.
    pub(crate) fn find(head: &[Vec<Cell>]) -> Option<Layout> {
        let first = (0..head.len()).find(|&row| {
            let rows = &head[row..(row + 2).min(head.len())];
            let width = numbers(&head[row]);
            width > 0 && rows.iter().all(|row| is_data(row) && 2 * numbers(row) >= width)
        })?;
        // A column may begin with missing values.
        let body = &head[first..];
        let body = &body[..body.iter().position(|row| !is_data(row)).unwrap_or(body.len())];
        let width = body.iter().map(|row| filled_width(row)).max()?;
        let spoilt = head[..first].iter().rev().take_while(|row| is_begun(row, width));
        let first = first - spoilt.count();
        let headings = Headings::above(&head[..first], width);
        let columns = (0..width).filter_map(|index| headings.column(index, body));
        Some(Layout {
            first,
            columns: columns.collect(),
        })
    }
}

/// The rows with the names of the columns.
struct Headings<'a> {
    names: Option<&'a [Cell]>,
    units: Option<&'a [Cell]>,
}

impl<'a> Headings<'a> {
    fn above(rows: &'a [Vec<Cell>], width: usize) -> Self {
        let mut above = rows.iter().rev().map(Vec::as_slice);
        let (nearest, next) = (above.next().filter(|row| texts(row) > 0), above.next());
        let over_units =
            |units: &[Cell]| next.filter(|names| texts(names) >= texts(units).max(width.min(2)) && are_units(units));
        match nearest {
            Some(units) if over_units(units).is_some() => Headings {
                names: next,
                units: nearest,
            },
            _ => Headings {
                names: nearest,
                units: None,
            },
        }
    }

    fn column(&self, index: usize, body: &[Vec<Cell>]) -> Option<Column> {
        let text = |row: Option<&[Cell]>| match row?.get(index)? {
            Cell::Text(text) => Some(text.clone()),
            Cell::Number(number) => Some(number.to_string()),
            Cell::Missing | Cell::Stamp(_) | Cell::Uncomputed => None,
        };
        let named = text(self.names);
        let first = body
            .iter()
            .filter_map(|row| row.get(index))
            .find(|cell| **cell != Cell::Missing);
        if named.is_none() && first.is_none() {
            return None;
        }
        let stamped = matches!(first, Some(Cell::Stamp(_)));
        let (name, unit) = match (named, text(self.units)) {
            (Some(name), Some(unit)) => (name.trim().into(), bare(&unit).into()),
            (Some(heading), None) => name_and_unit(&heading),
            (None, unit) => (format!("column {}", index + 1), unit.unwrap_or_default()),
        };
        Some(Column {
            index,
            name,
            unit,
            stamped,
        })
    }
}

fn numbers(row: &[Cell]) -> usize {
    row.iter().filter(|cell| matches!(cell, Cell::Number(_))).count()
}

fn texts(row: &[Cell]) -> usize {
    row.iter().filter(|cell| matches!(cell, Cell::Text(_))).count()
}

fn is_data(row: &[Cell]) -> bool {
    numbers(row) > 0 && texts(row) == 0
}

/// True for a row directly above the numbers that is itself one of them, with a cell that cannot be read, such as `OVLD`
/// in the first sample. It must be reported, and not become the names of the columns.
fn is_begun(row: &[Cell], width: usize) -> bool {
    let begins = matches!(row.first(), Some(Cell::Number(_) | Cell::Stamp(_)));
    begins && filled_width(row) == width && (texts(row) == 0 || !are_units(row))
}

fn filled_width(row: &[Cell]) -> usize {
    row.iter()
        .rposition(|cell| *cell != Cell::Missing)
        .map_or(0, |last| last + 1)
}

/// True for a row of units: in brackets, or mostly known ones; no cell is longer than a unit.
fn are_units(row: &[Cell]) -> bool {
    let texts: Vec<&str> = row
        .iter()
        .filter_map(|cell| match cell {
            Cell::Text(text) => Some(text.trim()),
            _ => None,
        })
        .collect();
    let bracketed = |text: &&&str| bare(text) != **text;
    let known = texts.iter().filter(|text| is_unit(text)).count();
    texts.iter().all(|text| text.chars().count() <= 20)
        && (texts.iter().filter(bracketed).count() == texts.len() || 2 * known > texts.len())
}

/// The columns of a table with their numbers.
pub(crate) struct Filled {
    pub(crate) columns: Vec<Column>,
    /// One vector for each of `columns`, all of one length.
    pub(crate) numbers: Vec<Vec<f64>>,
}

impl Filled {
    /// Adds the columns to a recording. A column of times is the time base of the others; `place` gives the position of
    /// a column, or of a row in it.
    pub(crate) fn add_to(
        mut self,
        recording: &mut Recording,
        group: &str,
        place: &dyn Fn(&Column, Option<usize>) -> Place,
    ) -> Read<()> {
        let mut time = TimeBase::Unknown;
        let is_stamped = |column: &Column| column.stamped;
        let named = self.columns.iter().position(|column| is_time(&column.name));
        if let Some(at) = named.or_else(|| self.columns.iter().rposition(is_stamped)) {
            let (column, times) = (self.columns.remove(at), self.numbers.remove(at));
            time = time_base(&column, times, place)?;
        }
        for column in self.columns.iter().filter(|column| column.stamped) {
            let why = "dates and clock times that are not the times of the rows";
            recording.pass_over(&column.name, place(column, None), why);
        }
        let channels = self.columns.into_iter().zip(self.numbers);
        for (column, samples) in channels.filter(|(column, _)| !column.stamped) {
            let place = place(&column, None);
            recording.signals.push(Signal {
                name: column.name,
                unit: column.unit,
                time: time.clone(),
                samples: samples.into(),
                labels: Vec::new(),
                source: Source {
                    group: group.into(),
                    place,
                },
            });
        }
        Ok(())
    }
}

fn time_base(column: &Column, mut times: Vec<f64>, place: &dyn Fn(&Column, Option<usize>) -> Place) -> Read<TimeBase> {
    if column.stamped {
        since_first(&mut times);
    }
    let Some(factor) = seconds(&column.unit).or(column.stamped.then_some(1.0)) else {
        let found = format!("times in `{}`", column.unit);
        let remedy = "give the time in one of these units";
        return Err(Fault::new(place(column, None), found, "s, ms, us, ns, min or h", remedy).of(&column.name));
    };
    if !column.stamped {
        in_seconds(&mut times, factor);
    }
    TimeBase::from_times(times).map_err(|(row, found)| {
        let remedy = "correct the row, or rename the column if it holds no times";
        Fault::new(place(column, Some(row)), found, "times that never decrease", remedy).of(&column.name)
    })
}
