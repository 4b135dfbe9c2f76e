//! Sweeps and time histories, replayed through the model and compared with the measurement.

use qcar_runtime::campaign::{Campaign, Role, Run, Test};
use qcar_runtime::discover::Evidence;
use qcar_runtime::discover::noise::Nuisance;
use qcar_runtime::discover::observe::{PredictError, Stimulus, TestConditions, replayed};
use qcar_runtime::discover::posterior::estimate_initial_states;
use qcar_runtime::error::InputError;
use qcar_runtime::model::Model;
use qcar_runtime::response::parameters::Values;
use qcar_runtime::simulate::Accuracy;
use qcar_runtime::transmissibility::{Point, signal};
use serde::Serialize;

use crate::failure::Failure;
use qcar_runtime::mean::{deviation, rms};

/// A run, measured and simulated.
pub(super) struct Record {
    /// Its file, as named in the campaign.
    pub run: String,
    /// Sample rate, Hz.
    pub rate: f64,
    /// Time of the first sample, s.
    pub start: f64,
    /// Measured and simulated samples of each sensor, SI.
    pub signals: Vec<(Point, [Vec<f64>; 2])>,
    /// Error of each sensor.
    pub errors: Vec<RecordError>,
}

/// Error of a simulated signal.
#[derive(Serialize)]
pub(super) struct RecordError {
    /// File of the run.
    pub run: String,
    /// Role: `fit` or `held_out`.
    pub role: &'static str,
    /// The sensor, as location and axis.
    pub channel: String,
    /// Measured quantity.
    pub quantity: &'static str,
    /// Unit of both RMS values.
    pub unit: &'static str,
    /// RMS of the measured signal without its mean.
    pub measured_rms: f64,
    /// RMS of the difference.
    pub rms_error: f64,
    /// NRMS: the second over the first.
    pub nrms: f64,
}

/// True for a run that is replayed.
fn is_record(run: &Run) -> bool {
    matches!(run.test, Test::Sweep(_) | Test::TimeHistory(_))
}

/// Replays every sweep and time history of a campaign; empty without any. Also says which recorded signals the model
/// lacks.
///
/// # Errors
/// Fails if a run cannot be read or has no data for the model.
pub(super) fn records(
    campaign: &Campaign,
    model: &dyn Model,
    values: &Values,
) -> Result<(Vec<Record>, Vec<String>), Failure> {
    if !campaign.runs.iter().any(is_record) {
        return Ok((Vec::new(), Vec::new()));
    }
    let mut alike = campaign.clone();
    alike.runs.retain(is_record);
    // No run is held out here: each is simulated from its own initial state to its end.
    alike.runs.iter_mut().for_each(|run| run.role = Role::Fit);
    let evidence = Evidence::from_campaign(&alike, model.about())?.integrated_with(Accuracy::HIGH);
    let simulated = simulated(model, values, &evidence)
        .map_err(|error| Failure::Input(format!("{}: {error}\n", campaign.manifest().display())))?;
    let mut records = Vec::new();
    for (own, simulated) in evidence.runs.iter().zip(simulated) {
        let run = campaign.runs.iter().find(|run| run.name == own.name);
        records.push(record(
            campaign,
            (run.expect("the evidence is of this campaign"), &own.stimulus),
            simulated,
        )?);
    }
    Ok((records, evidence.notices))
}

/// The samples of each sensor of a run.
type Signals = Vec<(Point, Vec<f64>)>;

/// Simulated samples of the sensors of each run.
fn simulated(model: &dyn Model, values: &Values, evidence: &Evidence) -> Result<Vec<Signals>, PredictError> {
    let nuisance = Nuisance::of(evidence);
    let right = vec![0.0; nuisance.count()];
    let mut conditions = TestConditions::default();
    let sensors = (&nuisance, right.as_slice());
    estimate_initial_states(
        model,
        values,
        sensors,
        evidence,
        |run| run.role == Role::Fit,
        &mut conditions,
    )?;
    let runs = 0..evidence.runs.len();
    runs.map(|run| replayed(model, values, &conditions, evidence, run))
        .collect()
}

/// Compares a run over the same band and samples as a search does.
fn record(
    campaign: &Campaign,
    (run, stimulus): (&Run, &Stimulus),
    simulated: Vec<(Point, Vec<f64>)>,
) -> Result<Record, InputError> {
    let history = campaign.history(run)?;
    let cut = stimulus.cut();
    let (mut signals, mut errors) = (Vec::new(), Vec::new());
    for (sensor, simulated) in simulated {
        let measured = stimulus.of_band(&signal(&history, &sensor)?);
        let inside = |signal: Vec<f64>| signal[cut..signal.len() - cut].to_vec();
        let (measured, simulated) = (inside(measured), inside(simulated));
        errors.push(error(run, &sensor, &measured, &simulated));
        signals.push((sensor, [measured, simulated]));
    }
    Ok(Record {
        run: run.name.clone(),
        rate: history.sample_rate,
        start: history.start + cut as f64 / history.sample_rate,
        signals,
        errors,
    })
}

fn error(run: &Run, sensor: &Point, measured: &[f64], simulated: &[f64]) -> RecordError {
    let measured_rms = deviation(measured);
    let rms_error = rms(measured
        .iter()
        .zip(simulated)
        .map(|(measured, simulated)| simulated - measured));
    RecordError {
        run: run.name.clone(),
        role: if run.role == Role::Fit { "fit" } else { "held_out" },
        channel: format!("{}_{}", sensor.location, sensor.axis.name()),
        quantity: sensor.quantity.name(),
        unit: sensor.unit(),
        measured_rms,
        rms_error,
        nrms: rms_error / measured_rms,
    }
}
