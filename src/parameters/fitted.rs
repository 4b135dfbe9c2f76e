//! The results of `qcar fit`: `fit.json`, with values and standard errors. `study.json` contains them too.

use std::collections::BTreeMap;
use std::path::Path;

use qcar_runtime::ensemble::{Estimate, Posterior};
use qcar_runtime::error::{InputError, Place, Problem};
use qcar_runtime::syntax;
use serde::Deserialize;
use serde_json::Value;

use super::file::{ParameterFile, Stated};
use crate::files::read_text;

/// The relevant contents of the file.
#[derive(Deserialize)]
pub(super) struct Answer {
    /// The name of the model.
    pub model: String,
    parameters: BTreeMap<String, Parameter>,
    all_correlations: Option<Vec<Correlation>>,
}

#[derive(Deserialize)]
struct Correlation {
    between: (String, String),
    value: f64,
}

#[derive(Deserialize)]
struct Parameter {
    value: f64,
    unit: String,
    stderr: Option<f64>,
    range: Option<(f64, f64)>,
    tied_to: Option<String>,
}

impl Answer {
    /// Reads a file.
    ///
    /// # Errors
    /// Fails if the file cannot be read, is not JSON, or is not the result of a fit.
    pub fn read(path: &Path) -> Result<Self, InputError> {
        let text = read_text(path)?;
        let json: Value = serde_json::from_str(&text).map_err(|error| {
            let remedy = "create the file again with `qcar fit --out`";
            syntax::of_json(path, &text, &error, remedy)
        })?;
        let fit = json.get("fit").unwrap_or(&json);
        Answer::deserialize(fit).map_err(|error| {
            let remedy = "give the fit.json of `qcar fit --out`, or a TOML file with [parameters]";
            let expected = "the answer of a fit, with its model and parameters";
            let (found, _) = syntax::words(&error.to_string());
            Problem::new(path, Place::File, found, expected, remedy).into()
        })
    }

    /// Correlations of pairs of estimates.
    pub fn correlations(&self) -> Vec<((String, String), f64)> {
        let pairs = self.all_correlations.iter().flatten();
        pairs.map(|own| (own.between.clone(), own.value)).collect()
    }

    /// The joint distribution of all estimates that have a standard error.
    ///
    /// # Errors
    /// Fails if the fit gives no distribution.
    pub fn posterior(&self, path: &Path) -> Result<Posterior, InputError> {
        let wrong = |found: String| {
            let expected = "estimates with standard errors and all correlations";
            let remedy = "repeat the fit with `qcar fit --out`";
            Problem::new(path, Place::File, found, expected, remedy)
        };
        let correlations = self.all_correlations.as_ref();
        let correlations = correlations.ok_or_else(|| wrong("no `all_correlations`".into()))?;
        let estimates: Vec<Estimate> = self.parameters.iter().filter_map(estimate).collect();
        if estimates.is_empty() {
            return Err(wrong("no parameter with a standard error".into()).into());
        }
        let place = |name: &String| estimates.iter().position(|own| own.name == *name);
        let pair = |own: &Correlation| Some((place(&own.between.0)?, place(&own.between.1)?, own.value));
        let correlations: Vec<_> = correlations.iter().filter_map(pair).collect();
        Posterior::new(estimates, &correlations).map_err(|error| wrong(error.to_string()).into())
    }

    /// The values, without those of tied parameters.
    pub fn parameters(&self, path: &Path) -> ParameterFile {
        let own = self.parameters.iter().filter(|(_, own)| own.tied_to.is_none());
        let stated = own.map(|(name, own)| {
            let stated = Stated {
                value: own.value,
                unit: Some(own.unit.clone()),
                stderr: own.stderr,
                file: path.into(),
                place: Place::Name(format!("parameters.{name}")),
            };
            (name.clone(), stated)
        });
        ParameterFile {
            path: path.into(),
            parameters: stated.collect(),
            ..ParameterFile::default()
        }
    }
}

/// A parameter with a standard error, and the bounds of its fit.
fn estimate((name, own): (&String, &Parameter)) -> Option<Estimate> {
    Some(Estimate {
        name: name.clone(),
        value: own.value,
        stderr: own.stderr.filter(|error| *error > 0.0)?,
        range: own.range.unwrap_or((f64::NEG_INFINITY, f64::INFINITY)),
    })
}
