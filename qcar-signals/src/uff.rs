//! UFF, the Universal File Format of SDRC: datasets between lines of -1. Functions over time are in datasets 58 (text)
//! and 58b (binary); dataset 164 gives the units of the file.
//!
//! Source: the definitions of the datasets that the University of Cincinnati publishes.

use crate::bytes::{Number, Order, text};
use crate::error::{Fault, Place, Read};
use crate::signal::{Recording, Signal, Source, TimeBase, evenly};

/// True if a file begins like UFF: a line of -1, then the number of a dataset.
pub(crate) fn is_uff(bytes: &[u8]) -> bool {
    let mut lines = Lines { bytes, at: 0 };
    let first = lines.find(|line| !line.1.trim().is_empty());
    first.is_some_and(|line| is_border(&line.1)) && lines.next().is_some_and(|line| Header::of(&line.1).is_some())
}

/// Reads all datasets of a file.
pub(crate) fn read(bytes: &[u8]) -> Read<Recording> {
    let mut recording = Recording::new("UFF 58");
    let mut lines = Lines { bytes, at: 0 };
    let mut units = Units { length: "", force: "" };
    while let Some((at, line)) = lines.next() {
        if line.trim().is_empty() {
            continue;
        }
        let header = if is_border(&line) { lines.next() } else { None };
        let Some(header) = header.and_then(|(_, line)| Header::of(&line)) else {
            let found = format!("`{}`", line.trim().chars().take(40).collect::<String>());
            return Err(Fault::damaged(
                Place::Byte(at),
                found,
                "a line of -1 and the number of a dataset",
            ));
        };
        let place = Place::Byte(at);
        match header.number {
            58 => function(&mut recording, &mut lines, &header, &units, place)?,
            number => {
                let content = lines.until_border(&format!("dataset {number}"))?;
                match number {
                    164 => units = Units::of(&content),
                    151 => {}
                    _ => recording.pass_over(format!("dataset {number}"), place, what_else(number)),
                }
            }
        }
    }
    Ok(recording)
}

fn what_else(number: u32) -> &'static str {
    match number {
        15 | 2411 => "nodes of a geometry, no measured function",
        18 | 2420 => "coordinate systems of a geometry, no measured function",
        82 | 2412 => "lines of a geometry, no measured function",
        55 | 2414 => "shapes, no measured function over time",
        _ => "no measured function",
    }
}

/// Lines with the position of their first byte.
struct Lines<'a> {
    bytes: &'a [u8],
    at: usize,
}

impl Iterator for Lines<'_> {
    type Item = (u64, String);

    fn next(&mut self) -> Option<(u64, String)> {
        let start = self.at;
        let rest = self.bytes.get(start..).filter(|rest| !rest.is_empty())?;
        let length = rest.iter().position(|&byte| byte == b'\n');
        self.at = start + length.map_or(rest.len(), |length| length + 1);
        let line = &rest[..length.unwrap_or(rest.len())];
        Some((start as u64, text(line.strip_suffix(b"\r").unwrap_or(line))))
    }
}

impl Lines<'_> {
    /// The lines up to the next border; the border is skipped.
    fn until_border(&mut self, what: &str) -> Read<Vec<(u64, String)>> {
        let mut content = Vec::new();
        for line in self.by_ref() {
            if is_border(&line.1) {
                return Ok(content);
            }
            content.push(line);
        }
        Err(self.cut(format!("{what} without the line of -1 that ends it")))
    }

    fn needed(&mut self, what: &str) -> Read<(u64, String)> {
        self.next().ok_or_else(|| self.cut(format!("no {what}")))
    }

    fn cut(&self, found: String) -> Box<Fault> {
        Fault::cut_off(Place::Byte(self.bytes.len() as u64), found, "whole datasets")
    }
}

fn is_border(line: &str) -> bool {
    line.trim() == "-1"
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
    fn of(line: &str) -> Option<Header> {
        let number = columns(line, 0, 6).parse().ok()?;
        let binary = (columns(line, 6, 7) == "b").then(|| Binary {
            order: if columns(line, 7, 13) == "2" {
                Order::Big
            } else {
                Order::Little
            },
            ieee: columns(line, 13, 19) == "2",
            bytes: columns(line, 31, 43).parse().unwrap_or(0),
        });
        Some(Header { number, binary })
    }
}

/// Characters of a line from a column to another.
fn columns(line: &str, from: usize, to: usize) -> &str {
    let byte = |place: usize| line.char_indices().nth(place).map_or(line.len(), |(byte, _)| byte);
    line[byte(from)..byte(to)].trim()
}

/// The number in columns of a line of text; exponents may be written with D.
fn number<T: std::str::FromStr>(at: u64, line: &str, from: usize, to: usize, what: &str) -> Read<T> {
    let text = columns(line, from, to);
    text.replace(['D', 'd'], "e").parse().map_err(|_| {
        let found = format!("`{text}` in columns {} to {to}", from + 1);
        Fault::damaged(Place::Byte(at), found, what)
    })
}

/// Units of a file, for functions that state none.
struct Units {
    length: &'static str,
    force: &'static str,
}

impl Units {
    fn of(content: &[(u64, String)]) -> Units {
        let code = content.first().map_or("", |(_, line)| columns(line, 0, 10));
        let (length, force) = match code {
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
        fault.found += &format!("; the {whole} functions before it are whole");
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
        let (_, name) = lines.needed("name of a function")?;
        for _ in 0..4 {
            lines.needed("description of a function")?;
        }
        let (kind_at, freedom) = lines.needed("degree of freedom")?;
        let (form_at, form) = lines.needed("form of the data")?;
        let (axis_at, axis) = lines.needed("axis of a function")?;
        let (values_at, values) = lines.needed("unit of a function")?;
        lines.needed("denominator of a function")?;
        lines.needed("third axis of a function")?;
        let named = match columns(&values, 47, 67) {
            "" | "NONE" => None,
            unit => Some(unit.to_string()),
        };
        let data: u32 = number(form_at, &form, 0, 10, "the type of the values")?;
        if !matches!(data, 2 | 4 | 5 | 6) {
            return Err(Fault::damaged(
                Place::Byte(form_at),
                format!("values of type {data}"),
                "type 2, 4, 5 or 6",
            ));
        }
        let abscissa: u32 = number(axis_at, &axis, 0, 10, "the kind of the axis")?;
        let kind = number(kind_at, &freedom, 0, 5, "the type of the function")?;
        let meaning = number(values_at, &values, 0, 10, "the kind of the values")?;
        Ok(Function {
            name: name.trim().into(),
            point: point(&freedom),
            kind,
            over_time: abscissa == 17 || (abscissa == 0 && kind == 1),
            complex: data > 4,
            double: matches!(data, 4 | 6),
            even: number::<u32>(form_at, &form, 20, 30, "the spacing")? == 1,
            count: number(form_at, &form, 10, 20, "the number of values")?,
            start: number(form_at, &form, 30, 43, "the first time")?,
            step: number(form_at, &form, 43, 56, "the time step")?,
            unit: named.unwrap_or_else(|| units.unit(meaning)),
            time_unit: columns(&axis, 47, 67).replace("NONE", ""),
        })
    }

    /// Number of stored numbers for one sample, including the time if it is stored.
    fn numbers_of_a_sample(&self) -> u64 {
        1 + u64::from(self.complex) + u64::from(!self.even)
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
        let promised = self.count.saturating_mul(stride).max(binary.bytes);
        let there = (lines.bytes.len() - lines.at) as u64;
        if promised > there {
            let found = format!("{there} bytes of dataset 58b, and no line of -1 after it");
            return Err(Fault::cut_off(place, found, format!("{promised} bytes")));
        }
        let data = &lines.bytes[lines.at..lines.at + promised as usize];
        lines.at += promised as usize;
        let next = lines.by_ref().find(|line| !line.1.trim().is_empty());
        if !next.is_some_and(|line| is_border(&line.1)) {
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
        let width = if self.double { 20 } else { 13 };
        let numbers_of_a_sample = self.numbers_of_a_sample() as usize;
        let is_time = |place: usize| !self.even && place.is_multiple_of(numbers_of_a_sample);
        let mut all = Vec::new();
        let content = lines.until_border(&format!("dataset 58 `{}`", self.name))?;
        for (at, line) in &content {
            let (mut from, end) = (0, line.trim_end().chars().count());
            while from < end {
                let to = from + if is_time(all.len()) { 13 } else { width };
                all.push(number::<f64>(*at, line, from, to, "a number")?);
                from = to;
            }
        }
        if all.len() as u64 != self.count.saturating_mul(self.numbers_of_a_sample()) {
            let place = Place::Byte(content.first().map_or(lines.at as u64, |(at, _)| *at));
            let found = format!("{} numbers", all.len());
            return Err(Fault::damaged(place, found, format!("{} samples", self.count)));
        }
        let every = |from: usize| all.iter().skip(from).step_by(numbers_of_a_sample).copied().collect();
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
