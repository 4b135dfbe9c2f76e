//! Prediction of a data set with its parameter Jacobian.

use rayon::prelude::*;

use super::dataset::Evidence;
use super::prediction::{Free, PredictError, Prediction, TestConditions};
use super::run::{Run, Stimulus};
use super::{cleat, drift, dynamometer, kc, sweep, time_history};
use crate::campaign::Role;
use crate::model::Model;
use crate::response::parameters::Values;
use crate::transmissibility::Point;

/// Predicts all series of the runs of one role, with derivatives by the `free` parameters and, unless `free` is empty,
/// by the initial states of the records.
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
    let conditions = TestConditions::default();
    predict_sides(model, [values, values], &conditions, free, evidence, &|run| {
        run.role == role
    })
}

/// Predicts the `wanted` runs. The second parameter set is that of the side of the car that cleat runs record.
///
/// # Errors
/// Fails as [`predict`] does.
pub fn predict_sides(
    model: &dyn Model,
    [values, side]: [&Values; 2],
    conditions: &TestConditions,
    free: &[Free],
    evidence: &Evidence,
    wanted: &dyn Fn(&Run) -> bool,
) -> Result<Vec<Prediction>, PredictError> {
    let runs: Vec<usize> = (0..evidence.runs.len())
        .filter(|&run| wanted(&evidence.runs[run]))
        .collect();
    let of_runs = runs
        .into_par_iter()
        .map(|run| of_run(model, [values, side], conditions, free, evidence, run));
    Ok(of_runs.collect::<Result<Vec<_>, _>>()?.into_iter().flatten().collect())
}

/// Predicts a run with derivatives by its initial states alone.
///
/// # Errors
/// Fails as [`predict`] does.
pub fn predict_by_initial_states(
    model: &dyn Model,
    values: &Values,
    conditions: &TestConditions,
    evidence: &Evidence,
    run: usize,
) -> Result<Vec<Prediction>, PredictError> {
    time_history::history(model, values, conditions, (&[], true), evidence, run)
}

/// Sample-by-sample signals of the sensors of a sweep or a time history; empty for any other run.
///
/// # Errors
/// Fails as [`predict`] does.
pub fn replayed(
    model: &dyn Model,
    values: &Values,
    conditions: &TestConditions,
    evidence: &Evidence,
    run: usize,
) -> Result<Vec<(Point, Vec<f64>)>, PredictError> {
    match &evidence.runs[run].stimulus {
        Stimulus::Sweep { .. } => sweep::replayed(model, values, evidence, run),
        Stimulus::History { .. } => time_history::replayed(model, values, conditions, evidence, run),
        _ => Ok(Vec::new()),
    }
}

fn of_run(
    model: &dyn Model,
    both: [&Values; 2],
    conditions: &TestConditions,
    free: &[Free],
    evidence: &Evidence,
    run: usize,
) -> Result<Vec<Prediction>, PredictError> {
    if !both[0].have_clocks() {
        return at_constant_parameters(model, both, conditions, free, evidence, run);
    }
    drift::through(evidence, run, |part, length| {
        let [values, side] = both.map(|own| own.at_part(part, length));
        at_constant_parameters(model, [&values, &side], conditions, free, evidence, run)
    })
}

/// Predicts a run with constant parameters.
fn at_constant_parameters(
    model: &dyn Model,
    [values, side]: [&Values; 2],
    conditions: &TestConditions,
    free: &[Free],
    evidence: &Evidence,
    run: usize,
) -> Result<Vec<Prediction>, PredictError> {
    let delays = &conditions.delays;
    match &evidence.runs[run].stimulus {
        Stimulus::Sweep { .. } if model.about().linear => sweep::linear(model, values, free, evidence, run),
        Stimulus::Sweep { .. } => sweep::nonlinear(model, values, conditions.drive_of(run, 0), free, evidence, run),
        Stimulus::Cleat(passage) => cleat::passage(model, side, delays, free, evidence, (run, passage)),
        Stimulus::History { .. } => {
            time_history::history(model, values, conditions, (free, !free.is_empty()), evidence, run)
        }
        Stimulus::Travel { .. } | Stimulus::Sine { .. } => kc::travel(model, values, free, evidence, run),
        Stimulus::Dynamometer { .. } => dynamometer::forces(model, values, free, evidence, run),
    }
}
