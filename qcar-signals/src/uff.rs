//! UFF, the Universal File Format of SDRC: datasets between lines of -1. Functions over time are in datasets 58 (text)
//! and 58b (binary); dataset 164 gives the units of the file.
//!
//! Source: the definitions of the datasets that the University of Cincinnati publishes.

use std::str::FromStr;

use memchr::memchr;

use crate::bytes::{Number, Order, text};
use crate::error::{Fault, Place, Read, whole_before};
use crate::signal::{Recording, Signal, Source, TimeBase, evenly};

/// True if a file begins like UFF: a line of -1, then the number of a dataset.
pub(crate) fn is_uff(bytes: &[u8]) -> bool {
    let mut lines = Lines { bytes, at: 0 };
    lines.filled().is_some_and(|line| line.is_border()) && lines.next().is_some_and(|line| Header::of(line).is_some())
}

/// Reads all datasets of a file.
pub(crate) fn read(bytes: &[u8]) -> Read<Recording> {
    let mut recording = Recording::new("UFF 58");
    let mut lines = Lines { bytes, at: 0 };
    let mut units = Units { length: "", force: "" };
    while let Some(line) = lines.filled() {
        let header = if line.is_border() { lines.next() } else { None };
        let Some(header) = header.and_then(Header::of) else {
            let found = format!("`{}`", line.text().trim().chars().take(40).collect::<String>());
            let expected = "a line of -1 and the number of a dataset";
            return Err(Fault::damaged(line.place(), found, expected));
        };
        let place = line.place();
        match header.number {
            58 => function(&mut recording, &mut lines, &header, &units, place)?,
            number => {
                let mut content = lines.until_border(&format!("dataset {number}"))?;
                match number {
                    164 => units = Units::of(content.next()),
                    151 => {}
                    _ => recording.pass_over(format!("dataset {number}"), place, description_of(number)),
                }
            }
        }
    }
    if recording.signals.is_empty() && recording.passed_over.is_empty() {
        let remedy = "export the functions over time too; if they were there, the file was cut off: copy it again";
        let found = "no dataset 58";
        return Err(Fault::new(
            lines.end(),
            found,
            "measured functions in datasets 58 or 58b",
            remedy,
        ));
    }
    Ok(recording)
}

fn description_of(number: u32) -> &'static str {
    match number {
        15 | 2411 => "nodes of a geometry, no measured function",
        18 | 2420 => "coordinate systems of a geometry, no measured function",
        82 | 2412 => "lines of a geometry, no measured function",
        55 | 2414 => "shapes, no measured function over time",
        _ => "no measured function",
    }
}

/// A line without its end.
#[derive(Clone, Copy)]
struct Line<'a> {
    /// Position of its first byte.
    at: u64,
    bytes: &'a [u8],
}

impl Line<'_> {
    fn place(&self) -> Place {
        Place::Byte(self.at)
    }

    fn text(&self) -> String {
        text(self.bytes).into()
    }

    fn is_border(&self) -> bool {
        self.bytes.trim_ascii() == b"-1"
    }
}

/// The lines from a byte on.
struct Lines<'a> {
    bytes: &'a [u8],
    at: usize,
}

impl<'a> Iterator for Lines<'a> {
    type Item = Line<'a>;

    fn next(&mut self) -> Option<Line<'a>> {
        let start = self.at;
        let rest = self.bytes.get(start..).filter(|rest| !rest.is_empty())?;
        let length = memchr(b'\n', rest);
        self.at = start + length.map_or(rest.len(), |length| length + 1);
        let line = &rest[..length.unwrap_or(rest.len())];
        Some(Line {
            at: start as u64,
            bytes: line.strip_suffix(b"\r").unwrap_or(line),
        })
    }
}

impl<'a> Lines<'a> {
    /// The next line that is not empty.
    fn filled(&mut self) -> Option<Line<'a>> {
        self.find(|line| !line.bytes.trim_ascii().is_empty())
    }

    /// The lines up to the next border; the border is skipped.
    fn until_border(&mut self, what: &str) -> Read<Lines<'a>> {
        let at = self.at;
        match self.find(Line::is_border) {
            Some(border) => Ok(Lines {
                bytes: &self.bytes[..border.at as usize],
                at,
            }),
            None => Err(self.cut(format!("{what} without the line of -1 that ends it"))),
        }
    }

    fn needed(&mut self, what: &str) -> Read<Line<'a>> {
        self.next().ok_or_else(|| self.cut(format!("no {what}")))
    }

    fn end(&self) -> Place {
        Place::Byte(self.bytes.len() as u64)
    }

    fn cut(&self, found: String) -> Box<Fault> {
        Fault::cut_off(self.end(), found, "whole datasets")
    }
}

/// The first line of a dataset: number 6, then for a binary one `b` 1, byte order 6, kind of numbers 6, lines of text
/// 12, bytes 12.
struct Header {
    number: u32,
    binary: Option<Binary>,
}

struct Binary {
    order: Order,
    ieee: bool,
    bytes: u64,
}

impl Header {
    fn of(line: Line) -> Option<Header> {
        let line = line.text();
        let number = columns(&line, 0, 6).parse().ok()?;
        let binary = (columns(&line, 6, 7) == "b").then(|| Binary {
            order: if columns(&line, 7, 13) == "2" {
                Order::Big
            } else {
                Order::Little
            },
            ieee: columns(&line, 13, 19) == "2",
            bytes: columns(&line, 31, 43).parse().unwrap_or(0),
        });
        Some(Header { number, binary })
    }
}

/// Characters of a line from a column to another.
fn columns(line: &str, from: usize, to: usize) -> &str {
    let byte = |place: usize| line.char_indices().nth(place).map_or(line.len(), |(byte, _)| byte);
    line[byte(from)..byte(to)].trim()
}

/// The integer in columns of a line.
fn integer<T: FromStr>(line: Line, from: usize, to: usize, what: &str) -> Read<T> {
    let parsed = columns(&line.text(), from, to).parse();
    parsed.map_err(|_| no_number(line, from, to, what))
}

/// The number in columns of a line, which are bytes; exponents may be written with D.
fn number(line: Line, from: usize, to: usize, what: &str) -> Read<f64> {
    let field = &line.bytes[from.min(line.bytes.len())..to.min(line.bytes.len())];
    let other = || text(field).trim().replace(['D', 'd'], "e").parse().ok();
    let parsed = fast_float2::parse(field.trim_ascii()).ok().or_else(other);
    parsed.ok_or_else(|| no_number(line, from, to, what))
}

fn no_number(line: Line, from: usize, to: usize, what: &str) -> Box<Fault> {
    let found = format!("`{}` in columns {} to {to}", columns(&line.text(), from, to), from + 1);
    Fault::damaged(line.place(), found, what)
}

/// Units of a file, for functions that state none.
struct Units {
    length: &'static str,
    force: &'static str,
}

impl Units {
    fn of(first: Option<Line>) -> Units {
        let line = first.map_or_else(String::new, |line| line.text());
        let (length, force) = match columns(&line, 0, 10) {
            "1" => ("m", "N"),
            "2" => ("ft", "lbf"),
            "3" => ("m", "kgf"),
            "4" => ("ft", "pdl"),
            "5" => ("mm", "mN"),
            "6" => ("cm", "cN"),
            "7" => ("in", "lbf"),
            "8" => ("mm", "kgf"),
            "10" => ("mm", "N"),
            _ => ("", ""),
        };
        Units { length, force }
    }

    /// The unit of a specific type of data: displacement, force, velocity, acceleration.
    fn unit(&self, kind: u32) -> String {
        match (kind, self.length, self.force) {
            (8, length, _) => length.into(),
            (9 | 13, _, force) => force.into(),
            (11 | 12, "", _) => String::new(),
            (11, length, _) => format!("{length}/s"),
            (12, length, _) => format!("{length}/s^2"),
            _ => String::new(),
        }
    }
}

/// The eleven lines of a function.
struct Function {
    name: String,
    point: String,
    kind: u32,
    over_time: bool,
    complex: bool,
    double: bool,
    even: bool,
    count: u64,
    start: f64,
    step: f64,
    unit: String,
    time_unit: String,
}

fn function(recording: &mut Recording, lines: &mut Lines, header: &Header, units: &Units, place: Place) -> Read<()> {
    let function = Function::read(lines, units)?;
    let whole = recording.signals.len();
    let numbers = match &header.binary {
        Some(binary) => function.binary(lines, binary),
        None => function.ascii(lines),
    };
    let (times, samples) = numbers.map_err(|mut fault| {
        fault.found += &whole_before(whole, "function");
        fault.of(&function.name)
    })?;
    if function.complex || !function.over_time {
        let over = if function.complex {
            "complex values"
        } else {
            "a function of something else than time"
        };
        recording.pass_over(
            function.name,
            place,
            format!("{over} (function type {})", function.kind),
        );
        return Ok(());
    }
    let seconds = crate::units::seconds(&function.time_unit).unwrap_or(1.0);
    let time = match times {
        None => evenly(function.start * seconds, function.step * seconds, place.clone()),
        Some(mut times) => {
            crate::units::in_seconds(&mut times, seconds);
            TimeBase::from_times(times)
                .map_err(|(at, found)| Fault::damaged(place.clone(), format!("{found} in sample {}", at + 1), "times"))
        }
    };
    recording.signals.push(Signal {
        time: time.map_err(|fault| fault.of(&function.name))?,
        name: function.name,
        unit: function.unit,
        samples: samples.into(),
        labels: Vec::new(),
        source: Source {
            group: function.point,
            place,
        },
    });
    Ok(())
}

type Numbers = (Option<Vec<f64>>, Vec<f64>);

impl Function {
    fn read(lines: &mut Lines, units: &Units) -> Read<Function> {
        let name = lines.needed("name of a function")?;
        for _ in 0..4 {
            lines.needed("description of a function")?;
        }
        let freedom = lines.needed("degree of freedom")?;
        let form = lines.needed("form of the data")?;
        let axis = lines.needed("axis of a function")?;
        let values = lines.needed("unit of a function")?;
        lines.needed("denominator of a function")?;
        lines.needed("third axis of a function")?;
        let data: u32 = integer(form, 0, 10, "the type of the values")?;
        if !matches!(data, 2 | 4 | 5 | 6) {
            let found = format!("values of type {data}");
            return Err(Fault::damaged(form.place(), found, "type 2, 4, 5 or 6"));
        }
        let abscissa: u32 = integer(axis, 0, 10, "the kind of the axis")?;
        let kind = integer(freedom, 0, 5, "the type of the function")?;
        let meaning = integer(values, 0, 10, "the kind of the values")?;
        let unit = match columns(&values.text(), 47, 67) {
            "" | "NONE" => units.unit(meaning),
            unit => unit.to_string(),
        };
        Ok(Function {
            name: name.text().trim().into(),
            point: point(&freedom.text()),
            kind,
            over_time: abscissa == 17 || (abscissa == 0 && kind == 1),
            complex: data > 4,
            double: matches!(data, 4 | 6),
            even: integer::<u32>(form, 20, 30, "the spacing")? == 1,
            count: integer(form, 10, 20, "the number of values")?,
            start: number(form, 30, 43, "the first time")?,
            step: number(form, 43, 56, "the time step")?,
            unit,
            time_unit: columns(&axis.text(), 47, 67).replace("NONE", ""),
        })
    }

    /// The values after the text of a binary dataset. Uneven times are of single precision, unless the declared size
    /// shows otherwise.
    fn binary(&self, lines: &mut Lines, binary: &Binary) -> Read<Numbers> {
        let place = Place::Byte(lines.at as u64);
        if !binary.ieee {
            let remedy = "export it with IEEE numbers, or as dataset 58 in text";
            return Err(Fault::new(
                place,
                "numbers of a VMS or IBM machine",
                "IEEE numbers",
                remedy,
            ));
        }
        let (single, size) = if self.double {
            (Number::F64, 8)
        } else {
            (Number::F32, 4)
        };
        let own_size = size * (1 + u64::from(self.complex));
        let time = match (self.even, binary.bytes.checked_div(self.count)) {
            (true, _) => 0,
            (false, Some(stored)) if stored == own_size + 8 => 8,
            (false, _) => 4,
        };
        let stride = own_size + time;
        let declared = self.count.saturating_mul(stride).max(binary.bytes);
        let there = (lines.bytes.len() - lines.at) as u64;
        if declared > there {
            let found = format!("{there} bytes of dataset 58b, and no line of -1 after it");
            return Err(Fault::cut_off(place, found, format!("{declared} bytes")));
        }
        let data = &lines.bytes[lines.at..lines.at + declared as usize];
        lines.at += declared as usize;
        if !lines.filled().is_some_and(|line| line.is_border()) {
            let expected = "a line of -1 after the values";
            return Err(Fault::damaged(Place::Byte(lines.at as u64), "something else", expected));
        }
        let data = &data[..(self.count * stride) as usize];
        let from = |offset: u64| data.get(offset as usize..).unwrap_or(&[]);
        let time_number = if time == 8 { Number::F64 } else { Number::F32 };
        let times = (!self.even).then(|| time_number.strided(data, stride as usize, binary.order));
        Ok((times, single.strided(from(time), stride as usize, binary.order)))
    }

    /// The values in lines: six of 13 columns or four of 20; uneven times take 13 columns each.
    fn ascii(&self, lines: &mut Lines) -> Read<Numbers> {
        let content = lines.until_border(&format!("dataset 58 `{}`", self.name))?;
        let place = Place::Byte(content.at as u64);
        let width = if self.double { 20 } else { 13 };
        let imaginary = self.complex.then_some(width);
        let of_a_sample = [(!self.even).then_some(13), Some(width), imaginary];
        let of_a_sample: Vec<usize> = of_a_sample.into_iter().flatten().collect();
        let numbers = of_a_sample.len();
        let mut widths = of_a_sample.iter().copied().cycle();
        let mut all = Vec::with_capacity((content.bytes.len() - content.at) / 13);
        for line in content {
            let (mut from, end) = (0, line.bytes.trim_ascii_end().len());
            while from < end
                && let Some(width) = widths.next()
            {
                all.push(number(line, from, from + width, "a number")?);
                from += width;
            }
        }
        if all.len() as u64 != self.count.saturating_mul(numbers as u64) {
            let found = format!("{} numbers", all.len());
            return Err(Fault::damaged(place, found, format!("{} samples", self.count)));
        }
        if numbers == 1 {
            return Ok((None, all));
        }
        let every = |from: usize| all.iter().skip(from).step_by(numbers).copied().collect();
        let times = (!self.even).then(|| every(0));
        Ok((times, every(usize::from(!self.even))))
    }
}

/// The point of a response: entity, node and direction.
fn point(freedom: &str) -> String {
    let direction = match columns(freedom, 51, 55) {
        "1" => "+X",
        "-1" => "-X",
        "2" => "+Y",
        "-2" => "-Y",
        "3" => "+Z",
        "-3" => "-Z",
        _ => "",
    };
    let parts = [columns(freedom, 31, 41), columns(freedom, 41, 51), direction];
    let named = parts.into_iter().filter(|part| !matches!(*part, "" | "NONE" | "0"));
    named.collect::<Vec<_>>().join(":")
}
