//! Initial states of held-out records, estimated from these records.
//!
//! Sensors do not measure all states of the masses at the first sample, in a held-out record as in a fitted one, and where
//! a record restarts, their readings are noisy. With all fitted parameters fixed, the maximum a posteriori of these states
//! is found by Gauss-Newton steps. For a linear model the first step is exact.

use std::ops::Range;

use nalgebra::{DMatrix, DVector};

use crate::campaign::Role;
use crate::discover::noise::Nuisance;
use crate::discover::observe::{
    Evidence, Initial, PredictError, Prediction, Restart, Stimulus, TestConditions, measures, predict_by_initial_states,
};
use crate::model::Model;
use crate::response::parameters::Values;
use crate::transmissibility::Point;

/// Most Gauss-Newton steps.
const STEPS: usize = 10;
/// Factor on a step that was too long.
const SHORTER: f64 = 0.25;
/// Relative decrease of the sum of squares below which the steps end.
const CONVERGED: f64 = 1e-4;

/// Completes `conditions` with the initial states of the records of one role, for these coefficients of the sensor
/// errors.
///
/// # Errors
/// Fails if the model lacks a measured quantity.
pub fn estimate_initial_states(
    model: &dyn Model,
    values: &Values,
    (nuisance, coefficients): (&Nuisance, &[f64]),
    evidence: &Evidence,
    role: Role,
    conditions: &mut TestConditions,
) -> Result<(), PredictError> {
    conditions.initial_states.resize(evidence.runs.len(), Vec::new());
    for (place, run) in evidence.runs.iter().enumerate().filter(|(_, run)| run.role == role) {
        let unknown = unknown(model, values.as_slice(), &run.stimulus);
        if unknown.is_empty() {
            continue;
        }
        conditions.initial_states[place] = unknown.iter().map(Unknown::as_measured).collect();
        let mut best = (f64::INFINITY, conditions.initial_states[place].clone());
        let mut step = DVector::zeros(unknown.len());
        for _ in 0..STEPS {
            let predictions = predict_by_initial_states(model, values, conditions, evidence, place)?;
            let rows = Rows::of(&predictions, (nuisance, coefficients), evidence, &unknown);
            let (cost, next) = rows.solve(&conditions.initial_states[place], &unknown);
            let gained = best.0 - cost;
            match next.filter(|_| gained > 0.0) {
                Some(next) => {
                    best = (cost, conditions.initial_states[place].clone());
                    step = next;
                }
                // The step was too long for a nonlinear law.
                None => step *= SHORTER,
            }
            if gained > 0.0 && gained < CONVERGED * cost {
                break;
            }
            let states = conditions.initial_states[place].iter_mut().zip(&best.1);
            states
                .zip(step.iter())
                .for_each(|((own, best), step)| own.by = best.by + step);
        }
        conditions.initial_states[place] = best.1;
    }
    Ok(())
}

/// An unknown initial state of a record.
struct Unknown {
    /// The sample at which it begins.
    sample: usize,
    /// Name of the state.
    state: String,
    /// Prior standard deviation, SI.
    sigma: f64,
    /// Times (s) from its sample to the next at which it is set.
    times: Range<f64>,
}

impl Unknown {
    fn as_measured(&self) -> Initial {
        Initial {
            sample: self.sample,
            state: self.state.clone(),
            by: 0.0,
        }
    }
}

/// The unknown initial states of a record; empty for any other run.
fn unknown(model: &dyn Model, p: &[f64], stimulus: &Stimulus) -> Vec<Unknown> {
    let Stimulus::History {
        inputs,
        rate,
        spread,
        restarts,
        ..
    } = stimulus
    else {
        return Vec::new();
    };
    let states = &model.about().states;
    let is_set =
        |(point, _): &(Point, f64), name: &str| states.iter().any(|own| own.name == name && measures(own, point));
    let sets = |restart: &Restart, name: &str| restart.readings.iter().any(|reading| is_set(reading, name));
    let time = |sample: usize| inputs.start + (sample as f64 - 0.5) / rate;
    let parts = |(state, sigma): (String, f64)| -> Vec<Unknown> {
        let later = restarts.iter().filter(|own| own.sample > 0 && sets(own, &state));
        let samples: Vec<usize> = std::iter::once(0).chain(later.map(|own| own.sample)).collect();
        let begin = |(k, &sample): (usize, &usize)| Unknown {
            sample,
            state: state.clone(),
            sigma,
            times: time(sample)..samples.get(k + 1).map_or(f64::INFINITY, |&next| time(next)),
        };
        samples.iter().enumerate().map(begin).collect()
    };
    spread.unknown(model, p).into_iter().flat_map(parts).collect()
}

/// Normalised residuals of a run and their derivatives by its initial states.
struct Rows {
    residual: Vec<f64>,
    columns: Vec<Vec<f64>>,
}

impl Rows {
    fn of(
        predictions: &[Prediction],
        (nuisance, coefficients): (&Nuisance, &[f64]),
        evidence: &Evidence,
        unknown: &[Unknown],
    ) -> Self {
        let mut rows = Rows {
            residual: Vec::new(),
            columns: vec![Vec::new(); unknown.len()],
        };
        for prediction in predictions {
            let series = &evidence.series[prediction.series];
            let reading = nuisance.sensor_output(evidence, series, &prediction.value, coefficients);
            let values = series.value.iter().zip(&reading.value).zip(&series.sigma);
            rows.residual
                .extend(values.map(|((measured, reading), sigma)| (measured - reading).re / sigma));
            for (column, own) in rows.columns.iter_mut().zip(unknown) {
                let slope = prediction
                    .by_initial_states
                    .iter()
                    .find(|(state, _)| *state == own.state);
                let slope = slope.iter().flat_map(|(_, slope)| slope);
                let values = slope.zip(&reading.factor).zip(&series.sigma).zip(&series.at);
                column.extend(values.map(|(((slope, factor), sigma), at)| {
                    let is_own = own.times.contains(at);
                    if is_own { (slope * factor).re / sigma } else { 0.0 }
                }));
            }
        }
        rows
    }

    /// Sum of squares including the prior, and the step to its minimum; `None` if that is not finite.
    fn solve(&self, values: &[Initial], unknown: &[Unknown]) -> (f64, Option<DVector<f64>>) {
        let count = unknown.len();
        // Scaled by the prior standard deviations, so that positions and velocities are comparable.
        let sigma = |k: usize| unknown[k].sigma;
        let residual = DVector::from_column_slice(&self.residual);
        let jacobian = DMatrix::from_fn(residual.len(), count, |sample, k| sigma(k) * self.columns[k][sample]);
        // A product of two matrices runs in blocks, which the products of pairs of columns do not: the normal equations
        // would take most of the time of a long chain.
        let transposed = jacobian.transpose();
        let mut normal = &transposed * &jacobian;
        let mut slope = &transposed * &residual;
        let mut cost = residual.norm_squared();
        for (k, own) in values.iter().enumerate() {
            normal[(k, k)] += 1.0;
            slope[k] -= own.by / sigma(k);
            cost += (own.by / sigma(k)).powi(2);
        }
        let step = normal.cholesky().map(|normal| normal.solve(&slope));
        let step = step.filter(|step| cost.is_finite() && step.iter().all(|step| step.is_finite()));
        let scaled = step.map(|step| DVector::from_fn(count, |k, _| sigma(k) * step[k]));
        (cost, scaled)
    }
}
