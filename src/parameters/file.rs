//! A file of parameter values: TOML with `[parameters]`, each `name = value` or a campaign's table with its unit, and
//! `[vehicle]`, whose facts a model may or may not use. A campaign folder stands for its `campaign.toml`.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use qcar_runtime::error::{InputError, Place, Problem};
use qcar_runtime::spelling;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

use crate::files::read_text;

/// What may stand beside `[parameters]`: the keys of campaigns and of their answers.
const NEIGHBOURS: [&str; 11] = [
    "format",
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

/// What the table of a parameter may hold: the keys of campaigns.
const KEYS: [&str; 5] = ["value", "unit", "range", "fit", "comment"];

/// Values by name.
#[derive(Default)]
pub struct ParameterFile {
    /// The last file that was read; empty where there is none.
    pub path: PathBuf,
    /// Below `[parameters]`.
    pub parameters: BTreeMap<String, Stated>,
    /// Below `[vehicle]`.
    pub vehicle: BTreeMap<String, Stated>,
}

/// A value and where it stands.
pub struct Stated {
    /// A finite number.
    pub value: f64,
    /// Where the file declares one.
    pub unit: Option<String>,
    /// Standard error, where the file knows it.
    pub stderr: Option<f64>,
    /// Which file.
    pub file: PathBuf,
    /// Where in it.
    pub place: Place,
}

/// The values alone.
pub fn numbers(of: &BTreeMap<String, Stated>) -> BTreeMap<String, f64> {
    of.iter().map(|(name, stated)| (name.clone(), stated.value)).collect()
}

impl ParameterFile {
    /// Reads a file, or the `campaign.toml` of a folder.
    ///
    /// # Errors
    /// All problems of the file together.
    pub fn read(path: &Path) -> Result<ParameterFile, InputError> {
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
        let (parameters, vehicle) = reader.tables();
        let Reader { problems, .. } = reader;
        let file = ParameterFile {
            path: path.clone(),
            parameters,
            vehicle,
        };
        InputError::unless_empty(problems, Some(file))
    }

    /// Takes over what another file states.
    pub fn overlay(&mut self, other: ParameterFile) {
        self.path = other.path;
        self.parameters.extend(other.parameters);
        self.vehicle.extend(other.vehicle);
    }
}

/// A file under way.
struct Reader<'a> {
    path: &'a Path,
    text: &'a str,
    problems: Vec<Problem>,
}

type Table = BTreeMap<String, Stated>;

impl Reader<'_> {
    /// What stands below `[parameters]` and `[vehicle]`.
    fn tables(&mut self) -> (Table, Table) {
        let table = match DeTable::parse(self.text) {
            Ok(table) => table.into_inner(),
            Err(error) => {
                let start = error.span().map_or(0, |span| span.start);
                self.wrong(start, "", error.message(), "TOML", "see https://toml.io for its syntax");
                return Default::default();
            }
        };
        for key in table.keys().filter(|key| !NEIGHBOURS.contains(&&**key.get_ref())) {
            if !["parameters", "vehicle"].contains(&&**key.get_ref()) {
                let remedy = "put parameters under [parameters] and facts of the vehicle under [vehicle]";
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
        if !says("parameters") && !says("vehicle") && self.problems.is_empty() {
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
        (section("parameters"), section("vehicle"))
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

    /// Refuses what a parameter's table has and nobody reads: most often a misspelt `unit`.
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

    /// `name = value`, or a table with `value` and perhaps `unit`.
    fn stated(&mut self, section: &str, name: &Spanned<impl AsRef<str>>, value: &Spanned<DeValue>) -> Option<Stated> {
        let key = format!("{section}.{}", name.get_ref().as_ref());
        let table = value.get_ref().as_table();
        if let Some(table) = table {
            self.refuse_unknown(&key, table);
        }
        let (number, unit) = match table {
            Some(table) => (
                table.get("value").map(Spanned::get_ref),
                table.get("unit").and_then(|unit| unit.get_ref().as_str()),
            ),
            None => (Some(value.get_ref()), None),
        };
        let Some(finite) = number.and_then(finite) else {
            let found = number.map_or("no `value`", DeValue::type_str);
            self.wrong(
                name.span().start,
                &key,
                found,
                "a finite number",
                "write a number in SI units",
            );
            return None;
        };
        Some(Stated {
            value: finite,
            unit: unit.map(String::from),
            stderr: None,
            file: self.path.into(),
            place: self.place(name.span().start, &key),
        })
    }

    fn wrong(&mut self, offset: usize, key: &str, found: &str, expected: &str, remedy: &str) {
        let place = self.place(offset, key);
        self.problems
            .push(Problem::new(self.path, place, found, expected, remedy));
    }

    fn place(&self, offset: usize, key: &str) -> Place {
        let before = &self.text[..offset.min(self.text.len())];
        let line_start = before.rfind('\n').map_or(0, |at| at + 1);
        let column = before[line_start..].chars().count() + 1;
        Place::Key(before.matches('\n').count() + 1, column, key.into())
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
