//! Initial states of records, estimated from these records with all parameters fixed: of held-out records, and of fitted
//! ones at the start of a fit.
//!
//! Sensors do not measure all states of the masses at the first sample, and where a record restarts, their readings are
//! noisy. The maximum a posteriori of these states is found by Gauss-Newton steps. For a linear model the first step is
//! exact. Where the steps end in a local minimum of a nonlinear model, they start again with a short part of the record
//! and continue with parts twice as long.

use std::ops::Range;

use nalgebra::{DMatrix, DVector};

use crate::discover::noise::Nuisance;
use crate::discover::numbers::LARGE;
use crate::discover::observe::{
    Evidence, Initial, PredictError, Prediction, Restart, Run, Series, Stimulus, TestConditions, measures,
    predict_by_initial_states,
};
use crate::mean::rms_or_nan;
use crate::model::Model;
use crate::response::parameters::Values;
use crate::transmissibility::Point;

/// Most Gauss-Newton steps.
const STEPS: usize = 10;
/// Factor on a step that was too long.
const SHORTER: f64 = 0.25;
/// Mean periods in the shortest part of a record. A choice: a phase error hardly grows within half a period. Two periods
/// were too long for a mass that hits a stiff stop.
const SHORTEST: f64 = 0.5;
/// Relative decrease of the sum of squares below which the steps end.
const CONVERGED: f64 = 1e-4;

/// Completes `conditions` with the initial states of some records, for these coefficients of the sensor errors.
///
/// # Errors
/// Fails if the model lacks a measured quantity.
pub fn estimate_initial_states(
    model: &dyn Model,
    values: &Values,
    sensors: (&Nuisance, &[f64]),
    evidence: &Evidence,
    is_wanted: impl Fn(&Run) -> bool,
    conditions: &mut TestConditions,
) -> Result<(), PredictError> {
    conditions.initial_states.resize(evidence.runs.len(), Vec::new());
    for (place, run) in evidence.runs.iter().enumerate().filter(|(_, run)| is_wanted(run)) {
        let record = Record {
            model,
            values,
            sensors,
            place,
            unknown: unknown(model, values.as_slice(), &run.stimulus),
        };
        if !record.unknown.is_empty() {
            conditions.initial_states[place] = record.best(evidence, conditions)?;
        }
    }
    Ok(())
}

/// A record with unknown initial states.
struct Record<'a> {
    model: &'a dyn Model,
    values: &'a Values,
    /// Sensor errors and their coefficients.
    sensors: (&'a Nuisance, &'a [f64]),
    /// Position of its run in the evidence.
    place: usize,
    unknown: Vec<Unknown>,
}

/// Estimated initial states of a record.
struct Estimate {
    states: Vec<Initial>,
    /// Sum of squares of the normalised residuals and of the distances from the prior.
    cost: f64,
    /// True if the residuals are larger than noise explains.
    is_poor: bool,
}

impl Record<'_> {
    /// The best estimate. Gauss-Newton steps from the measured states may end in a local minimum of a nonlinear model,
    /// because the phase error adds up along the record. Then the estimate begins with a short part of it.
    fn best(&self, evidence: &Evidence, conditions: &mut TestConditions) -> Result<Vec<Initial>, PredictError> {
        let as_measured: Vec<Initial> = self.unknown.iter().map(Unknown::as_measured).collect();
        let direct = self.estimate(as_measured.clone(), evidence, conditions)?;
        if self.model.about().linear || !direct.is_poor {
            return Ok(direct.states);
        }
        let mut grown = as_measured;
        for part in self.beginnings(evidence).iter().rev() {
            grown = self.estimate(grown, part, conditions)?.states;
        }
        let grown = self.estimate(grown, evidence, conditions)?;
        Ok(if grown.cost < direct.cost {
            grown.states
        } else {
            direct.states
        })
    }

    /// Beginnings of the record, each half as long as the one before, down to [`SHORTEST`].
    fn beginnings(&self, evidence: &Evidence) -> Vec<Evidence> {
        let is_own = |series: &&Series| series.run == self.place;
        let periods = evidence
            .series
            .iter()
            .filter(is_own)
            .map(|own| 2.0 * own.half_a_period());
        let shortest = SHORTEST * periods.fold(0.0, f64::max);
        let suffices = |own: &Series| match own.at[..] {
            [first, .., last] => own.at.len() > self.unknown.len() && last - first >= shortest,
            _ => false,
        };
        let is_long_enough = |of: &Evidence| of.series.iter().filter(is_own).all(suffices);
        let half = |of: &Evidence| Some(of.thinned(2)).filter(is_long_enough);
        std::iter::successors(half(evidence), half).collect()
    }

    /// Gauss-Newton steps from these initial states.
    fn estimate(
        &self,
        from: Vec<Initial>,
        evidence: &Evidence,
        conditions: &mut TestConditions,
    ) -> Result<Estimate, PredictError> {
        let mut best = Estimate {
            states: from.clone(),
            cost: f64::INFINITY,
            is_poor: true,
        };
        let mut step = DVector::zeros(self.unknown.len());
        conditions.initial_states[self.place] = from;
        for _ in 0..STEPS {
            let predictions = predict_by_initial_states(self.model, self.values, conditions, evidence, self.place)?;
            let rows = Rows::of(&predictions, self.sensors, evidence, &self.unknown);
            let states = &mut conditions.initial_states[self.place];
            let (cost, next) = rows.solve(states, &self.unknown);
            let gained = best.cost - cost;
            match next.filter(|_| gained > 0.0) {
                Some(next) => {
                    best = Estimate {
                        states: states.clone(),
                        cost,
                        is_poor: rms_or_nan(rows.residual.iter().copied()) > LARGE,
                    };
                    step = next;
                }
                // The step was too long for a nonlinear law.
                None => step *= SHORTER,
            }
            if gained > 0.0 && gained < CONVERGED * cost {
                break;
            }
            let moved = states.iter_mut().zip(&best.states).zip(step.iter());
            moved.for_each(|((own, best), step)| own.by = best.by + step);
        }
        Ok(best)
    }
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
