//! `targets.toml`: targets of an axle, and the parameters that may change.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use qcar_runtime::campaign::Declared;
use qcar_runtime::error::{InputError, Place, Problem};
use qcar_runtime::syntax;
use serde::Deserialize;
use toml::Spanned;

use crate::catalogue;
use crate::files::read_text;
use crate::roads;

/// The contents of the file.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct File {
    /// Name or path of a model, or folder of a campaign or of a fit's results.
    pub subject: Spanned<String>,
    /// Campaign with start values, vehicle data and cleat runs.
    pub campaign: Option<PathBuf>,
    /// Files with values that take precedence over those.
    pub params: Option<PathBuf>,
    /// Roads in addition to the cleats.
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
    /// An equality, in place of both limits.
    pub equals: Option<Spanned<Amount>>,
    /// Names of runs, in which a * means any characters; all runs without names.
    pub runs: Option<Spanned<Vec<String>>>,
    /// For a wish, the cost of missing it by its own size; a target without it must be met.
    pub wish: Option<Spanned<f64>>,
}

/// A parameter that may change.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Parameter {
    pub name: Spanned<String>,
    pub range: Spanned<[Amount; 2]>,
    pub step: Option<Spanned<Amount>>,
    pub cost: Option<Spanned<f64>>,
}

/// A constraint between parameters.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Coupling {
    /// Name of the parameter that follows another.
    pub parameter: Option<Spanned<String>>,
    /// Name of the parameter that it follows.
    pub follows: Option<Spanned<String>>,
    /// Factor between them; the present ratio by default.
    pub factor: Option<f64>,
    /// Parameters of a sum with their factors.
    pub sum: Option<Spanned<BTreeMap<String, f64>>>,
    /// Largest value of the sum, SI.
    pub at_most: Option<f64>,
}

/// The metrics of the Pareto front.
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
    /// Probability of a good design in the box.
    pub probability: Option<Spanned<f64>>,
    /// Pairs of parameters for slices through the design space.
    #[serde(default)]
    pub cuts: Vec<Spanned<[String; 2]>>,
}

/// Uncertainty of the parameters.
#[derive(Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Uncertainty {
    /// True if the errors of the subject's fit are included; by default they are, if it has any.
    pub fit: Option<Spanned<bool>>,
    /// Tolerances: uniform distributions within this percentage of the values.
    #[serde(default)]
    pub tolerances: BTreeMap<String, Spanned<String>>,
    /// Changes per kelvin, in percent of the values.
    #[serde(default)]
    pub per_kelvin: BTreeMap<String, Spanned<String>>,
    /// Range of the temperature, K above that for which the values hold.
    pub temperature: Option<Spanned<[f64; 2]>>,
    /// Required probability of each target at the design.
    pub probability: Option<Spanned<f64>>,
}

/// A number in SI, or a text of a number with its unit or with `%`.
#[derive(Clone, Debug, Deserialize)]
#[serde(untagged)]
pub(super) enum Amount {
    Number(f64),
    Text(String),
}

/// The kind of an amount.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum AmountKind {
    /// A number in SI.
    Value(f64),
    /// A fraction of the present value.
    OfToday(f64),
}

impl Amount {
    /// The value of an amount of a quantity with an SI unit: a number, a quantity of that kind, or percent of the
    /// present value.
    ///
    /// # Errors
    /// Fails with the expected form, in words.
    pub fn of(&self, unit: &str) -> Result<AmountKind, String> {
        match self {
            Amount::Number(value) if value.is_finite() => Ok(AmountKind::Value(*value)),
            Amount::Number(value) => Err(format!("{value}")),
            Amount::Text(text) => {
                let part = text
                    .trim()
                    .strip_suffix('%')
                    .and_then(|part| part.trim_end().parse::<f64>().ok());
                if let Some(part) = part.filter(|part| part.is_finite()) {
                    return Ok(AmountKind::OfToday(part / 100.0));
                }
                let plain = text
                    .trim()
                    .strip_suffix(unit)
                    .and_then(|number| number.trim_end().parse::<f64>().ok());
                let quantity = Declared::quantity(text).filter(|(_, declared)| declared.is_like(unit));
                let value = plain
                    .or(quantity.map(|(value, _)| value))
                    .filter(|value| value.is_finite());
                value.map(AmountKind::Value).ok_or_else(|| format!("\"{text}\""))
            }
        }
    }
}

/// A file with its text, so that problems have a position.
pub(super) struct Read {
    pub path: PathBuf,
    text: String,
    pub file: File,
}

impl Read {
    /// Reads a file.
    ///
    /// # Errors
    /// Fails if the file cannot be read, is not TOML, or has unknown keys.
    pub fn of(path: &Path) -> Result<Self, InputError> {
        let text = read_text(path)?;
        match toml::from_str(&text) {
            Ok(file) => Ok(Self {
                path: path.into(),
                text,
                file,
            }),
            Err(error) => {
                let remedy = "correct it; docs/targets.md describes every key";
                Err(syntax::of_toml(path, &text, &error, remedy).into())
            }
        }
    }

    /// A problem at a position in the text.
    pub fn problem<T>(&self, at: &Spanned<T>, key: &str, found: &str, expected: &str, remedy: &str) -> Problem {
        Problem::new(
            &self.path,
            Place::in_text(&self.text, at.span().start, key),
            found,
            expected,
            remedy,
        )
    }

    /// The subject: the name of a shipped model, or a path relative to the folder of the file.
    pub fn subject(&self) -> String {
        let own = self.file.subject.get_ref();
        let path = self.beside(Path::new(own));
        if catalogue::is_shipped(own) {
            own.clone()
        } else {
            path.display().to_string()
        }
    }

    /// The roads; paths are relative to the folder of the file.
    ///
    /// # Errors
    /// Fails with every text that is no road.
    pub fn roads(&self) -> Result<Vec<roads::RequestedRoad>, InputError> {
        let (mut roads, mut problems) = (Vec::new(), Vec::new());
        for own in &self.file.roads {
            match own.get_ref().parse::<roads::RequestedRoad>() {
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

    /// A path relative to the folder of the file.
    pub fn beside(&self, path: &Path) -> PathBuf {
        self.path.parent().unwrap_or(Path::new("")).join(path)
    }
}

#[cfg(test)]
mod tests {
    use super::{Amount, AmountKind};

    #[test]
    fn an_amount_is_si_a_quantity_or_a_part_of_today() {
        let text = |text: &str| Amount::Text(text.into());
        assert_eq!(Amount::Number(2.0).of("m"), Ok(AmountKind::Value(2.0)));
        assert_eq!(text("187 N/mm").of("N/m"), Ok(AmountKind::Value(187e3)));
        assert_eq!(text("3 m/s^1.75").of("m/s^1.75"), Ok(AmountKind::Value(3.0)));
        assert_eq!(text("90 %").of("m"), Ok(AmountKind::OfToday(0.9)));
        assert!(text("2 kg").of("m").is_err());
    }
}
