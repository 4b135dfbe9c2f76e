//! Parameter values: from a file, from `--set`, from the model's defaults.
//!
//! A file is TOML with `[parameters]`, each `name = value` or a campaign's table with its unit, and `[vehicle]`, whose
//! facts a model may or may not use. A campaign folder stands for its `campaign.toml`.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use qcar_runtime::campaign::dimension;
use qcar_runtime::error::{InputError, Place, Problem};
use qcar_runtime::model::About;
use qcar_runtime::response::parameters::{ParameterError, Values};
use toml::Spanned;
use toml::de::{DeTable, DeValue};

use crate::failure::read_text;

/// What may stand beside `[parameters]`: the keys of campaigns and of their answers.
const NEIGHBOURS: [&str; 9] = [
    "format",
    "name",
    "description",
    "model",
    "channel",
    "run",
    "road",
    "generator",
    "effects",
];

/// Values by name, as a file gives them.
#[derive(Default)]
struct Read {
    path: PathBuf,
    parameters: BTreeMap<String, Given>,
    vehicle: BTreeMap<String, Given>,
}

/// A value and where it stands.
struct Given {
    value: f64,
    unit: Option<String>,
    place: Place,
}

/// `name=value`, as `--set` takes it.
#[derive(Clone, Debug)]
pub struct Setting {
    name: String,
    value: f64,
}

impl Read {
    fn numbers(of: &BTreeMap<String, Given>) -> BTreeMap<String, f64> {
        of.iter().map(|(name, given)| (name.clone(), given.value)).collect()
    }
}

impl std::str::FromStr for Setting {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let (name, value) = text.split_once('=').ok_or("expected name=value, such as k_tm=6e5")?;
        let number = value.trim().parse::<f64>().ok().filter(|v| v.is_finite());
        let value = number.ok_or_else(|| format!("expected a number after `=`, found `{value}`"))?;
        Ok(Setting {
            name: name.trim().into(),
            value,
        })
    }
}

/// The value of every parameter of a model: from `file`, `settings` above it and defaults below it.
///
/// # Errors
/// A file that cannot be read or understood, a name that the model does not have, a unit that is not the model's,
/// a parameter without any value: all of them at once.
pub fn resolve(about: &About, file: Option<&Path>, settings: &[Setting]) -> Result<Values, InputError> {
    let read = file.map(read).transpose()?.unwrap_or_default();
    let mut given = Read::numbers(&read.parameters);
    given.extend(settings.iter().map(|setting| (setting.name.clone(), setting.value)));
    let resolved = Values::resolve(about, &given, &Read::numbers(&read.vehicle));
    let mut problems = wrong_units(about, &read);
    match resolved {
        Ok(values) => InputError::unless_empty(problems, Some(values)),
        Err(errors) => {
            problems.extend(
                errors
                    .iter()
                    .map(|error| problem(error, file.is_some().then_some(&read))),
            );
            Err(InputError { problems })
        }
    }
}

fn problem(error: &ParameterError, file: Option<&Read>) -> Problem {
    let stated = file.and_then(|read| Some((read, read.parameters.get(error.name())?)));
    let (path, place) = match (stated, file) {
        (Some((read, given)), _) => (read.path.clone(), given.place.clone()),
        (None, Some(read)) => (read.path.clone(), Place::Name("[parameters]".into())),
        (None, None) => ("command line".into(), Place::Name("--params, --set".into())),
    };
    match error {
        ParameterError::Unknown { name, model, nearest } => {
            let remedy = match nearest {
                Some(nearest) => format!("did you mean `{nearest}`?"),
                None => format!("remove it; `qcar show {model} --stage model` lists the parameters"),
            };
            Problem::new(
                path,
                place,
                format!("`{name}`"),
                format!("a parameter of the model `{model}`"),
                remedy,
            )
        }
        ParameterError::Missing { name, unit, doc, .. } => {
            let expected = format!("a value in {unit}: {doc}");
            Problem::new(
                path,
                place,
                format!("no `{name}`"),
                expected,
                format!("add `{name} = …`, or --set {name}=…"),
            )
        }
        ParameterError::NotFinite { name, value } => Problem::new(
            path,
            place,
            format!("{value}"),
            format!("a finite number for `{name}`"),
            "correct it",
        ),
    }
}

fn wrong_units(about: &About, read: &Read) -> Vec<Problem> {
    let mut problems = Vec::new();
    for parameter in about.parameters.iter() {
        let Some(given) = read.parameters.get(&*parameter.name) else {
            continue;
        };
        let Some(unit) = &given.unit else { continue };
        if dimension(unit) != dimension(&parameter.unit) {
            let (found, expected) = (format!("the unit \"{unit}\""), format!("\"{}\"", parameter.unit));
            let remedy = "convert the value to that unit and declare it";
            problems.push(Problem::new(&read.path, given.place.clone(), found, expected, remedy));
        }
    }
    problems
}

/// Reads a file, or the `campaign.toml` of a folder.
fn read(path: &Path) -> Result<Read, InputError> {
    let file = if path.is_dir() {
        path.join("campaign.toml")
    } else {
        path.to_path_buf()
    };
    let text = read_text(&file)?;
    let table = DeTable::parse(&text).map_err(|error| {
        let at = place(&text, error.span().map_or(0, |span| span.start), "");
        Problem::new(&file, at, error.message(), "TOML", "see https://toml.io for its syntax")
    })?;
    let mut problems = Vec::new();
    let mut values = Read {
        path: file.clone(),
        ..Read::default()
    };
    for (key, value) in table.get_ref().iter() {
        let key_place = place(&text, key.span().start, key.get_ref());
        let section = match key.get_ref().as_ref() {
            "parameters" => &mut values.parameters,
            "vehicle" => &mut values.vehicle,
            name if NEIGHBOURS.contains(&name) => continue,
            name => {
                let remedy = "put parameters under [parameters] and facts of the vehicle under [vehicle]";
                problems.push(Problem::new(
                    &file,
                    key_place,
                    format!("`{name}`"),
                    "[parameters] or [vehicle]",
                    remedy,
                ));
                continue;
            }
        };
        section_values(&file, &text, key.get_ref(), value, section, &mut problems);
    }
    if !table.get_ref().contains_key("parameters") && problems.is_empty() {
        let remedy = "write the values below a line [parameters]";
        problems.push(Problem::new(
            &file,
            Place::File,
            "no [parameters]",
            "TOML with [parameters]",
            remedy,
        ));
    }
    InputError::unless_empty(problems, Some(values))
}

fn section_values(
    file: &Path,
    text: &str,
    section: &str,
    value: &Spanned<DeValue>,
    into: &mut BTreeMap<String, Given>,
    problems: &mut Vec<Problem>,
) {
    let Some(entries) = value.get_ref().as_table() else {
        let at = place(text, value.span().start, section);
        let remedy = format!("write `[{section}]` on a line and the values below it");
        return problems.push(Problem::new(
            file,
            at,
            value.get_ref().type_str(),
            "a table of values",
            remedy,
        ));
    };
    for (name, entry) in entries.iter() {
        let at = place(text, name.span().start, &format!("{section}.{}", name.get_ref()));
        let (number, unit) = match entry.get_ref().as_table() {
            Some(table) => (
                table.get("value").map(Spanned::get_ref),
                table.get("unit").and_then(|u| u.get_ref().as_str()),
            ),
            None => (Some(entry.get_ref()), None),
        };
        match number.and_then(finite) {
            Some(value) => {
                into.insert(
                    name.get_ref().to_string(),
                    Given {
                        value,
                        unit: unit.map(String::from),
                        place: at,
                    },
                );
            }
            None => {
                let found = number.map_or("no `value`", |v| v.type_str());
                let remedy = "write a finite number in SI units";
                problems.push(Problem::new(file, at, found, "a number", remedy));
            }
        }
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

fn place(text: &str, offset: usize, key: &str) -> Place {
    let before = &text[..offset.min(text.len())];
    let line_start = before.rfind('\n').map_or(0, |at| at + 1);
    Place::Key(
        before.matches('\n').count() + 1,
        before[line_start..].chars().count() + 1,
        key.into(),
    )
}
