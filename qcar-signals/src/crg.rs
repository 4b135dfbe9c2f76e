//! OpenCRG, the roads of ASAM: heights on a grid along a reference line (u) and across it (v, positive to the left).
//!
//! Each longitudinal section becomes a channel, named after its place such as `v=-1.5`, whose samples are heights over the
//! channel `u`: the grid, on the height of the reference line and on its banking. Source: ASAM OpenCRG 1.2, data format.

use std::collections::HashMap;

use crate::bytes::{Number, Order, text};
use crate::error::{Fault, Place, Read};
use crate::signal::{Recording, Signal, Source, TimeBase};

/// Of the content, where a file tells what it is.
const HEAD: usize = 1 << 16;
/// Of a line of the header; what stands behind is a comment.
const RECORD: usize = 72;
/// Of a record of binary numbers, which pads the last row.
const BINARY_RECORD: usize = 80;
/// How far rounded numbers of the header may be from each other, as a share of an increment.
const ROUNDED: f64 = 1e-2;

/// Whether the head of a file has a section of road parameters.
pub(crate) fn is_crg(bytes: &[u8]) -> bool {
    let head = &bytes[..bytes.len().min(HEAD)];
    let mut lines = head.split(|&byte| byte == b'\n');
    lines.any(|line| section(&text(&line[..line.len().min(RECORD)])).as_deref() == Some("ROAD_CRG"))
}

/// Reads a road.
pub(crate) fn read(bytes: &[u8]) -> Read<Recording> {
    let header = Header::read(bytes)?;
    header.refuse_what_is_elsewhere()?;
    let format = Format::of(&header)?;
    let columns = header.columns()?;
    let grid = format.rows(&bytes[header.end..], columns.len(), &header)?;
    let line = Line::of(&header, &columns, &grid)?;
    let places = places(&header, &columns)?;
    let mut recording = Recording::new(format!("OpenCRG {}", format.name));
    let place = |at: usize| Source {
        group: String::new(),
        place: Place::Line(columns[at].line),
    };
    recording.signals.push(Signal {
        name: "u".into(),
        unit: "m".into(),
        time: TimeBase::Unknown,
        samples: line.u.clone(),
        labels: Vec::new(),
        source: Source {
            group: String::new(),
            place: Place::Item("REFERENCE_LINE_INCREMENT".into()),
        },
    });
    for (at, v) in places {
        let heights = line.height.iter().zip(&line.banking).zip(&grid[at]);
        recording.signals.push(Signal {
            name: format!("v={v}"),
            unit: "m".into(),
            time: TimeBase::Unknown,
            samples: heights.map(|((height, banking), z)| height + v * banking + z).collect(),
            labels: Vec::new(),
            source: place(at),
        });
    }
    for column in &columns {
        if column.kind == Kind::Other {
            recording.pass_over(&column.name, Place::Line(column.line), "no height of the road");
        }
    }
    Ok(recording)
}

/// The keyword of a section, in capitals; empty where one ends.
fn section(line: &str) -> Option<String> {
    let word = line.strip_prefix('$')?.split([' ', '\t', '\r', '\n', '!']).next()?;
    Some(word.to_ascii_uppercase())
}

/// The text above the data.
struct Header {
    /// Values and lines of parameters, by section and name in capitals.
    parameters: HashMap<(String, String), (f64, u64)>,
    /// Lines of the definition of the data, with their numbers.
    definition: Vec<(u64, String)>,
    /// The line of each section.
    sections: HashMap<String, u64>,
    /// Where the data begin.
    end: usize,
    /// The line before that.
    lines: u64,
}

impl Header {
    fn read(bytes: &[u8]) -> Read<Header> {
        let mut header = Header {
            parameters: HashMap::new(),
            definition: Vec::new(),
            sections: HashMap::new(),
            end: 0,
            lines: 0,
        };
        let mut current = String::new();
        for line in bytes.split_inclusive(|&byte| byte == b'\n') {
            header.end += line.len();
            header.lines += 1;
            let line = text(&line[..line.len().min(RECORD)]);
            if line.starts_with("$$") {
                return Ok(header);
            }
            if let Some(word) = section(&line) {
                header.sections.entry(word.clone()).or_insert(header.lines);
                current = word;
            } else {
                header.take(&current, &line)?;
            }
        }
        let found = "a header without the line of `$$` that ends it";
        Err(Fault::cut_off(
            Place::Line(header.lines),
            found,
            "data behind such a line",
        ))
    }

    fn take(&mut self, section: &str, line: &str) -> Read<()> {
        let line = line.split('!').next().unwrap_or_default().trim();
        if line.is_empty() || line.starts_with('*') {
            return Ok(());
        }
        match section {
            "KD_DEFINITION" => self.definition.push((self.lines, line.into())),
            "ROAD_CRG" | "ROAD_CRG_MODS" => {
                let parsed = line.split_once('=').and_then(|(name, value)| {
                    Some((name, value.trim().parse::<f64>().ok().filter(|v| v.is_finite())?))
                });
                let Some((name, value)) = parsed else {
                    let found = format!("`{line}`");
                    return Err(Fault::damaged(
                        Place::Line(self.lines),
                        found,
                        "a name, `=` and a number",
                    ));
                };
                let key = (section.into(), name.trim().to_ascii_uppercase());
                self.parameters.insert(key, (value, self.lines));
            }
            _ => {}
        }
        Ok(())
    }

    /// A parameter of the road.
    fn road(&self, name: &str) -> Option<f64> {
        Some(self.parameters.get(&("ROAD_CRG".into(), name.into()))?.0)
    }

    fn road_or_zero(&self, name: &str) -> f64 {
        self.road(name).unwrap_or(0.0)
    }

    /// Data of another file, and modifiers that change the profile.
    fn refuse_what_is_elsewhere(&self) -> Read<()> {
        if let Some(&line) = self.sections.get("ROAD_CRG_FILE") {
            let remedy = "give that file";
            return Err(Fault::new(
                Place::Line(line),
                "a reference to another file",
                "a road",
                remedy,
            ));
        }
        let scales = self.parameters.iter().filter(|((section, name), (value, _))| {
            section == "ROAD_CRG_MODS" && name.starts_with("SCALE_") && *value != 0.0 && *value != 1.0
        });
        match scales.min_by_key(|(_, (_, line))| *line) {
            None => Ok(()),
            Some(((_, name), (value, line))) => {
                let remedy = "save the road with its modifiers applied";
                Err(Fault::new(
                    Place::Line(*line),
                    format!("{name} = {value}"),
                    "heights as they are",
                    remedy,
                ))
            }
        }
    }

    /// What the columns of the data are.
    fn columns(&self) -> Read<Vec<Column>> {
        let defined = self
            .definition
            .iter()
            .filter_map(|(line, text)| Some((*line, after(text, "D:")?)));
        let columns: Vec<Column> = defined.map(|(line, text)| Column::of(line, text)).collect();
        if columns.iter().any(|column| matches!(column.kind, Kind::Section(_))) {
            return Ok(columns);
        }
        let expected = "`D:long section 1,m` and the like in $KD_DEFINITION";
        Err(Fault::damaged(Place::File, "no longitudinal section", expected))
    }

    /// Rows that the length of the reference line promises.
    fn promised(&self) -> Read<Option<f64>> {
        let (start, end, step) = (
            self.road_or_zero("REFERENCE_LINE_START_U"),
            self.road("REFERENCE_LINE_END_U"),
            self.step()?,
        );
        Ok(end
            .filter(|end| *end > start)
            .map(|end| ((end - start) / step).round() + 1.0))
    }

    fn step(&self) -> Read<f64> {
        let name = "REFERENCE_LINE_INCREMENT";
        self.road(name).filter(|step| *step > 0.0).ok_or_else(|| {
            let found = self.road(name).map_or("none".into(), |step| step.to_string());
            Fault::damaged(Place::Item(name.into()), found, "a positive number of metres")
        })
    }
}

/// What follows a prefix, whose letters may be small.
fn after<'a>(text: &'a str, prefix: &str) -> Option<&'a str> {
    let own = text.get(..prefix.len())?;
    own.eq_ignore_ascii_case(prefix).then(|| text[prefix.len()..].trim())
}

/// A column of the data.
struct Column {
    line: u64,
    name: String,
    kind: Kind,
}

#[derive(Clone, Copy, PartialEq)]
enum Kind {
    Slope,
    Banking,
    /// A longitudinal section, with its place where it states that.
    Section(Option<f64>),
    Other,
}

impl Column {
    fn of(line: u64, text: &str) -> Column {
        let name = text.split(',').next().unwrap_or_default().trim().to_string();
        let lower = name.to_lowercase();
        let stated = lower.split_once("at v =").and_then(|(_, v)| v.trim().parse().ok());
        let kind = match lower.as_str() {
            "reference line slope" => Kind::Slope,
            "reference line banking" => Kind::Banking,
            own if own.starts_with("long section") => Kind::Section(stated),
            _ => Kind::Other,
        };
        Column { line, name, kind }
    }
}

/// How numbers are stored.
struct Format {
    name: &'static str,
    stored: Stored,
}

enum Stored {
    Binary(Number),
    /// Characters of a number, and numbers of a line.
    Text(usize, usize),
}

impl Format {
    /// By the line `#:`; binary numbers of single precision without one.
    fn of(header: &Header) -> Read<Format> {
        let stated = header
            .definition
            .iter()
            .find_map(|(line, text)| Some((*line, after(text, "#:")?)));
        let (name, stored) = match stated.map(|(line, name)| (line, name.to_ascii_uppercase())) {
            None => ("KRBI", Stored::Binary(Number::F32)),
            Some((line, name)) => match name.as_str() {
                "KRBI" => ("KRBI", Stored::Binary(Number::F32)),
                "KDBI" => ("KDBI", Stored::Binary(Number::F64)),
                "LRFI" => ("LRFI", Stored::Text(10, 8)),
                "LDFI" => ("LDFI", Stored::Text(20, 4)),
                other => {
                    let remedy = "save the road in one of these formats";
                    let found = format!("the format `{other}`");
                    return Err(Fault::new(Place::Line(line), found, "KRBI, KDBI, LRFI or LDFI", remedy));
                }
            },
        };
        Ok(Format { name, stored })
    }

    /// The columns of the data.
    fn rows(&self, data: &[u8], columns: usize, header: &Header) -> Read<Vec<Vec<f64>>> {
        let grid = match self.stored {
            Stored::Binary(number) => binary(data, number, columns, header)?,
            Stored::Text(width, of_line) => written(data, (width, of_line), columns, header)?,
        };
        let rows = grid[0].len();
        match header.promised()? {
            Some(promised) if promised > rows as f64 => {
                let expected = format!("{promised} rows, as REFERENCE_LINE_END_U says");
                Err(Fault::cut_off(Place::File, format!("{rows} rows of data"), expected))
            }
            Some(promised) if promised < rows as f64 => {
                let expected = format!("{promised} rows, as REFERENCE_LINE_END_U says");
                Err(Fault::damaged(Place::File, format!("{rows} rows of data"), expected))
            }
            _ if rows < 2 => Err(Fault::cut_off(
                Place::File,
                format!("{rows} rows of data"),
                "a road of two at least",
            )),
            _ => Ok(grid),
        }
    }
}

/// Numbers one behind the other; the last record is filled up with numbers that count for nothing.
fn binary(data: &[u8], number: Number, columns: usize, header: &Header) -> Read<Vec<Vec<f64>>> {
    let row = columns * number.size();
    let promised = header.promised()?.filter(|rows| rows * row as f64 <= data.len() as f64);
    let whole = promised.map_or(data.len() / row, |rows| rows as usize);
    if promised.is_some() && data.len() - whole * row >= BINARY_RECORD {
        let place = Place::Byte((header.end + whole * row) as u64);
        return Err(Fault::damaged(
            place,
            format!("{} bytes more", data.len() - whole * row),
            "the end of the file",
        ));
    }
    let data = &data[..whole * row];
    let column = |at: usize| number.strided(data.get(at * number.size()..).unwrap_or_default(), row, Order::Big);
    let mut grid: Vec<Vec<f64>> = (0..columns).map(column).collect();
    if promised.is_none() {
        let is_filled = |row: usize| grid.iter().any(|column| !column[row].is_nan());
        let rows = (0..whole).rev().find(|&row| is_filled(row)).map_or(0, |last| last + 1);
        grid.iter_mut().for_each(|column| column.truncate(rows));
    }
    Ok(grid)
}

/// Lines of numbers of one width. Each row begins with a line of its own.
fn written(data: &[u8], (width, of_line): (usize, usize), columns: usize, header: &Header) -> Read<Vec<Vec<f64>>> {
    let mut grid = vec![Vec::new(); columns];
    let mut at = 0;
    for (line, bytes) in (header.lines + 1..).zip(data.split(|&byte| byte == b'\n')) {
        let bytes = bytes.trim_ascii_end();
        if bytes.is_empty() {
            continue;
        }
        let wanted = (columns - at).min(of_line);
        let fields: Vec<&[u8]> = bytes.chunks(width).collect();
        if fields.len() != wanted {
            let (found, expected) = (
                format!("{} numbers", fields.len()),
                format!("{wanted}, of {width} characters each"),
            );
            return Err(Fault::damaged(Place::Line(line), found, expected));
        }
        for field in fields {
            grid[at].push(value(field, line)?);
            at += 1;
        }
        at %= columns;
    }
    match at {
        0 => Ok(grid),
        _ => Err(Fault::cut_off(
            Place::File,
            format!("a last row of {at} numbers"),
            format!("{columns} numbers"),
        )),
    }
}

/// A number, or what begins with a star and stands for none.
fn value(field: &[u8], line: u64) -> Read<f64> {
    let own = text(field);
    let own = own.trim();
    if own.starts_with('*') {
        return Ok(f64::NAN);
    }
    own.parse()
        .map_err(|_| Fault::damaged(Place::Line(line), format!("`{own}`"), "a number or `*missing*`"))
}

/// The reference line: distance along it, its height and its banking.
struct Line {
    u: Vec<f64>,
    height: Vec<f64>,
    banking: Vec<f64>,
}

impl Line {
    fn of(header: &Header, columns: &[Column], grid: &[Vec<f64>]) -> Read<Line> {
        let (rows, step) = (grid[0].len(), header.step()?);
        let along = |kind: Kind, constant: &str| match columns.iter().position(|column| column.kind == kind) {
            Some(at) => grid[at].clone(),
            None => vec![header.road_or_zero(constant); rows],
        };
        let start = header.road_or_zero("REFERENCE_LINE_START_Z") + header.road_or_zero("REFERENCE_LINE_OFFSET_Z");
        // A slope leads from the row before to its own; that of the first row is not used.
        let rises = along(Kind::Slope, "REFERENCE_LINE_START_S")
            .into_iter()
            .skip(1)
            .map(|slope| slope * step);
        let mut height = vec![start];
        height.extend(rises.scan(start, |height, rise| {
            *height += rise;
            Some(*height)
        }));
        let first = header.road_or_zero("REFERENCE_LINE_START_U");
        Ok(Line {
            u: (0..rows).map(|row| first + row as f64 * step).collect(),
            height,
            banking: along(Kind::Banking, "REFERENCE_LINE_START_B"),
        })
    }
}

/// The columns of longitudinal sections with their places across the road, m.
fn places(header: &Header, columns: &[Column]) -> Read<Vec<(usize, f64)>> {
    let sections: Vec<(usize, Option<f64>)> = columns
        .iter()
        .enumerate()
        .filter_map(|(at, column)| match column.kind {
            Kind::Section(v) => Some((at, v)),
            _ => None,
        })
        .collect();
    let stated: Option<Vec<(usize, f64)>> = sections.iter().map(|(at, v)| Some((*at, (*v)?))).collect();
    let places = match stated {
        Some(stated) => stated,
        None => {
            let even = even_places(header, sections.len())?;
            sections.iter().map(|(at, _)| *at).zip(even).collect()
        }
    };
    match places.windows(2).find(|pair| pair[1].1 <= pair[0].1) {
        None => Ok(places),
        Some(pair) => {
            let found = format!("the section at v = {} m behind that at {} m", pair[1].1, pair[0].1);
            Err(Fault::damaged(
                Place::Line(columns[pair[1].0].line),
                found,
                "sections from right to left",
            ))
        }
    }
}

/// Sections at one distance from each other, of which two of right, left and increment tell all; about the middle, where
/// only the increment is known.
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
    let Some((right, step)) = found else {
        let found = format!("{count} sections whose places do not follow from the header");
        let expected = "LONG_SECTION_V_RIGHT, _LEFT and _INCREMENT that agree with each other";
        return Err(Fault::damaged(Place::Item("ROAD_CRG".into()), found, expected));
    };
    // To the micrometre: the header is written in decimals.
    Ok((0..count)
        .map(|at| ((right + at as f64 * step) * 1e6).round() / 1e6 + 0.0)
        .collect())
}
