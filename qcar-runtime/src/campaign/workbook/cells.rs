//! The named cells of a workbook: numbers with units, and words.

use std::path::Path;

use qcar_signals::signal::{Recording, Scalar, Value};

use super::super::contents::{FACT_UNITS, FACTS, impossible_fact};
use super::super::unit::{Declared, examples};
use super::{AXLES, Entry};
use crate::error::{InputError, Place, Problem};
use crate::shown::shown;

/// The named cells and their problems.
pub(super) struct Cells<'a> {
    file: &'a Path,
    recording: &'a Recording,
    pub problems: Vec<Problem>,
    /// Names and places of empty cells for values.
    pub blanks: Vec<(String, Place)>,
}

impl<'a> Cells<'a> {
    pub fn new(file: &'a Path, recording: &'a Recording) -> Self {
        Cells {
            file,
            recording,
            problems: Vec::new(),
            blanks: Vec::new(),
        }
    }

    /// The axle to read.
    pub fn axle(&self, wanted: Option<&str>) -> Result<String, InputError> {
        let named = wanted.map(String::from).or_else(|| self.text("axle"));
        match named {
            Some(axle) if AXLES.contains(&axle.as_str()) => Ok(axle),
            other => {
                let cell = self.cell("axle").filter(|_| wanted.is_none());
                let found = other.map_or("no axle".into(), |other| format!("the axle `{other}`"));
                let remedy =
                    "write one of them into the cell named `axle`; `qcar new template` creates such a workbook";
                let expected = AXLES.join(" or ");
                Err(Problem::new(self.file, cell.map_or(Place::File, place), found, expected, remedy).into())
            }
        }
    }

    /// A word; `None` for an empty cell.
    pub fn text(&self, name: &str) -> Option<String> {
        match &self.cell(name)?.value {
            Value::Text(text) => Some(text.trim().into()),
            Value::Number(number) => Some(number.to_string()),
            Value::Empty | Value::Formula(_) => None,
        }
    }

    /// Vehicle data of an axle; an empty cell is computed from data of the whole vehicle.
    pub fn facts(&mut self, axle: &str) -> Vec<Entry> {
        let facts = FACTS.into_iter().zip(FACT_UNITS);
        facts
            .filter_map(|(name, unit)| {
                let stated = self.entry(&format!("{axle}.{name}"), name, Some(unit));
                let stated = stated.filter(|own| self.is_possible(own));
                stated.or_else(|| self.derived(axle, name))
            })
            .collect()
    }

    /// Refuses vehicle data that cannot be.
    fn is_possible(&mut self, own: &Entry) -> bool {
        let Some((expected, remedy)) = impossible_fact(&own.name, own.value) else {
            return true;
        };
        let found = shown(own.value, &own.unit).to_string();
        self.wrong(own.place.clone(), found, expected, remedy);
        false
    }

    /// Half of the vehicle, the share of an axle, and the wheel load of the other one.
    fn derived(&mut self, axle: &str, name: &str) -> Option<Entry> {
        let half = |mass: Entry| Entry {
            name: name.into(),
            value: mass.value / 2.0,
            ..mass
        };
        match name {
            "m_half_vehicle" => self.entry("vehicle.mass", name, Some("kg")).map(half),
            "m_corner" => {
                let mass = self.entry("vehicle.mass", name, Some("kg")).map(half)?;
                let share = self.entry("vehicle.front_share", name, Some("1"))?.value;
                let share = if axle == AXLES[0] { share } else { 1.0 - share };
                Some(Entry {
                    value: mass.value * share,
                    ..mass
                })
            }
            "m_wheel_other_axle" => {
                let other = AXLES.into_iter().find(|other| *other != axle)?;
                self.entry(&format!("{other}.m_wheel"), name, Some("kg"))
            }
            _ => None,
        }
    }

    /// Every parameter that has a value on an axle.
    pub fn parameters(&mut self, axle: &str) -> Vec<Entry> {
        let (recording, prefix) = (self.recording, format!("{axle}."));
        let names = recording
            .scalars
            .iter()
            .filter_map(|cell| cell.name.strip_prefix(&prefix));
        let own = names.filter(|name| !name.contains('.') && *name != "model" && !FACTS.contains(name));
        own.filter_map(|name| {
            let kind = self.text(&format!("kind.{name}"));
            self.entry(&format!("{axle}.{name}"), name, kind.as_deref())
        })
        .collect()
    }

    fn cell(&self, name: &str) -> Option<&'a Scalar> {
        self.recording.scalars.iter().find(|cell| cell.name == name)
    }

    /// A value with its unit and neighbouring cells; `None` if the cell is empty or wrong.
    fn entry(&mut self, cell: &str, name: &str, kind: Option<&str>) -> Option<Entry> {
        let own = self.cell(cell)?;
        if own.value == Value::Empty {
            self.blanks.push((name.into(), place(own)));
            return None;
        }
        let unit = self.cell(&format!("{cell}.unit"));
        let unit = match unit {
            Some(unit) => {
                let text = self.text(&unit.name).unwrap_or_default();
                self.unit(place(unit), &text, kind)?
            }
            None => self.unit(place(own), &own.unit, kind)?,
        };
        let value = self.number(own, kind)?;
        let range = self.range(cell, value, kind);
        Some(Entry {
            name: name.into(),
            value: unit.si(value),
            range: range.map(|(lower, upper)| (unit.si(lower), unit.si(upper))),
            fit: self.is_yes(&format!("{cell}.fit")),
            comment: self.text(&format!("comment.{name}")).unwrap_or_default(),
            place: place(own),
            unit: unit.coherent,
        })
    }

    /// The bounds of a value, in its unit; `None` unless both are given.
    fn range(&mut self, cell: &str, value: f64, kind: Option<&str>) -> Option<(f64, f64)> {
        let [lower, upper] = ["lower", "upper"].map(|end| {
            let cell = self
                .cell(&format!("{cell}.{end}"))
                .filter(|cell| cell.value != Value::Empty)?;
            Some((cell, self.number(cell, kind)?))
        });
        let ((lower_cell, lower), (upper_cell, upper)) = (lower?, upper?);
        let beyond = [
            (lower_cell, value < lower, "at most"),
            (upper_cell, value > upper || lower >= upper, "at least"),
        ];
        for (cell, is_wrong, side) in beyond {
            if is_wrong {
                let found = format!(
                    "{} as a bound of {value}",
                    if side == "at most" { lower } else { upper }
                );
                let expected = format!("{side} {value}, and the lower bound below the upper");
                self.wrong(
                    place(cell),
                    found,
                    expected,
                    "correct the bound or the value; both have the same unit",
                );
                return None;
            }
        }
        Some((lower, upper))
    }

    /// A number in a cell that is not empty.
    fn number(&mut self, cell: &Scalar, kind: Option<&str>) -> Option<f64> {
        let found = match &cell.value {
            Value::Number(number) if number.is_finite() => return Some(*number),
            Value::Number(number) => number.to_string(),
            Value::Text(text) => format!("the text `{text}`"),
            Value::Empty => "an empty cell".into(),
            Value::Formula(formula) => format!(
                "the formula `={formula}` of `{}`, which has no stored result",
                cell.name
            ),
        };
        let expected = kind.map_or("a number".into(), |kind| match cell.unit.as_str() {
            "" => format!("a number, with {}", examples(kind)),
            unit => format!("a number in {unit}"),
        });
        let remedy = match &cell.value {
            Value::Formula(_) => "open the file in Excel and save it, which stores the result, or write a number",
            _ => "write a number",
        };
        self.wrong(place(cell), found, expected, remedy);
        None
    }

    /// A unit of the kind of a coherent one.
    pub fn unit(&mut self, place: Place, text: &str, kind: Option<&str>) -> Option<Declared> {
        let text = if ["", "-"].contains(&text) && kind == Some("1") {
            "1"
        } else {
            text
        };
        let declared = Declared::of(text).filter(|unit| kind.is_none_or(|kind| unit.is_like(kind)));
        if declared.is_none() {
            let found = match text {
                "" => "no unit".to_string(),
                text => format!("the unit \"{text}\""),
            };
            let expected = examples(kind.unwrap_or("a parameter"));
            self.wrong(place, found, expected, "give the unit of the values in this row");
        }
        declared
    }

    fn is_yes(&self, name: &str) -> bool {
        let word = self.text(name).unwrap_or_default().to_lowercase();
        ["yes", "true", "1"].contains(&word.as_str())
    }

    /// Records a problem at a cell.
    pub fn wrong(&mut self, place: Place, found: String, expected: impl Into<String>, remedy: &str) {
        self.problems
            .push(Problem::new(self.file, place, found, expected, remedy));
    }
}

fn place(of: &Scalar) -> Place {
    Place::Words(of.place.to_string())
}
