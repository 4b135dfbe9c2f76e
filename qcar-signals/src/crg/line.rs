//! The reference line.

use crate::error::{Fault, Place, Read};

use super::columns::{Column, Kind};
use super::header::{Distances, Header};

/// Largest difference between equal slopes of the header, which is written in decimals.
const SAME_SLOPE: f64 = 1e-6;

/// The reference line: distance along it, its height and its banking.
pub(super) struct Line {
    pub u: Vec<f64>,
    pub height: Vec<f64>,
    pub banking: Vec<f64>,
}

impl Line {
    pub fn of(header: &Header, columns: &[Column], grid: &[Vec<f64>]) -> Read<Line> {
        let rows = grid[0].len();
        let Distances { start: first, step } = header.distances()?;
        let along =
            |kind: Kind, letter: &str, unused: usize| match columns.iter().position(|column| column.kind == kind) {
                Some(at) => whole(&columns[at], &grid[at], unused),
                None => Ok(vec![constant(header, letter)?; rows]),
            };
        let start = header.road_or_zero("REFERENCE_LINE_START_Z") + header.road_or_zero("REFERENCE_LINE_OFFSET_Z");
        // A slope is that from the previous row to its own row; the slope of the first row is not used.
        let rises = along(Kind::Slope, "S", 1)?
            .into_iter()
            .skip(1)
            .map(|slope| slope * step);
        let mut height = vec![start];
        height.extend(rises.scan(start, |height, rise| {
            *height += rise;
            Some(*height)
        }));
        Ok(Line {
            u: (0..rows).map(|row| first + row as f64 * step).collect(),
            height,
            banking: along(Kind::Banking, "B", 0)?,
        })
    }
}

/// A column of the reference line, which needs a value in every row except the first `unused` ones.
fn whole(column: &Column, samples: &[f64], unused: usize) -> Read<Vec<f64>> {
    match samples.iter().skip(unused).position(|value| !value.is_finite()) {
        None => Ok(samples.to_vec()),
        Some(at) => {
            let found = format!("no value in row {} of `{}`", at + unused + 1, column.name);
            let expected = "a reference line without gaps";
            Err(Fault::damaged(Place::Line(column.line), found, expected))
        }
    }
}

/// A slope that is constant along the line; zero if none is stated.
fn constant(header: &Header, letter: &str) -> Read<f64> {
    let start = header.road_or_zero(&format!("REFERENCE_LINE_START_{letter}"));
    let name = format!("REFERENCE_LINE_END_{letter}");
    match header.stated(&name) {
        Some((end, line)) if (end - start).abs() > SAME_SLOPE => {
            let found = format!("{name} = {end}, and {start} at the start");
            let expected = "a column of the data that leads from one to the other";
            Err(Fault::damaged(Place::Line(line), found, expected))
        }
        _ => Ok(start),
    }
}
