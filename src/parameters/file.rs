//! A file of parameter values: the workbook of a vehicle, or TOML with `[parameters]` and `[vehicle]`. A parameter is
//! `name = value`, `name = "value unit"`, or a table with its unit as in a campaign. Vehicle data may be unused by a
//! model. A campaign folder means its `campaign.toml`.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use qcar_runtime::campaign::workbook::{Entry, Workbook, is_workbook};
use qcar_runtime::campaign::{Declared, examples, impossible_fact, unit_of_fact};
use qcar_runtime::error::{InputError, Place, Problem};
use qcar_runtime::spelling;
use qcar_runtime::syntax;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

use crate::files::read_text;

/// Allowed keys besides `[parameters]`: those of campaigns and of results.
const NEIGHBOURS: [&str; 13] = [
    "format",
    "workbook",
    "axle",
    "name",
    "description",
    "model",
    "mapping",
    "channel",
    "run",
    "road",
    "roles",
    "generator",
    "effects",
];

/// Allowed keys of the table of a parameter: those of campaigns.
const KEYS: [&str; 5] = ["value", "unit", "range", "fit", "comment"];

/// Values by name.
#[derive(Default)]
pub struct ParameterFile {
    /// The last file that was read; empty without any.
    pub path: PathBuf,
    /// Values below `[parameters]`.
    pub parameters: BTreeMap<String, Stated>,
    /// Values below `[vehicle]`.
    pub vehicle: BTreeMap<String, Stated>,
    /// Empty cells of a workbook for values that are not given.
    pub blanks: BTreeMap<String, (PathBuf, Place)>,
}

/// A value and its position.
pub struct Stated {
    /// A finite number, SI.
    pub value: f64,
    /// The unit as written; `None` without one.
    pub unit: Option<String>,
    /// Standard error, if the file has it.
    pub stderr: Option<f64>,
    /// The file.
    pub file: PathBuf,
    /// Position in the file.
    pub place: Place,
}

/// The values without positions.
pub fn numbers(of: &BTreeMap<String, Stated>) -> BTreeMap<String, f64> {
    of.iter().map(|(name, stated)| (name.clone(), stated.value)).collect()
}

impl ParameterFile {
    /// Reads a file, or the `campaign.toml` of a folder. Its values take precedence over those of the workbook that it
    /// names.
    ///
    /// # Errors
    /// Fails with all problems of the file.
    pub fn read(path: &Path) -> Result<ParameterFile, InputError> {
        if is_workbook(path) {
            return Ok(ParameterFile::from(Workbook::read(path, None)?));
        }
        let path = if path.is_dir() {
            path.join("campaign.toml")
        } else {
            path.into()
        };
        let text = read_text(&path)?;
        let mut reader = Reader {
            path: &path,
            text: &text,
            problems: Vec::new(),
        };
        let Tables {
            workbook,
            axle,
            parameters,
            vehicle,
        } = reader.tables();
        reader.refuse_contradictions(&parameters, &vehicle);
        let Reader { problems, .. } = reader;
        InputError::unless_empty(problems, Some(()))?;
        let mut file = match workbook {
            Some(named) => {
                let beside = path.parent().unwrap_or(Path::new("")).join(named);
                ParameterFile::from(Workbook::read(&beside, axle.as_deref())?)
            }
            None => ParameterFile::default(),
        };
        file.overlay(ParameterFile {
            path,
            parameters,
            vehicle,
            blanks: BTreeMap::new(),
        });
        Ok(file)
    }

    /// Adds the values of another file, which take precedence.
    pub fn overlay(&mut self, other: ParameterFile) {
        self.path = other.path;
        self.parameters.extend(other.parameters);
        self.vehicle.extend(other.vehicle);
        self.blanks.extend(other.blanks);
    }
}

impl From<Workbook> for ParameterFile {
    fn from(of: Workbook) -> Self {
        let stated = |entry: Entry| {
            let stated = Stated {
                value: entry.value,
                unit: Some(entry.unit),
                stderr: None,
                file: of.file.clone(),
                place: entry.place,
            };
            (entry.name, stated)
        };
        ParameterFile {
            parameters: of.parameters.into_iter().map(stated).collect(),
            vehicle: of.vehicle.into_iter().map(stated).collect(),
            blanks: of
                .blanks
                .into_iter()
                .map(|(name, place)| (name, (of.file.clone(), place)))
                .collect(),
            path: of.file.clone(),
        }
    }
}

/// A file that is being read.
struct Reader<'a> {
    path: &'a Path,
    text: &'a str,
    problems: Vec<Problem>,
}

type Table = BTreeMap<String, Stated>;

/// The relevant contents of a file.
#[derive(Default)]
struct Tables {
    /// Path relative to the folder of the file.
    workbook: Option<String>,
    axle: Option<String>,
    parameters: Table,
    vehicle: Table,
}

impl Reader<'_> {
    /// The contents of `[parameters]` and `[vehicle]`, and the workbook that the file names.
    fn tables(&mut self) -> Tables {
        let table = match DeTable::parse(self.text) {
            Ok(table) => table.into_inner(),
            Err(error) => {
                let problem = syntax::of_toml(self.path, self.text, &error, "correct this line");
                self.problems.push(problem);
                return Tables::default();
            }
        };
        for key in table.keys().filter(|key| !NEIGHBOURS.contains(&&**key.get_ref())) {
            if !["parameters", "vehicle"].contains(&&**key.get_ref()) {
                let remedy = "put parameters under [parameters] and vehicle data under [vehicle]";
                let found = format!("`{}`", key.get_ref());
                self.wrong(
                    key.span().start,
                    key.get_ref(),
                    &found,
                    "[parameters] or [vehicle]",
                    remedy,
                );
            }
        }
        let says = |name: &str| table.contains_key(name);
        let word = |name: &str| Some(table.get(name)?.get_ref().as_str()?.to_string());
        let (workbook, axle) = (word("workbook"), word("axle"));
        // A campaign (it has a format) may leave all parameters to the model.
        let may_be_empty = ["parameters", "vehicle", "workbook", "format"].into_iter().any(says);
        if !may_be_empty && self.problems.is_empty() {
            let remedy = "write the values below a line [parameters]";
            let problem = Problem::new(
                self.path,
                Place::File,
                "no [parameters]",
                "TOML with [parameters]",
                remedy,
            );
            self.problems.push(problem);
        }
        let mut section = |name| {
            table
                .get(name)
                .map(|value| self.section(name, value))
                .unwrap_or_default()
        };
        Tables {
            workbook,
            axle,
            parameters: section("parameters"),
            vehicle: section("vehicle"),
        }
    }

    /// Refuses a parameter with one value below `[vehicle]` and another below `[parameters]`.
    fn refuse_contradictions(&mut self, parameters: &Table, vehicle: &Table) {
        for (name, own) in parameters {
            let Some(known) = vehicle.get(name).filter(|known| known.value != own.value) else {
                continue;
            };
            let found = format!("{} here and {} at [vehicle], both in SI", own.value, known.value);
            let remedy = "leave out one of them: [vehicle] is for known values, [parameters] for start values";
            let problem = Problem::new(self.path, own.place.clone(), found, "one value", remedy);
            self.problems.push(problem);
        }
    }

    fn section(&mut self, section: &str, value: &Spanned<DeValue>) -> Table {
        let Some(entries) = value.get_ref().as_table() else {
            let remedy = format!("write [{section}] on a line and the values below it");
            self.wrong(
                value.span().start,
                section,
                value.get_ref().type_str(),
                "a table of values",
                &remedy,
            );
            return Table::new();
        };
        let entries = entries.iter();
        entries
            .filter_map(|(name, value)| Some((name.get_ref().to_string(), self.stated(section, name, value)?)))
            .collect()
    }

    /// Refuses unknown keys of a parameter's table, most often a misspelt `unit`.
    fn refuse_unknown(&mut self, key: &str, table: &DeTable) {
        for name in table.keys().filter(|name| !KEYS.contains(&&**name.get_ref())) {
            let own = name.get_ref();
            let expected = format!("one of {}", KEYS.join(", "));
            let place = format!("{key}.{own}");
            self.wrong(
                name.span().start,
                &place,
                "an unknown key",
                &expected,
                &spelling::remedy(own, KEYS),
            );
        }
    }

    /// `name = value`, `name = "value unit"`, or a table with `value` and an optional `unit`.
    fn stated(&mut self, section: &str, name: &Spanned<impl AsRef<str>>, value: &Spanned<DeValue>) -> Option<Stated> {
        let own = name.get_ref().as_ref();
        let (key, offset) = (format!("{section}.{own}"), name.span().start);
        let table = value.get_ref().as_table();
        if let Some(table) = table {
            self.refuse_unknown(&key, table);
        }
        let number = match table {
            Some(table) => table.get("value"),
            None => Some(value),
        };
        let written = number
            .and_then(|number| self.text.get(number.span()))
            .unwrap_or_default();
        let number = number.map(Spanned::get_ref);
        let unit = table
            .and_then(|table| table.get("unit"))
            .and_then(|unit| unit.get_ref().as_str());
        let kind = Some(section)
            .filter(|section| *section == "vehicle")
            .and_then(|_| unit_of_fact(own));
        let (value, unit) = match (number, unit) {
            (Some(DeValue::String(text)), None) => self.quantity(offset, &key, text, kind)?,
            (number, unit) => {
                let Some(finite) = number.and_then(finite) else {
                    let found = match number {
                        Some(DeValue::Float(_)) => written,
                        other => other.map_or("no `value`", DeValue::type_str),
                    };
                    let remedy = "write a number in SI units, or in quotes a number and its unit";
                    self.wrong(offset, &key, found, "a finite number", remedy);
                    return None;
                };
                self.in_unit(offset, &key, finite, unit, kind)?
            }
        };
        if section == "vehicle"
            && let Some((expected, remedy)) = impossible_fact(own, value)
        {
            self.wrong(offset, &key, written, expected, remedy);
            return None;
        }
        Some(Stated {
            value,
            unit,
            stderr: None,
            file: self.path.into(),
            place: self.place(offset, &key),
        })
    }

    /// The value of a text of a number and its unit, in SI.
    fn quantity(&mut self, offset: usize, key: &str, text: &str, kind: Option<&str>) -> Option<(f64, Option<String>)> {
        let quantity = Declared::quantity(text).filter(|(_, unit)| kind.is_none_or(|kind| unit.is_like(kind)));
        if quantity.is_none() {
            let expected = match kind {
                Some(kind) => format!("a number with {}", examples(kind)),
                None => "a number with its unit, such as \"187 N/mm\"".into(),
            };
            self.wrong(
                offset,
                key,
                &format!("the string \"{text}\""),
                &expected,
                "correct the value or its unit",
            );
        }
        quantity.map(|(value, unit)| (value, Some(unit.written)))
    }

    /// The value of a number in its declared unit, which is of this kind, in SI.
    fn in_unit(
        &mut self,
        offset: usize,
        key: &str,
        value: f64,
        unit: Option<&str>,
        kind: Option<&str>,
    ) -> Option<(f64, Option<String>)> {
        let Some(unit) = unit else {
            return Some((value, None));
        };
        let declared = Declared::of(unit).filter(|own| kind.is_none_or(|kind| own.is_like(kind)));
        let Some(declared) = declared else {
            let remedy = "write the unit of the value, such as N/m, N/mm, N s/m, kg, mm or 1";
            let expected = kind.map_or("a unit of mechanics".into(), examples);
            self.wrong(offset, key, &format!("the unit \"{unit}\""), &expected, remedy);
            return None;
        };
        Some((declared.si(value), Some(declared.written)))
    }

    fn wrong(&mut self, offset: usize, key: &str, found: &str, expected: &str, remedy: &str) {
        let place = self.place(offset, key);
        self.problems
            .push(Problem::new(self.path, place, found, expected, remedy));
    }

    fn place(&self, offset: usize, key: &str) -> Place {
        Place::in_text(self.text, offset, key)
    }
}

fn finite(value: &DeValue) -> Option<f64> {
    let number = match value {
        DeValue::Float(float) => float.as_str().parse::<f64>().ok(),
        DeValue::Integer(integer) => i64::from_str_radix(integer.as_str(), integer.radix())
            .ok()
            .map(|i| i as f64),
        _ => None,
    };
    number.filter(|v| v.is_finite())
}
