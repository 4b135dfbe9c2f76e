//! Predicts time histories: recorded inputs drive the model, and its sensors are read at the recorded times.

use std::borrow::Cow;

use nalgebra::Complex;

use crate::discover::observe::{
    Delay, Evidence, Free, Initial, PredictError, Prediction, Recordings, Series, Spread, Stimulus, TestConditions,
    excitation_of, measures, order_of, signal_of, zero_of,
};
use crate::model::{About, Model};
use crate::response::parameters::Values;
use crate::response::signal::SignalError;
use crate::simulate::replay::{Deviation, Direction, reading};
use crate::simulate::{Between, Reading, Recorded, Replay};
use crate::transmissibility::Point;

/// Predicts the sensors of a run with derivatives by the `free` parameters, by the amplitudes of its inputs unless
/// `free` is empty, and by the initial states and the zeros if `by_states` is true.
pub fn history(
    model: &dyn Model,
    values: &Values,
    conditions: &TestConditions,
    (free, by_states): (&[Free], bool),
    evidence: &Evidence,
    run: usize,
) -> Result<Vec<Prediction>, PredictError> {
    let Stimulus::History {
        inputs, rate, spread, ..
    } = &evidence.runs[run].stimulus
    else {
        return Ok(Vec::new());
    };
    let (about, p) = (model.about(), values.as_slice());
    let of_run = |(_, series): &(usize, &Series)| series.run == run;
    let (places, series): (Vec<_>, Vec<_>) = evidence.series.iter().enumerate().filter(of_run).unzip();
    let sensors: Vec<_> = series.iter().map(|series| &series.sensor).collect();
    let samples = driven(inputs, conditions, run);
    let replay = prepare(model, evidence, run, &sensors, &samples)?;
    let deviations = deviations(about, conditions.initial_states_of(run));
    let base = replay.run(p, &deviations);
    let unknown = if by_states {
        spread.unknown(model, p)
    } else {
        Vec::new()
    };
    let initial = |(name, _): &(String, f64)| {
        let of_state = place_of(about, name).map(Direction::Initial);
        Some((name.clone(), of_state.or_else(|| zero_of_input(about, inputs, name))?))
    };
    let (names, initial): (Vec<String>, Vec<Direction>) = unknown.iter().filter_map(initial).unzip();
    let directions = directions(model, values, free, inputs, initial);
    let mut along = replay.along(&base, (p, &deviations), &directions).into_iter();
    let replays = Replays {
        by_parameter: along.by_ref().take(free.len()).collect(),
        by_initial_states: names.into_iter().zip(along.by_ref()).collect(),
        by_drive: along.collect(),
        base: with_zeros(base.signals, &sensors, conditions.initial_states_of(run)),
    };
    let predict = |(column, (&place, series)): (usize, (&usize, &&Series))| {
        let delay = conditions.delays.get(place).copied().unwrap_or(0.0);
        let at = series.at.iter().map(|t| (t - inputs.start - delay) * rate).collect();
        let reader = Reader {
            stimulus: &evidence.runs[run].stimulus,
            at,
            column,
        };
        let mut prediction = replays.prediction(place, &reader, *rate);
        if by_states {
            prediction.by_initial_states.extend(by_zeros(spread, &sensors, series));
        }
        prediction
    };
    Ok(places.iter().zip(&series).enumerate().map(predict).collect())
}

/// What the signals are differentiated by: the free parameters with those that follow them, initial values and zeros, and
/// the amplitudes of the inputs.
fn directions(
    model: &dyn Model,
    values: &Values,
    free: &[Free],
    inputs: &Recordings,
    initial: Vec<Direction>,
) -> Vec<Direction> {
    let about = model.about();
    let parameters = free
        .iter()
        .map(|free| Direction::Parameters(values.tied_to(free.parameter)));
    let driven = inputs.signals.iter().filter(|_| !free.is_empty());
    let amplitudes = driven.filter_map(|(point, _)| excitation_of(about, point).map(Direction::Amplitude));
    parameters.chain(initial).chain(amplitudes).collect()
}

/// Samples of the sensors of a run.
type Signals = Vec<Vec<f64>>;

/// A replay of a run and its derivatives.
struct Replays {
    base: Signals,
    /// By each free parameter.
    by_parameter: Vec<Signals>,
    /// By the log amplitude of each input.
    by_drive: Vec<Signals>,
    /// By each unknown initial state and zero of an input, with its name.
    by_initial_states: Vec<(String, Signals)>,
}

impl Replays {
    fn prediction(&self, series: usize, reader: &Reader, rate: f64) -> Prediction {
        let (value, by_sample) = reader.read(&self.base);
        let slope = |signals: &Signals| -> Vec<Complex<f64>> {
            let (slope, _) = reader.read(signals);
            slope.into_iter().map(Complex::from).collect()
        };
        Prediction {
            series,
            slopes: self.by_parameter.iter().map(slope).collect(),
            by_drive: self.by_drive.iter().map(slope).collect(),
            by_initial_states: self
                .by_initial_states
                .iter()
                .map(|(name, signals)| (name.clone(), slope(signals)))
                .collect(),
            delay: Some(Delay {
                slope: by_sample.iter().map(|slope| Complex::from(-slope * rate)).collect(),
                shares: Vec::new(),
            }),
            value: value.into_iter().map(Complex::from).collect(),
        }
    }
}

/// Reads the compared part of one sensor.
struct Reader<'a> {
    stimulus: &'a Stimulus,
    /// Fractional samples at which it is read.
    at: Vec<f64>,
    /// Position of the sensor among the signals.
    column: usize,
}

impl Reader<'_> {
    /// The values and their derivatives by the sample.
    fn read(&self, signals: &[Vec<f64>]) -> (Vec<f64>, Vec<f64>) {
        let signal = self.stimulus.of_band(&signals[self.column]);
        self.at.iter().map(|&place| between(&signal, place)).unzip()
    }
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
    let Stimulus::History { inputs, .. } = &evidence.runs[run].stimulus else {
        return Ok(Vec::new());
    };
    let samples = driven(inputs, conditions, run);
    let replay = prepare(model, evidence, run, &sensors, &samples)?;
    let deviations = deviations(model.about(), conditions.initial_states_of(run));
    let signals = replay.run(values.as_slice(), &deviations).signals;
    let signals = with_zeros(signals, &sensors, conditions.initial_states_of(run));
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

/// True samples of each input of a run, under these test conditions.
fn driven<'a>(inputs: &'a Recordings, conditions: &TestConditions, run: usize) -> Vec<Cow<'a, [f64]>> {
    let of = |(input, (point, samples)): (usize, &'a (Point, Vec<f64>))| {
        let (factor, zero) = (
            conditions.drive_of(run, input),
            zero(point, conditions.initial_states_of(run)),
        );
        if (factor, zero) == (1.0, 0.0) {
            Cow::Borrowed(samples.as_slice())
        } else {
            samples.iter().map(|sample| factor * sample + zero).collect()
        }
    };
    inputs.signals.iter().enumerate().map(of).collect()
}

/// Prepares the replay of a run for some sensors, with these samples of its inputs.
fn prepare<'a>(
    model: &'a dyn Model,
    evidence: &Evidence,
    run: usize,
    sensors: &[&Point],
    samples: &'a [Cow<'a, [f64]>],
) -> Result<Replay<'a>, PredictError> {
    let about = model.about();
    let Stimulus::History {
        inputs,
        rate,
        band_limited,
        restarts,
        periodic,
        accuracy,
        ..
    } = &evidence.runs[run].stimulus
    else {
        return Err(PredictError::no_input(about, &evidence.runs[run], "record"));
    };
    let mut recorded = Vec::new();
    for ((point, _), samples) in inputs.signals.iter().zip(samples) {
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
        accuracy: *accuracy,
    };
    let restarts = restarts
        .iter()
        .map(|restart| (restart.sample, states(about, &restart.readings)));
    Ok(Replay::new(model, recorded, how, restarts.collect(), readings))
}

/// The initial states of a record with their positions in the model.
fn deviations(about: &About, initial_states: &[Initial]) -> Vec<Deviation> {
    let of = |own: &Initial| {
        Some(Deviation {
            sample: own.sample,
            state: place_of(about, &own.state)?,
            by: own.by,
        })
    };
    initial_states.iter().filter_map(of).collect()
}

/// The position of a state; `None` for the zero of a sensor.
fn place_of(about: &About, name: &str) -> Option<usize> {
    about.states.iter().position(|state| state.name == name)
}

/// The signals with the zeros of their sensors.
fn with_zeros(mut signals: Signals, sensors: &[&Point], initial_states: &[Initial]) -> Signals {
    for (signal, sensor) in signals.iter_mut().zip(sensors) {
        let zero = zero(sensor, initial_states);
        signal.iter_mut().for_each(|value| *value += zero);
    }
    signals
}

/// The zero of a sensor in a record.
fn zero(sensor: &Point, initial_states: &[Initial]) -> f64 {
    let name = zero_of(sensor);
    let own = initial_states.iter().filter(|own| own.state == name);
    own.map(|own| own.by).sum()
}

/// The direction in which the zero of an input moves; `None` for the zero of a response.
fn zero_of_input(about: &About, inputs: &Recordings, name: &str) -> Option<Direction> {
    let (point, _) = inputs.signals.iter().find(|(point, _)| zero_of(point) == name)?;
    excitation_of(about, point).map(Direction::Zero)
}

/// Derivatives of the values of a series by the zeros of the responses, each with its name.
fn by_zeros(
    spread: &Spread,
    responses: &[&Point],
    series: &Series,
) -> impl Iterator<Item = (String, Vec<Complex<f64>>)> {
    let zeros = spread.zeros.iter().filter(|(sensor, _)| responses.contains(&sensor));
    zeros.map(|(sensor, _)| {
        let slope = if *sensor == series.sensor { 1.0 } else { 0.0 };
        (zero_of(sensor), vec![Complex::from(slope); series.at.len()])
    })
}

/// States that a sensor measures, with their values.
fn states(about: &About, readings: &[(Point, f64)]) -> Vec<(usize, f64)> {
    let place = |point: &Point| about.states.iter().position(|state| measures(state, point));
    readings
        .iter()
        .filter_map(|(point, value)| Some((place(point)?, *value)))
        .collect()
}
