//! The meaning of the data columns, and their positions across the road.

use crate::error::{Fault, Place, Read};

use super::header::{Header, ROUNDED};

/// A column of the data.
pub(super) struct Column {
    pub line: u64,
    pub name: String,
    pub kind: Kind,
}

#[derive(Clone, Copy, PartialEq)]
pub(super) enum Kind {
    Slope,
    Banking,
    /// A longitudinal section at its position, m.
    At(f64),
    /// A longitudinal section with its number, counted from the right from 1.
    Numbered,
    Other,
}

/// The columns in their order.
pub(super) fn columns(header: &Header) -> Read<Vec<Column>> {
    let mut columns: Vec<Column> = Vec::new();
    let mut next = 1;
    for (line, text) in header.defined("D:") {
        let column = Column::of(line, text, next)?;
        next += usize::from(column.kind == Kind::Numbered);
        columns.push(column);
    }
    let [stated, numbered] = [true, false].map(|stated| {
        columns.iter().find(|column| match column.kind {
            Kind::At(_) => stated,
            Kind::Numbered => !stated,
            _ => false,
        })
    });
    match (stated, numbered) {
        (None, None) => {
            let expected = "`D:long section 1,m` and the like in $KD_DEFINITION";
            Err(Fault::damaged(Place::File, "no longitudinal section", expected))
        }
        (Some(stated), Some(numbered)) => {
            let found = format!("`{}` beside `{}`", numbered.name, stated.name);
            let expected = "sections that all have their place, or are all numbered";
            Err(Fault::damaged(Place::Line(numbered.line), found, expected))
        }
        _ => Ok(columns),
    }
}

impl Column {
    /// Reads the definition of a column; a numbered section must have the number `next`.
    fn of(line: u64, text: &str, next: usize) -> Read<Column> {
        let mut parts = text.split(',').map(str::trim);
        let (name, unit) = (parts.next().unwrap_or_default(), parts.next().unwrap_or_default());
        let lower = name.to_lowercase();
        let words: Vec<&str> = lower.split_whitespace().collect();
        let wrong = |found: String, expected: String| Err(Fault::damaged(Place::Line(line), found, expected));
        let (kind, wanted) = match words[..] {
            ["reference", "line", "slope"] => (Kind::Slope, "m/m"),
            ["reference", "line", "banking"] => (Kind::Banking, "m/m"),
            ["long", "section", "at", "v", "=", v] => match v.parse() {
                Ok(v) if f64::is_finite(v) => (Kind::At(v), "m"),
                _ => return wrong(format!("`{name}`"), "the place of the section, m".into()),
            },
            ["long", "section", number] if number.parse() == Ok(next) => (Kind::Numbered, "m"),
            ["long", "section", ..] => {
                let expected = format!("`long section {next}` or `long section at v = ...`");
                return wrong(format!("`{name}`"), expected);
            }
            _ => (Kind::Other, unit),
        };
        match unit == wanted {
            false => wrong(format!("the unit `{unit}` of `{name}`"), format!("`{wanted}`")),
            true => {
                let name = name.into();
                Ok(Column { line, name, kind })
            }
        }
    }
}

/// The columns of longitudinal sections with their positions across the road, m.
pub(super) fn places(header: &Header, columns: &[Column]) -> Read<Vec<(usize, f64)>> {
    let stated = columns.iter().enumerate().filter_map(|(at, column)| match column.kind {
        Kind::At(v) => Some((at, v)),
        _ => None,
    });
    let mut places: Vec<(usize, f64)> = stated.collect();
    if places.is_empty() {
        let numbered: Vec<usize> = (0..columns.len())
            .filter(|&at| columns[at].kind == Kind::Numbered)
            .collect();
        places = numbered
            .iter()
            .copied()
            .zip(even_places(header, numbered.len())?)
            .collect();
    }
    match places.windows(2).find(|pair| pair[1].1 <= pair[0].1) {
        None => Ok(places),
        Some(pair) => {
            let found = format!("the section at v = {} m after that at {} m", pair[1].1, pair[0].1);
            Err(Fault::damaged(
                Place::Line(columns[pair[1].0].line),
                found,
                "sections from right to left",
            ))
        }
    }
}

/// Positions of equidistant sections, from two of the right end, the left end and the increment. If only the increment
/// is known, they are symmetric about the reference line.
fn even_places(header: &Header, count: usize) -> Read<Vec<f64>> {
    let of = |name: &str| header.road(&format!("LONG_SECTION_V_{name}"));
    let (right, left, step) = (of("RIGHT"), of("LEFT"), of("INCREMENT"));
    let gaps = (count - 1) as f64;
    let found = match (right, left, step) {
        (Some(right), Some(left), Some(step)) if (left - right - gaps * step).abs() > ROUNDED * step.abs() => None,
        (Some(right), Some(left), _) => Some((right, (left - right) / gaps.max(1.0))),
        (Some(right), None, Some(step)) => Some((right, step)),
        (None, Some(left), Some(step)) => Some((left - gaps * step, step)),
        (None, None, Some(step)) => Some((-0.5 * gaps * step, step)),
        _ => None,
    };
    // Rounded to the micrometre, since the header is written in decimals.
    let place = |right: f64, step: f64, at: usize| ((right + at as f64 * step) * 1e6).round() / 1e6 + 0.0;
    let places = found.map(|(right, step)| (0..count).map(|at| place(right, step, at)).collect::<Vec<f64>>());
    let places = places.filter(|places| places.iter().all(|v| v.is_finite()));
    places.ok_or_else(|| {
        let found = format!("{count} sections whose places do not follow from the header");
        let expected = "LONG_SECTION_V_RIGHT, _LEFT and _INCREMENT that agree with each other";
        Fault::damaged(Place::Item("ROAD_CRG".into()), found, expected)
    })
}
