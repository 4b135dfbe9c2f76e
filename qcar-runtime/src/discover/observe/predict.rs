//! Prediction of a data set with its parameter Jacobian.

use rayon::prelude::*;

use super::dataset::Evidence;
use super::prediction::{Free, Misread, PredictError, Prediction};
use super::run::{Run, Stimulus};
use super::{cleat, drift, dynamometer, kc, sweep, time_history};
use crate::campaign::Role;
use crate::model::Model;
use crate::response::parameters::Values;
use crate::transmissibility::Point;

/// Predicts all series of the runs of one role, with derivatives by the `free` parameters. Unless `free` is empty, it
/// also gives the derivatives by the initial states of the records.
///
/// # Errors
/// Fails if the model lacks a measured quantity.
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

/// Predicts the `wanted` runs of a car whose recorded side has its own parameters, the second set; cleat runs use
/// these. `misread` holds the sensor errors.
///
/// # Errors
/// Fails as [`predict`] does.
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

/// Predicts a run with derivatives by its initial states alone.
///
/// # Errors
/// Fails as [`predict`] does.
pub fn predict_begun(
    model: &dyn Model,
    values: &Values,
    misread: &Misread,
    evidence: &Evidence,
    run: usize,
) -> Result<Vec<Prediction>, PredictError> {
    time_history::history(model, values, misread, (&[], true), evidence, run)
}

/// Sample-by-sample signals of the sensors of a sweep or a time history; empty for any other run.
///
/// # Errors
/// Fails as [`predict`] does.
pub fn replayed(
    model: &dyn Model,
    values: &Values,
    misread: &Misread,
    evidence: &Evidence,
    run: usize,
) -> Result<Vec<(Point, Vec<f64>)>, PredictError> {
    match &evidence.runs[run].stimulus {
        Stimulus::Sweep { .. } => sweep::replayed(model, values, evidence, run),
        Stimulus::History { .. } => time_history::replayed(model, values, misread, evidence, run),
        _ => Ok(Vec::new()),
    }
}

fn of_run(
    model: &dyn Model,
    both: [&Values; 2],
    misread: &Misread,
    free: &[Free],
    evidence: &Evidence,
    run: usize,
) -> Result<Vec<Prediction>, PredictError> {
    if !both[0].have_clocks() {
        return of_unchanging(model, both, misread, free, evidence, run);
    }
    drift::through(evidence, run, |part, length| {
        let [values, side] = both.map(|own| own.at_part(part, length));
        of_unchanging(model, [&values, &side], misread, free, evidence, run)
    })
}

/// Predicts a run with constant parameters.
fn of_unchanging(
    model: &dyn Model,
    [values, side]: [&Values; 2],
    misread: &Misread,
    free: &[Free],
    evidence: &Evidence,
    run: usize,
) -> Result<Vec<Prediction>, PredictError> {
    let late = &misread.late;
    match &evidence.runs[run].stimulus {
        Stimulus::Sweep { .. } if model.about().linear => sweep::linear(model, values, free, evidence, run),
        Stimulus::Sweep { .. } => sweep::nonlinear(model, values, misread.louder(run), free, evidence, run),
        Stimulus::Cleat(passage) => cleat::passage(model, side, late, free, evidence, (run, passage)),
        Stimulus::History { .. } => {
            time_history::history(model, values, misread, (free, !free.is_empty()), evidence, run)
        }
        Stimulus::Travel { .. } | Stimulus::Sine { .. } => kc::travel(model, values, free, evidence, run),
        Stimulus::Dynamometer { .. } => dynamometer::forces(model, values, free, evidence, run),
    }
}
