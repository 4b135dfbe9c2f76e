//! Predicts time histories: recorded inputs drive the model, and its sensors are read at the recorded times.

use nalgebra::Complex;

use crate::discover::observe::{
    Delay, Evidence, Free, PredictError, Prediction, Series, Spread, Stimulus, TestConditions, excitation_of, measures,
    order_of, signal_of,
};
use crate::model::{About, Model};
use crate::response::parameters::Values;
use crate::response::signal::SignalError;
use crate::simulate::replay::reading;
use crate::simulate::{Between, Reading, Recorded, Replay};
use crate::transmissibility::Point;

/// Parameter change for a finite difference, relative to its value: about the square root of the rounding error of a
/// replay.
const DIFFERENCE: f64 = 1e-5;
/// Share of the range that replaces the value of a parameter near zero.
const PART_OF_RANGE: f64 = 1e-3;
/// Change of an initial state for a finite difference, relative to its prior standard deviation.
const OF_SPREAD: f64 = 1e-4;

/// Predicts the sensors of a run with derivatives by the `free` parameters and, if `by_states` is true, by the initial states.
pub fn history(
    model: &dyn Model,
    values: &Values,
    conditions: &TestConditions,
    (free, by_states): (&[Free], bool),
    evidence: &Evidence,
    run: usize,
) -> Result<Vec<Prediction>, PredictError> {
    let stimulus = &evidence.runs[run].stimulus;
    let Stimulus::History {
        inputs, rate, spread, ..
    } = stimulus
    else {
        return Ok(Vec::new());
    };
    let series: Vec<_> = evidence
        .series
        .iter()
        .enumerate()
        .filter(|(_, series)| series.run == run)
        .collect();
    let replay = prepare(
        model,
        evidence,
        run,
        &series.iter().map(|(_, s)| &s.sensor).collect::<Vec<_>>(),
    )?;
    let start = inputs.start;
    let (p, deviations) = (
        values.as_slice(),
        deviations(model.about(), conditions.initial_states_of(run)),
    );
    let base = &replay.run(p, &deviations);
    let difference = |free: &Free| DIFFERENCE * p[free.parameter].abs().max(PART_OF_RANGE * (free.upper - free.lower));
    let steps: Vec<f64> = free.iter().map(difference).collect();
    let moved = |(free, step): (&Free, &f64)| {
        let mut values = values.clone();
        values.set(free.parameter, p[free.parameter] + step);
        values.as_slice().to_vec()
    };
    let others = replay.like(
        base,
        &free.iter().zip(&steps).map(moved).collect::<Vec<_>>(),
        &deviations,
    );
    // Each state with its step for a finite difference.
    let states: Vec<(usize, f64)> = if by_states {
        let states = unknown(model.about(), spread).into_iter();
        states.map(|(state, sigma)| (state, OF_SPREAD * sigma)).collect()
    } else {
        Vec::new()
    };
    let of_states = replay.by_initial_states(base, p, &deviations, &states);
    let shown = |signals: &[Vec<f64>], column: usize| stimulus.of_band(&signals[column]);
    let predict = |(column, (place, series)): (usize, &(usize, &Series))| {
        let delay = conditions.delays.get(*place).copied().unwrap_or(0.0);
        let read = |signal: &[f64]| -> (Vec<f64>, Vec<f64>) {
            series
                .at
                .iter()
                .map(|t| between(signal, (t - start - delay) * rate))
                .unzip()
        };
        let (value, by_sample) = read(&shown(&base.signals, column));
        let slope = |step: f64, signals: &[Vec<f64>]| -> Vec<Complex<f64>> {
            let (moved, _) = read(&shown(signals, column));
            moved
                .iter()
                .zip(&value)
                .map(|(moved, value)| Complex::from((moved - value) / step))
                .collect()
        };
        let along = |signals: &[Vec<f64>]| -> Vec<Complex<f64>> {
            let (slope, _) = read(&shown(signals, column));
            slope.into_iter().map(Complex::from).collect()
        };
        let name = |state: usize| model.about().states[state].name.to_string();
        Prediction {
            series: *place,
            slopes: steps.iter().zip(&others).map(|(step, own)| slope(*step, own)).collect(),
            by_initial_states: states
                .iter()
                .zip(&of_states)
                .map(|(&(state, _), own)| (name(state), along(own)))
                .collect(),
            value: value.iter().map(|&value| Complex::from(value)).collect(),
            delay: Some(Delay {
                slope: by_sample.iter().map(|slope| Complex::from(-slope * rate)).collect(),
                shares: Vec::new(),
            }),
            by_drive: None,
        }
    };
    Ok(series.iter().enumerate().map(predict).collect())
}

/// Sample-by-sample signals of the sensors of a run, filtered by the compared band.
pub fn replayed(
    model: &dyn Model,
    values: &Values,
    conditions: &TestConditions,
    evidence: &Evidence,
    run: usize,
) -> Result<Vec<(Point, Vec<f64>)>, PredictError> {
    let sensors = evidence.sensors(run);
    let replay = prepare(model, evidence, run, &sensors)?;
    let deviations = deviations(model.about(), conditions.initial_states_of(run));
    let signals = replay.run(values.as_slice(), &deviations).signals;
    let stimulus = &evidence.runs[run].stimulus;
    let shown = signals.iter().map(|signal| stimulus.of_band(signal));
    Ok(sensors.into_iter().cloned().zip(shown).collect())
}

/// Value of a signal at the fractional sample `place`, and its derivative by the sample: a cubic through two samples on
/// either side (Catmull and Rom). Beyond its ends the signal is constant.
fn between(signal: &[f64], place: f64) -> (f64, f64) {
    // Most places are whole samples, but times are not exact multiples of the sample interval.
    const ROUNDING: f64 = 1e-6;
    let place = if (place - place.round()).abs() < ROUNDING {
        place.round()
    } else {
        place
    };
    let (first, t) = (place.floor() as i64, place - place.floor());
    let last = signal.len() as i64 - 1;
    let [a, b, c, d] = [-1, 0, 1, 2].map(|k| signal[(first + k).clamp(0, last) as usize]);
    let (slope, curvature, twist) = (c - a, 2.0 * a - 5.0 * b + 4.0 * c - d, d - a + 3.0 * (b - c));
    let value = b + t / 2.0 * (slope + t * (curvature + t * twist));
    (value, (slope + t * (2.0 * curvature + 3.0 * t * twist)) / 2.0)
}

/// Prepares the replay of a run for some sensors.
fn prepare<'a>(
    model: &'a dyn Model,
    evidence: &'a Evidence,
    run: usize,
    sensors: &[&Point],
) -> Result<Replay<'a>, PredictError> {
    let about = model.about();
    let Stimulus::History {
        inputs,
        rate,
        band_limited,
        restarts,
        periodic,
        ..
    } = &evidence.runs[run].stimulus
    else {
        return Err(PredictError::no_input(about, &evidence.runs[run], "record"));
    };
    let mut recorded = Vec::new();
    for (point, samples) in &inputs.signals {
        let excitation = excitation_of(about, point)
            .ok_or_else(|| PredictError::no_input(about, &evidence.runs[run], &point.location))?;
        recorded.push(Recorded {
            excitation,
            power: order_of(point),
            samples,
        });
    }
    let readings: Vec<Reading> = sensors
        .iter()
        .map(|sensor| reading(about, &signal_of(about, sensor)))
        .collect::<Result<_, SignalError>>()?;
    let how = Between {
        rate: *rate,
        band_limited: *band_limited,
        band: (0.0, *rate),
        periodic: *periodic,
        samples: inputs.samples,
    };
    let restarts = restarts
        .iter()
        .map(|restart| (restart.sample, states(about, &restart.readings)));
    Ok(Replay::new(model, recorded, how, restarts.collect(), readings))
}

/// States with the deviation of their initial value from the sensor reading or from rest.
fn deviations(about: &About, initial_states: &[(String, f64)]) -> Vec<(usize, f64)> {
    let place = |name: &str| about.states.iter().position(|state| state.name == name);
    let deviations = initial_states.iter().filter_map(|(name, by)| Some((place(name)?, *by)));
    deviations.collect()
}

/// States with an uncertain initial value, with its standard deviation.
fn unknown(about: &About, spread: &Spread) -> Vec<(usize, f64)> {
    let states = about.states.iter().enumerate();
    states
        .filter_map(|(place, state)| Some((place, spread.sigma(state)?)))
        .collect()
}

/// States that a sensor measures, with their values.
fn states(about: &About, readings: &[(Point, f64)]) -> Vec<(usize, f64)> {
    let place = |point: &Point| about.states.iter().position(|state| measures(state, point));
    readings
        .iter()
        .filter_map(|(point, value)| Some((place(point)?, *value)))
        .collect()
}
