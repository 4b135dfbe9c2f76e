//! What a model says of the evidence, with its parameter Jacobian.

// Swept sines by frequency response.
mod linear;
// Swept sines by harmonic balance, where laws bend.
mod nonlinear;
// Recorded inputs at the nodes of an integration.
mod input;
// From one of them to the next.
mod stepper;
// A model driven by them.
mod replay;
// What sweeps add to the balance, since they never settle.
mod unsteady;
// Time histories.
mod history;
// Rides over an obstacle.
mod cleat;
// What a K&C rig moves, and what follows.
mod bench;
// Cycles of a K&C rig.
mod travel;

pub use unsteady::unsteady;

use nalgebra::Complex;
use rayon::prelude::*;
use thiserror::Error;

use super::evidence::{Evidence, Run, Stimulus, excitation_of};
use crate::campaign::Role;
use crate::model::Model;
use crate::response::parameters::{ParameterError, Values};
use crate::response::signal::SignalError;
use crate::simulate::SimulateError;
use crate::transmissibility::Point;

/// A parameter that may move.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Free {
    /// Its place among the parameters of the model; one that leads its ties.
    pub parameter: usize,
    /// Lowest value.
    pub lower: f64,
    /// Highest value.
    pub upper: f64,
}

/// What a model says of one series.
#[derive(Clone, Debug, PartialEq)]
pub struct Prediction {
    /// Place in [`Evidence::series`].
    pub series: usize,
    /// A value for each of the series.
    pub value: Vec<Complex<f64>>,
    /// For each free parameter the derivatives of the values.
    pub slopes: Vec<Vec<Complex<f64>>>,
    /// What a delay of sensors does to values over time; `None` where it only turns their phase, or nothing.
    pub delay: Option<Delay>,
    /// The derivatives of the values by the logarithm of the amplitude that drove the run; `None` where they do not
    /// depend on it.
    pub louder: Option<Vec<Complex<f64>>>,
    /// The derivatives of the values by the states of the model when the record begins, by their names; none where the
    /// prediction was not differentiated, or does not begin with a record.
    pub begun: Vec<(String, Vec<Complex<f64>>)>,
}

/// What errors of sensors change in a prediction itself, not only in what they show of it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Misread {
    /// How late the sensor of each series is, s; without entries none is.
    pub late: Vec<f64>,
    /// By what factor each run was driven harder than its reference shows; without entries none was.
    pub louder: Vec<f64>,
    /// For each run, which states began elsewhere than sensors saw them (or than at rest), and by how much, SI; without
    /// entries none did.
    pub begun: Vec<Vec<(String, f64)>>,
}

impl Misread {
    fn begun(&self, run: usize) -> &[(String, f64)] {
        self.begun.get(run).map_or(&[], Vec::as_slice)
    }

    fn louder(&self, run: usize) -> f64 {
        self.louder.get(run).copied().unwrap_or(1.0)
    }
}

/// What delays do to a series over time.
#[derive(Clone, Debug, PartialEq)]
pub struct Delay {
    /// The derivatives of the values by a delay (s) of their own sensor.
    pub slope: Vec<Complex<f64>>,
    /// Series of the same run, and which share of a delay of their sensors shifts the clock of the whole run.
    pub shares: Vec<(usize, f64)>,
}

impl Prediction {
    /// Adds what was found to be missing; nothing where nothing was.
    pub fn add(&mut self, missing: &[Complex<f64>]) {
        self.value
            .iter_mut()
            .zip(missing)
            .for_each(|(value, missing)| *value += missing);
    }
}

/// Why a model says nothing of the evidence.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum PredictError {
    /// A sensor measures what the model cannot give.
    #[error(transparent)]
    Signal(#[from] SignalError),
    /// No run may be fitted.
    #[error("no run may be fitted; give at least one with sensors at places of the model `role = \"fit\"`")]
    NothingToFit,
    /// The model gives no number anywhere near its start values.
    #[error("the model gives no finite response near its start values; give it other start values")]
    NoNumber,
    /// A parameter has no value.
    #[error("{}", .0.iter().map(ToString::to_string).collect::<Vec<_>>().join("; "))]
    Parameters(Vec<ParameterError>),
    /// What drove a run is no input of the model.
    #[error(
        "model `{model}` has no input `{location}`, which drives {run}; choose a model that has it, or leave the run out"
    )]
    NoInput {
        /// The model's name.
        model: String,
        /// What drives.
        location: String,
        /// The run's file.
        run: String,
    },
    /// The model cannot roll over the road.
    #[error("{run}: {reason}")]
    Ride {
        /// The run's file.
        run: String,
        /// Why.
        reason: SimulateError,
    },
}

/// Predicts all series of the runs of one role; differentiated along `free` and, where there is any, along the states with
/// which records begin.
///
/// # Errors
/// Where the model lacks what was measured.
pub fn predict(
    model: &dyn Model,
    values: &Values,
    free: &[Free],
    evidence: &Evidence,
    role: Role,
) -> Result<Vec<Prediction>, PredictError> {
    let misread = Misread::default();
    predict_sides(model, [values, values], &misread, free, evidence, &|run| {
        run.role == role
    })
}

/// The same of the runs that are `wanted`, of a car whose recorded side has parameters of its own (the second set): cleat
/// runs see these. Sensors are `misread`.
///
/// # Errors
/// As [`predict`].
pub fn predict_sides(
    model: &dyn Model,
    [values, side]: [&Values; 2],
    misread: &Misread,
    free: &[Free],
    evidence: &Evidence,
    wanted: &dyn Fn(&Run) -> bool,
) -> Result<Vec<Prediction>, PredictError> {
    let runs: Vec<usize> = (0..evidence.runs.len())
        .filter(|&run| wanted(&evidence.runs[run]))
        .collect();
    let of_runs = runs
        .into_par_iter()
        .map(|run| of_run(model, [values, side], misread, free, evidence, run));
    Ok(of_runs.collect::<Result<Vec<_>, _>>()?.into_iter().flatten().collect())
}

/// What the sensors of a run show, differentiated along the states of the model when its record begins alone.
///
/// # Errors
/// As [`predict`].
pub fn predict_begun(
    model: &dyn Model,
    values: &Values,
    misread: &Misread,
    evidence: &Evidence,
    run: usize,
) -> Result<Vec<Prediction>, PredictError> {
    history::history(model, values, misread, (&[], true), evidence, run)
}

/// What the sensors of a sweep or a time history would have recorded, sample by sample; nothing of any other run.
///
/// # Errors
/// As [`predict`].
pub fn replayed(
    model: &dyn Model,
    values: &Values,
    misread: &Misread,
    evidence: &Evidence,
    run: usize,
) -> Result<Vec<(Point, Vec<f64>)>, PredictError> {
    match &evidence.runs[run].stimulus {
        Stimulus::Sweep { .. } => unsteady::replayed(model, values, evidence, run),
        Stimulus::History { .. } => history::replayed(model, values, misread, evidence, run),
        Stimulus::Cleat(_) | Stimulus::Travel { .. } | Stimulus::Sine { .. } => Ok(Vec::new()),
    }
}

/// The excitation of the model that a sensor measured in a run.
fn excitation(model: &dyn Model, evidence: &Evidence, run: usize, reference: &Point) -> Result<usize, PredictError> {
    excitation_of(model.about(), reference).ok_or_else(|| PredictError::NoInput {
        model: model.about().name.to_string(),
        location: reference.location.clone(),
        run: evidence.runs[run].name.clone(),
    })
}

fn of_run(
    model: &dyn Model,
    [values, side]: [&Values; 2],
    misread: &Misread,
    free: &[Free],
    evidence: &Evidence,
    run: usize,
) -> Result<Vec<Prediction>, PredictError> {
    let late = &misread.late;
    match &evidence.runs[run].stimulus {
        Stimulus::Sweep { .. } if model.about().linear => linear::sweep(model, values, free, evidence, run),
        Stimulus::Sweep { .. } => nonlinear::sweep(model, values, misread.louder(run), free, evidence, run),
        Stimulus::Cleat(passage) => cleat::passage(model, side, late, free, evidence, (run, passage)),
        Stimulus::History { .. } => history::history(model, values, misread, (free, !free.is_empty()), evidence, run),
        Stimulus::Travel { .. } | Stimulus::Sine { .. } => travel::travel(model, values, free, evidence, run),
    }
}
