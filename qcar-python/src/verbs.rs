//! The verbs of the command line on a campaign, for Python. Results are passed as the JSON of `docs/json.md`, with
//! arrays in addition.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use numpy::{Complex64, IntoPyArray, PyArray1};
use pyo3::prelude::*;
use qcar::catalogue;
use qcar::failure::Failure;
use qcar::parameters::{self, FileExtras, Setting};
use qcar::verbs::{discover, fit, simulate};
use qcar_dsl::response::Wanted;
use qcar_runtime::campaign::{Campaign, Role};
use qcar_runtime::discover::numbers::Numbers;

use crate::errors;
use crate::long::long;

/// Names of the shipped models.
#[pyfunction]
pub fn models() -> Vec<&'static str> {
    catalogue::names().collect()
}

type RatioOfRun<'py> = (
    String,
    &'static str,
    String,
    bool,
    Bound<'py, PyArray1<f64>>,
    Bound<'py, PyArray1<Complex64>>,
    Bound<'py, PyArray1<Complex64>>,
    Bound<'py, PyArray1<f64>>,
);

type Correlations = Vec<(String, String, f64)>;

/// JSON, ratios (run, role, channel, fitted, frequency, measured, model, relative variance), correlations, and a
/// figure.
type FitOfCampaign<'py> = (String, Vec<RatioOfRun<'py>>, Correlations, String);

/// A model fitted to the runs of a campaign.
#[pyfunction]
pub fn fit_campaign<'py>(
    py: Python<'py>,
    campaign: PathBuf,
    model: Option<String>,
    starts: Option<u16>,
    channels: Vec<String>,
    free: Vec<String>,
    fix: Vec<String>,
) -> PyResult<FitOfCampaign<'py>> {
    let choices = fit::Choices {
        model,
        starts,
        channels,
        free,
        fix,
        all_runs: false,
        profile: Vec::new(),
        bootstrap: None,
    };
    let fit = || refuse_nonlinear(&campaign, choices.model.as_deref()).and_then(|()| fit::fit(&campaign, &choices));
    let fitted = long(py, fit)?.map_err(errors::of_campaign)?;
    let ratios = fitted.ratios().into_iter().map(|own| ratio(py, own)).collect();
    let correlations = fitted.fit.all_correlations.iter();
    let correlations = correlations.map(|own| (own.between.0.clone(), own.between.1.clone(), own.value));
    Ok((fitted.json(), ratios, correlations.collect(), fitted.figure()))
}

/// # Errors
/// Fails for a nonlinear model, whose transmissibilities hold for one level only.
fn refuse_nonlinear(campaign: &Path, model: Option<&str>) -> Result<(), Failure> {
    let model = catalogue::of_campaign(&Campaign::open(campaign)?, model, Wanted::Nothing)?;
    let about = model.about();
    let refused = || {
        let sentence = "is nonlinear, and this fit is to transmissibilities of a linear one; fit it with `qcar fit`, or ask `discover`";
        Err(Failure::Input(format!("model `{}` {sentence}", about.name)))
    };
    if about.linear { Ok(()) } else { refused() }
}

fn ratio<'py>(py: Python<'py>, of: fit::Ratio<'_>) -> RatioOfRun<'py> {
    let measured = of.observation;
    (
        of.run.to_string(),
        if of.role == Role::Fit { "fit" } else { "held_out" },
        measured.channel.name.to_string(),
        measured.fitted && of.role == Role::Fit,
        measured.frequency.clone().into_pyarray(py),
        measured.value.clone().into_pyarray(py),
        of.fitted.into_pyarray(py),
        measured.relative_variance.clone().into_pyarray(py),
    )
}

/// A name with its unit and samples.
type Signal<'py> = (String, String, Bound<'py, PyArray1<f64>>);

/// A run: its name, times, and signals.
type HistoryOfRun<'py> = (String, Bound<'py, PyArray1<f64>>, Vec<Signal<'py>>);

/// JSON, and the time histories of all runs.
#[pyfunction]
pub fn simulate_campaign<'py>(
    py: Python<'py>,
    campaign: PathBuf,
    model: Option<String>,
    params: Option<PathBuf>,
    values: Vec<(String, f64)>,
    variant: &str,
) -> PyResult<(String, Vec<HistoryOfRun<'py>>)> {
    let choices = simulate::Choices {
        model,
        params,
        set: values.iter().map(|(name, value)| Setting::new(name, *value)).collect(),
        variant: variant_named(variant)?,
    };
    let simulated = long(py, || simulate::simulate(&campaign, &choices))?.map_err(errors::of_campaign)?;
    let histories = simulated.histories().into_iter().map(|own| {
        let signals = own.channels.into_iter();
        let signals = signals.map(|signal| (signal.name, signal.unit, signal.samples.to_vec().into_pyarray(py)));
        (own.name, own.time.into_pyarray(py), signals.collect())
    });
    Ok((simulated.json(), histories.collect()))
}

/// Variant of a model.
///
/// # Errors
/// Fails if the name is none of the three.
pub fn variant_named(name: &str) -> PyResult<simulate::VariantName> {
    match name {
        "complete" => Ok(simulate::VariantName::Complete),
        "locked" => Ok(simulate::VariantName::Locked),
        "vertical" => Ok(simulate::VariantName::Vertical),
        other => {
            let sentence = format!("`variant` is {other:?}; write \"complete\", \"locked\" or \"vertical\"");
            Err(errors::of_parameters(sentence))
        }
    }
}

/// JSON, the text of the model with the findings, the values of its parameters, the answer in words, and a figure.
type Found = (String, Option<String>, Vec<(String, f64)>, String, String);

/// Searches for the effects that the model of a campaign lacks.
#[pyfunction]
pub fn discover_in_campaign(py: Python<'_>, campaign: PathBuf, model: Option<String>) -> PyResult<Found> {
    let search = || discover::discover(&campaign, model.as_deref(), None, Numbers::default());
    let answer = long(py, search)?.map_err(errors::of_campaign)?;
    let model = answer.model_text().map(String::from);
    Ok((
        answer.json(),
        model,
        answer.values().to_vec(),
        answer.text(),
        answer.figure(),
    ))
}

/// The vehicle data and the parameter values in a file or campaign.
#[pyfunction]
pub fn read_values(path: PathBuf) -> PyResult<(BTreeMap<String, f64>, BTreeMap<String, f64>)> {
    let read = |path: &Path| -> Result<_, Failure> {
        let (beside, all) = (FileExtras::read(path)?, parameters::given(path)?);
        Ok((all, beside.vehicle))
    };
    read(&path).map_err(errors::of_campaign)
}
