//! A description of a file of results, written beside it: the same command resumes the file, any other is refused.

use std::path::{Path, PathBuf};

use qcar_runtime::ensemble::{Design, Ensemble};
use qcar_runtime::error::{InputError, Place, Problem};
use qcar_runtime::model::Model;
use serde::Serialize;
use serde_json::Value;

use super::part::Part;
use super::sink::unfinished;
use crate::files::{is_in_use, put};
use crate::json::Ordered;

/// All inputs on which a row depends.
#[derive(Serialize)]
pub(super) struct Ledger {
    qcar: &'static str,
    model: String,
    /// Hash of the generated code of the model.
    program: String,
    /// Values of all parameters that do not vary.
    parameters: Ordered<f64>,
    design: &'static str,
    sets: u64,
    seed: u64,
    /// Bounds of the varied parameters; for a posterior, its ranges.
    varied: Ordered<(f64, f64)>,
    posterior: Option<PosteriorDescription>,
    rides: Vec<(f64, f64)>,
    /// Radius and static deflection of the tyre, and the load on it.
    tyre: Option<[f64; 3]>,
    part: String,
    pub rows: u64,
    columns: Vec<String>,
}

/// Description of a posterior.
#[derive(Serialize)]
struct PosteriorDescription {
    /// Values and standard errors.
    estimates: Vec<(f64, f64)>,
    /// The first draw, which depends on the correlations.
    first: Vec<f64>,
}

/// State of a file of results.
#[derive(Debug, PartialEq)]
pub(super) enum FileState {
    /// The file is complete.
    Done,
    /// The file is incomplete or missing.
    Open,
}

/// Inputs of a design, besides its axes.
pub(super) struct Choice<'a> {
    /// Its name on the command line.
    pub scheme: &'static str,
    /// Seed.
    pub seed: u64,
    /// The part.
    pub part: Part,
    /// Version of the program that computes them.
    pub program: &'a str,
    /// Notices on the values, as sentences.
    pub notices: &'a [String],
}

impl Ledger {
    /// The description of an ensemble.
    pub fn new<M: Model + ?Sized>(of: &Ensemble<'_, M>, choice: &Choice, columns: &[String], rows: u64) -> Self {
        let about = of.model.about();
        let name = |place: usize| about.parameters[place].name.to_string();
        let values = of.values.as_slice().iter().enumerate();
        let track = of.track.as_ref();
        let rides = track.map_or(&[][..], |track| &track.rides);
        let axes = of.design.axes().iter();
        Ledger {
            qcar: env!("CARGO_PKG_VERSION"),
            model: about.name.to_string(),
            program: format!("{:016x}", fingerprint(choice.program)),
            parameters: values.map(|(place, value)| (name(place), *value)).collect(),
            design: choice.scheme,
            sets: of.design.count().unwrap_or(u64::MAX),
            seed: choice.seed,
            varied: axes.map(|axis| (name(axis.parameter), axis.range)).collect(),
            posterior: posterior(&of.design),
            rides: rides.iter().map(|ride| (ride.height, ride.speed)).collect(),
            tyre: track.map(|track| [track.tyre.radius(), track.tyre.static_deflection(), track.load]),
            part: format!("{}/{}", choice.part.number, choice.part.of),
            rows,
            columns: columns.to_vec(),
        }
    }

    /// Checks the file at a path. If rows are missing, writes the description beside it.
    ///
    /// # Errors
    /// Fails if the file has other results, or if it cannot be written.
    pub fn file_state(&self, path: &Path) -> Result<FileState, InputError> {
        let beside = beside(path);
        let own = serde_json::to_value(self).expect("keys are strings");
        let there = std::fs::read_to_string(&beside).ok();
        let there: Option<Value> = there.and_then(|text| serde_json::from_str(&text).ok());
        let results = [path.to_path_buf(), unfinished(path)];
        if let Some(file) = results.iter().find(|file| file.exists()) {
            refuse_others(file, &own, there.as_ref())?;
        }
        if path.exists() {
            return Ok(FileState::Done);
        }
        // The description of results that were removed may be replaced.
        let is_description = there.is_some_and(|there| there.get("columns").is_some());
        if is_in_use(&beside) && !is_description {
            let expected = "a name for the description of the results that is not in use";
            let remedy = "choose another file, or move this one away";
            return Err(Problem::new(beside, Place::File, "a file of another origin", expected, remedy).into());
        }
        let folder = path.parent().unwrap_or(Path::new(""));
        let name = beside.file_name().and_then(|name| name.to_str()).unwrap_or_default();
        put(folder, name, &self.text())?;
        Ok(FileState::Open)
    }

    /// The text of the description.
    pub fn text(&self) -> String {
        let mut text = serde_json::to_string_pretty(self).expect("keys are strings");
        text.push('\n');
        text
    }
}

/// Path of the description.
fn beside(path: &Path) -> PathBuf {
    let mut name = path.as_os_str().to_owned();
    name.push(".design.json");
    name.into()
}

fn refuse_others(file: &Path, own: &Value, there: Option<&Value>) -> Result<(), InputError> {
    let differs = |there: &Value| {
        let keys = own.as_object()?.iter();
        let mut differing = keys.filter(|(key, value)| there.get(key) != Some(value));
        let (key, value) = differing.next()?;
        let there = there.get(key).unwrap_or(&Value::Null);
        let (key, there, own) = first_difference(key.clone(), there, value);
        Some((key, shown(there), shown(own)))
    };
    let (found, expected) = match there.map(differs) {
        Some(None) => return Ok(()),
        Some(Some((key, there, own))) => (
            format!("results of another command, whose `{key}` is {there}"),
            format!("a new file, or results whose `{key}` is {own}"),
        ),
        None => (
            "a file without its .design.json".into(),
            "a new file, or one that this command has started".into(),
        ),
    };
    let remedy = "choose another file, or remove it";
    Err(Problem::new(file, Place::File, found, expected, remedy).into())
}

/// Most characters of a value in a message.
const LONGEST: usize = 120;

/// The first difference of two values, with its key: of tables and long lists, that of their first entry that differs.
fn first_difference<'a>(key: String, there: &'a Value, own: &'a Value) -> (String, &'a Value, &'a Value) {
    let entry = match (there, own) {
        (Value::Array(there), Value::Array(own)) if is_long(there) || is_long(own) => {
            let mut pairs = there.iter().zip(own).enumerate();
            let differing = pairs.find(|(_, (there, own))| there != own);
            differing.map(|(at, (there, own))| (format!("{key}[{at}]"), there, own))
        }
        (Value::Object(there), Value::Object(own)) => {
            let missing = there.iter().find(|(name, _)| !own.contains_key(*name));
            let missing = missing.map(|(name, value)| (format!("{key}.{name}"), value, &Value::Null));
            let differing = own.iter().find(|(name, value)| there.get(*name) != Some(*value));
            let differing = differing
                .map(|(name, value)| (format!("{key}.{name}"), there.get(name).unwrap_or(&Value::Null), value));
            differing.or(missing)
        }
        _ => None,
    };
    match entry {
        Some((key, there, own)) => first_difference(key, there, own),
        None => (key, there, own),
    }
}

fn is_long(list: &[Value]) -> bool {
    list.iter().map(|value| value.to_string().len()).sum::<usize>() > LONGEST
}

/// A value for a message; of a long one, its beginning.
fn shown(value: &Value) -> String {
    match value.to_string() {
        _ if value.is_null() => "absent".into(),
        text if text.chars().count() > LONGEST => {
            let beginning: String = text.chars().take(LONGEST).collect();
            format!("{beginning}…")
        }
        text => text,
    }
}

fn posterior(design: &Design) -> Option<PosteriorDescription> {
    let estimates = design.posterior()?.estimates().iter();
    Some(PosteriorDescription {
        estimates: estimates.map(|own| (own.value, own.stderr)).collect(),
        first: design.set(0),
    })
}

/// FNV-1a of 64 bits (Fowler, Noll and Vo).
fn fingerprint(text: &str) -> u64 {
    let start = 0xcbf2_9ce4_8422_2325;
    let next = |hash: u64, byte: u8| (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3);
    text.bytes().fold(start, next)
}
