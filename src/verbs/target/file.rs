//! `targets.toml`: targets of an axle, and the parameters that may change.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use qcar_runtime::campaign::Declared;
use qcar_runtime::error::{InputError, Place, Problem};
use serde::Deserialize;
use toml::Spanned;

use crate::catalogue;
use crate::files::read_text;
use crate::roads;

/// The file as it is written.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct File {
    /// Name or path of a model, folder of a campaign or of a fit's results.
    pub subject: Spanned<String>,
    /// Start values, facts of the vehicle and cleat runs.
    pub campaign: Option<PathBuf>,
    /// Values above those.
    pub params: Option<PathBuf>,
    /// Roads beside the cleats.
    #[serde(default)]
    pub roads: Vec<Spanned<String>>,
    #[serde(default, rename = "target")]
    pub targets: Vec<Target>,
    #[serde(default, rename = "parameter")]
    pub parameters: Vec<Parameter>,
    #[serde(default, rename = "coupling")]
    pub couplings: Vec<Coupling>,
    pub front: Option<Front>,
    pub space: Option<Space>,
    pub uncertainty: Option<Uncertainty>,
}

/// A limit or a wish.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Target {
    pub metric: Spanned<String>,
    pub at_most: Option<Spanned<Amount>>,
    pub at_least: Option<Spanned<Amount>>,
    /// In place of both.
    pub equals: Option<Spanned<Amount>>,
    /// Names of runs, in which a * stands for any letters; all where there are none.
    pub runs: Option<Spanned<Vec<String>>>,
    /// What it costs to miss it by its own size, in place of having to be met.
    pub wish: Option<Spanned<f64>>,
}

/// A parameter that may move.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Parameter {
    pub name: Spanned<String>,
    pub range: Spanned<[Amount; 2]>,
    pub step: Option<Spanned<Amount>>,
    pub cost: Option<Spanned<f64>>,
}

/// What must hold between parameters.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Coupling {
    /// This parameter
    pub parameter: Option<Spanned<String>>,
    /// moves with this one,
    pub follows: Option<Spanned<String>>,
    /// times so much, in place of what they have to each other today.
    pub factor: Option<f64>,
    /// Or the sum of these, each times a number,
    pub sum: Option<Spanned<BTreeMap<String, f64>>>,
    /// is at most so much, SI.
    pub at_most: Option<f64>,
}

/// Metrics of which none can be bettered alone.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Front {
    #[serde(default)]
    pub smallest: Vec<Spanned<String>>,
    #[serde(default)]
    pub largest: Vec<Spanned<String>>,
    pub generations: Option<usize>,
}

/// The box of intervals.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Space {
    /// Of a good design in it.
    pub probability: Option<Spanned<f64>>,
    /// Pairs of parameters whose plane is drawn.
    #[serde(default)]
    pub cuts: Vec<Spanned<[String; 2]>>,
}

/// What is not known of the parameters.
#[derive(Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Uncertainty {
    /// Whether the errors of the subject's fit count; they do where it has some.
    pub fit: Option<Spanned<bool>>,
    /// Parts that lie evenly within so many percent of their values.
    #[serde(default)]
    pub tolerances: BTreeMap<String, Spanned<String>>,
    /// What changes by so many percent of its value per kelvin.
    #[serde(default)]
    pub per_kelvin: BTreeMap<String, Spanned<String>>,
    /// Kelvin above the temperature for which the values hold.
    pub temperature: Option<Spanned<[f64; 2]>>,
    /// With which each target is to hold at the design.
    pub probability: Option<Spanned<f64>>,
}

/// A number in SI, or a text of a number with its unit or with `%`.
#[derive(Clone, Debug, Deserialize)]
#[serde(untagged)]
pub(super) enum Amount {
    Number(f64),
    Text(String),
}

/// What an amount is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Meant {
    /// In SI.
    Value(f64),
    /// A part of what it is today.
    OfToday(f64),
}

impl Amount {
    /// Of something in a unit (SI): a number, a quantity of that kind, or percent of today's value.
    ///
    /// # Errors
    /// What else it could be, in words.
    pub fn of(&self, unit: &str) -> Result<Meant, String> {
        match self {
            Amount::Number(value) if value.is_finite() => Ok(Meant::Value(*value)),
            Amount::Number(value) => Err(format!("{value}")),
            Amount::Text(text) => {
                let part = text
                    .trim()
                    .strip_suffix('%')
                    .and_then(|part| part.trim_end().parse::<f64>().ok());
                if let Some(part) = part.filter(|part| part.is_finite()) {
                    return Ok(Meant::OfToday(part / 100.0));
                }
                let plain = text
                    .trim()
                    .strip_suffix(unit)
                    .and_then(|number| number.trim_end().parse::<f64>().ok());
                let quantity = Declared::quantity(text).filter(|(_, declared)| declared.is_like(unit));
                let value = plain
                    .or(quantity.map(|(value, _)| value))
                    .filter(|value| value.is_finite());
                value.map(Meant::Value).ok_or_else(|| format!("\"{text}\""))
            }
        }
    }
}

/// A file with its text, so that problems can say where they are.
pub(super) struct Read {
    pub path: PathBuf,
    text: String,
    pub file: File,
}

impl Read {
    /// Reads it.
    ///
    /// # Errors
    /// A file that cannot be read, is not TOML, or has unknown keys.
    pub fn of(path: &Path) -> Result<Self, InputError> {
        let text = read_text(path)?;
        match toml::from_str(&text) {
            Ok(file) => Ok(Self {
                path: path.into(),
                text,
                file,
            }),
            Err(error) => {
                let start = error.span().map_or(0, |span| span.start);
                let remedy = "docs/targets.md describes every key";
                let found = error.message().lines().collect::<Vec<_>>().join(" ");
                Err(Problem::new(
                    path,
                    Place::in_text(&text, start, ""),
                    found,
                    "a file of targets",
                    remedy,
                )
                .into())
            }
        }
    }

    /// A problem at what stands at a span.
    pub fn problem<T>(&self, at: &Spanned<T>, key: &str, found: &str, expected: &str, remedy: &str) -> Problem {
        Problem::new(
            &self.path,
            Place::in_text(&self.text, at.span().start, key),
            found,
            expected,
            remedy,
        )
    }

    /// The subject: a shipped model by name, anything else relative to the folder of the file.
    pub fn subject(&self) -> String {
        let own = self.file.subject.get_ref();
        let path = self.beside(Path::new(own));
        if catalogue::is_shipped(own) {
            own.clone()
        } else {
            path.display().to_string()
        }
    }

    /// The roads, whose files are relative to the folder of this one.
    ///
    /// # Errors
    /// Every one that is none.
    pub fn roads(&self) -> Result<Vec<roads::Asked>, InputError> {
        let (mut roads, mut problems) = (Vec::new(), Vec::new());
        for own in &self.file.roads {
            match own.get_ref().parse::<roads::Asked>() {
                Ok(road) => roads.push(road.asked_in(&self.path)),
                Err(_) => {
                    let found = format!("`{}`", own.get_ref());
                    let remedy = "write it as \"C@60km/h\"";
                    problems.push(self.problem(own, "roads", &found, roads::EXPECTED, remedy));
                }
            }
        }
        InputError::unless_empty(problems, Some(roads))
    }

    /// A path as the file means it: relative to its folder.
    pub fn beside(&self, path: &Path) -> PathBuf {
        self.path.parent().unwrap_or(Path::new("")).join(path)
    }
}

#[cfg(test)]
mod tests {
    use super::{Amount, Meant};

    #[test]
    fn an_amount_is_si_a_quantity_or_a_part_of_today() {
        let text = |text: &str| Amount::Text(text.into());
        assert_eq!(Amount::Number(2.0).of("m"), Ok(Meant::Value(2.0)));
        assert_eq!(text("187 N/mm").of("N/m"), Ok(Meant::Value(187e3)));
        assert_eq!(text("3 m/s^1.75").of("m/s^1.75"), Ok(Meant::Value(3.0)));
        assert_eq!(text("90 %").of("m"), Ok(Meant::OfToday(0.9)));
        assert!(text("2 kg").of("m").is_err());
    }
}
