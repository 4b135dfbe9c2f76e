//! The text above the data.

use std::collections::HashMap;

use crate::bytes::text;
use crate::error::{Fault, Place, Read};

/// Characters of a line of the header; characters after column 72 are a comment.
pub(super) const RECORD: usize = 72;
/// Largest difference between rounded numbers of the header that count as equal, relative to an increment.
pub(super) const ROUNDED: f64 = 1e-2;

/// The keyword of a section, in capitals; empty at the end of a section.
pub(super) fn section(line: &str) -> Option<String> {
    let word = line.strip_prefix('$')?.split([' ', '\t', '\r', '\n', '!']).next()?;
    Some(word.to_ascii_uppercase())
}

/// Parameters of the road, and the definition of the data.
pub(super) struct Header {
    /// Values and lines of parameters, by section and name in capitals.
    parameters: HashMap<(String, String), (f64, u64)>,
    /// Lines of the definition of the data, with their numbers.
    definition: Vec<(u64, String)>,
    /// The line of each section.
    sections: HashMap<String, u64>,
    /// The byte at which the data begin.
    pub end: usize,
    /// The number of the last line before the data.
    pub lines: u64,
}

/// Distances of the rows along the reference line, m.
pub(super) struct Distances {
    pub start: f64,
    pub step: f64,
}

impl Header {
    pub fn read(bytes: &[u8]) -> Read<Header> {
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
            "data after such a line",
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
                if let Some((_, before)) = self.parameters.insert(key, (value, self.lines)) {
                    let found = format!("`{}` again, after line {before}", name.trim());
                    let remedy = "remove one of both";
                    return Err(Fault::new(
                        Place::Line(self.lines),
                        found,
                        "each parameter once",
                        remedy,
                    ));
                }
            }
            _ => {}
        }
        Ok(())
    }

    /// A parameter of the road with its line.
    pub fn stated(&self, name: &str) -> Option<(f64, u64)> {
        self.parameters.get(&("ROAD_CRG".into(), name.into())).copied()
    }

    /// A parameter of the road.
    pub fn road(&self, name: &str) -> Option<f64> {
        Some(self.stated(name)?.0)
    }

    pub fn road_or_zero(&self, name: &str) -> f64 {
        self.road(name).unwrap_or(0.0)
    }

    /// Refuses references to another file, and modifiers that change the profile.
    pub fn refuse_references_and_modifiers(&self) -> Read<()> {
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
            section == "ROAD_CRG_MODS" && name.starts_with("SCALE_") && *value != 1.0
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

    /// Lines of the definition of the data that begin with `prefix`, with their numbers and without the prefix.
    pub fn defined<'a>(&'a self, prefix: &'a str) -> impl Iterator<Item = (u64, &'a str)> {
        let lines = self.definition.iter();
        lines.filter_map(move |(line, text)| Some((*line, after(text, prefix)?)))
    }

    /// Number of rows that follows from the length of the reference line; `None` if that is not stated.
    pub fn declared_rows(&self) -> Read<Option<f64>> {
        let Distances { start, step } = self.distances()?;
        let Some((end, line)) = self.stated("REFERENCE_LINE_END_U") else {
            return Ok(None);
        };
        if end <= start {
            let found = format!("REFERENCE_LINE_END_U = {end}");
            return Err(Fault::damaged(
                Place::Line(line),
                found,
                format!("an end above the start, {start} m"),
            ));
        }
        Ok(Some(((end - start) / step).round() + 1.0))
    }

    /// Distances from the parameters or from the virtual channel `U:reference line u`.
    pub fn distances(&self) -> Read<Distances> {
        let (start, step) = ("REFERENCE_LINE_START_U", "REFERENCE_LINE_INCREMENT");
        let mut shown = self.defined("U:").filter(|(_, text)| is_distance(text));
        let (line, [first, increment]) = shown
            .next()
            .map_or((0, [None; 2]), |(line, text)| (line, last_two(text)));
        let found = self.road(step).or(increment);
        let Some(increment_found) = found.filter(|step| *step > 0.0) else {
            let found = found.map_or("none".into(), |step| step.to_string());
            return Err(Fault::damaged(
                Place::Item(step.into()),
                found,
                "a positive number of metres",
            ));
        };
        for (name, shown) in [(start, first), (step, increment)] {
            if let (Some(stated), Some(shown)) = (self.road(name), shown)
                && (stated - shown).abs() > ROUNDED * increment_found
            {
                let expected = format!("{stated} m, as {name} says");
                return Err(Fault::damaged(Place::Line(line), format!("{shown} m"), expected));
            }
        }
        Ok(Distances {
            start: self.road(start).or(first).unwrap_or(0.0),
            step: increment_found,
        })
    }
}

/// True for a definition of the distance along the reference line.
fn is_distance(text: &str) -> bool {
    let mut parts = text.split(',').map(str::trim);
    parts
        .next()
        .is_some_and(|name| name.eq_ignore_ascii_case("reference line u"))
        && parts.next() == Some("m")
}

/// The third and the fourth part of a definition; `None` if they are not numbers.
fn last_two(text: &str) -> [Option<f64>; 2] {
    let mut parts = text.split(',').skip(2);
    let mut number = || {
        parts
            .next()?
            .trim()
            .parse()
            .ok()
            .filter(|value: &f64| value.is_finite())
    };
    [number(), number()]
}

/// The text after a prefix, in upper or lower case; `None` without the prefix.
fn after<'a>(text: &'a str, prefix: &str) -> Option<&'a str> {
    let own = text.get(..prefix.len())?;
    own.eq_ignore_ascii_case(prefix).then(|| text[prefix.len()..].trim())
}
