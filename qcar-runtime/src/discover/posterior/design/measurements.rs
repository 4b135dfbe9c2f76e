//! Possible further measurements: the evidence with a sensor, a run, a higher level or a dynamometer added.

use nalgebra::Complex;

use crate::campaign::{Axis, Quantity, Role};
use crate::discover::observe::{Evidence, Kind, PredictError, Run, Series, Stimulus, TestConditions, predict_sides};
use crate::discover::posterior::Refit;
use crate::fit::design::Kind as Added;
use crate::mean::rms;
use crate::model::{Link, Model, Output, Quantity as Derivative, Signal, SignalKind};
use crate::transmissibility::Point;

/// Evidence with one measurement added.
pub struct Measurement {
    pub kind: Added,
    /// Description.
    pub what: String,
    pub evidence: Evidence,
}

/// Peak velocities of the dynamometer sines, m/s: those of a stroke of 100 mm at 10, 25, 50, 75, 100, 150 and 200
/// rev/min.
const SPEEDS: [f64; 7] = [0.05, 0.13, 0.26, 0.39, 0.52, 0.79, 1.05];
/// Amplitude of the dynamometer sines, m.
const AMPLITUDE: f64 = 0.05;
/// Relative uncertainty of the dynamometer forces, a choice.
const UNCERTAINTY: f64 = 0.01;
/// Factor on the amplitude of a second dynamometer test, which determines the inner states of a law.
const SHORT_STROKE: f64 = 0.1;

/// All measurements that could be added to the fitted evidence.
///
/// # Errors
/// Fails if the model cannot predict a measurement.
pub fn measurements(refit: &Refit, model: &dyn Model, fitted: &Evidence) -> Result<Vec<Measurement>, PredictError> {
    let mut found = Vec::new();
    for run in 0..fitted.runs.len() {
        let name = &fitted.runs[run].name;
        found.push((Added::Repeat, format!("{name} once more"), repeated(fitted, run, 1.0)));
        if is_steady(&fitted.runs[run].stimulus) {
            let what = format!("{name} once more at twice its level");
            found.push((Added::Level, what, repeated(fitted, run, 2.0)));
        }
    }
    for (run, own) in fitted.runs.iter().enumerate() {
        if let Stimulus::Dynamometer { link, axis, .. } = &own.stimulus
            && has_inner_states(model, link, axis)
        {
            let what = format!("{} once more with a tenth of its stroke", own.name);
            found.push((Added::Level, what, shorter(fitted, run)));
        }
    }
    for output in model.about().outputs.iter() {
        let added = with_sensor(model, fitted, output).map(|(what, evidence)| (Added::Sensor, what, evidence));
        found.extend(added.filter(|(_, what, _)| found.iter().all(|(_, other, _)| other != what)));
    }
    for (place, link) in model.about().links.iter().enumerate() {
        if model.alone(place).is_some() && has_free_parameter(refit, link) && !is_measured(fitted, link) {
            let what = format!("a dynamometer's table of {}", link.name);
            found.push((Added::Dynamometer, what, with_dynamometer(fitted, link)));
        }
    }
    let measurement = |(kind, what, evidence): (Added, String, Evidence)| {
        Ok(Measurement {
            kind,
            what,
            evidence: predicted(refit, model, fitted, evidence)?,
        })
    };
    found.into_iter().map(measurement).collect()
}

/// True for a run with a steady sine, which can be predicted at any level.
fn is_steady(stimulus: &Stimulus) -> bool {
    matches!(stimulus, Stimulus::Sweep { .. } | Stimulus::Sine { .. })
}

/// Repeats a run at `times` its level. The noise of the sensors stays the same, so that of ratios to the excitation is
/// smaller.
fn repeated(fitted: &Evidence, run: usize, times: f64) -> Evidence {
    let mut more = fitted.clone();
    let own = &fitted.runs[run];
    let mut added = Run {
        name: format!("{} again", own.name),
        level: own.level * times,
        ..own.clone()
    };
    if let Stimulus::Sweep { signal, amplitude, .. } = &mut added.stimulus {
        signal.iter_mut().chain(amplitude).for_each(|value| *value *= times);
    }
    let place = more.runs.len();
    let repeated = fitted.series.iter().filter(|series| series.run == run);
    more.series.extend(repeated.map(|series| Series {
        run: place,
        sigma: series.sigma.iter().map(|sigma| sigma / times).collect(),
        noise: series.noise.iter().map(|noise| noise / times).collect(),
        ..series.clone()
    }));
    more.runs.push(added);
    more
}

/// True if the law of a link has inner states, so that its force depends on the stroke.
fn has_inner_states(model: &dyn Model, link: &str, axis: &Axis) -> bool {
    let links = model.about().links.iter();
    let place = links
        .clone()
        .position(|own| own.name == link && own.axis == axis.name());
    let alone = place.and_then(|place| model.alone(place));
    alone.is_some_and(|alone| !alone.about().states.is_empty())
}

/// Repeats a dynamometer table at the same speeds with shorter strokes.
fn shorter(fitted: &Evidence, run: usize) -> Evidence {
    let mut more = repeated(fitted, run, 1.0);
    if let Some(Stimulus::Dynamometer { amplitude, .. }) = more.runs.last_mut().map(|run| &mut run.stimulus) {
        *amplitude *= SHORT_STROKE;
    }
    more
}

/// The quantity that a sensor at an output measures, with its name: of a motion the acceleration, if the model outputs
/// it. A record cannot be predicted by differentiating another output.
fn sensed(model: &dyn Model, signal: &Signal) -> (Quantity, &'static str) {
    let acceleration = SignalKind::Motion(Derivative::Acceleration);
    let has_acceleration = || {
        let mut outputs = model.about().outputs.iter().map(|output| &output.signal);
        outputs.any(|own| own.kind == acceleration && (&own.location, &own.axis) == (&signal.location, &signal.axis))
    };
    match signal.kind {
        SignalKind::Force => (Quantity::Force, "force"),
        SignalKind::Stretch => (Quantity::Displacement, "stretch"),
        SignalKind::Motion(Derivative::Position) if !has_acceleration() => (Quantity::Displacement, "displacement"),
        SignalKind::Motion(Derivative::Velocity) if !has_acceleration() => (Quantity::Velocity, "velocity"),
        SignalKind::Motion(_) => (Quantity::Acceleration, "acceleration"),
    }
}

/// Adds a sensor at an output to every sweep and record that has a sensor along the same axis but not this one. Its
/// noise is that of a sensor of the same quantity in the run, or else of any sensor there. `None` if no run gets the
/// sensor.
fn with_sensor(model: &dyn Model, fitted: &Evidence, output: &Output) -> Option<(String, Evidence)> {
    let signal = &output.signal;
    let (quantity, word) = sensed(model, signal);
    let axis = Axis::new(signal.axis.clone());
    let sensor = Point::new(&signal.location, axis.clone(), quantity);
    let mut more = fitted.clone();
    for (run, own) in fitted.runs.iter().enumerate() {
        if !matches!(own.stimulus, Stimulus::Sweep { .. } | Stimulus::History { .. }) {
            continue;
        }
        let there = || {
            fitted
                .series
                .iter()
                .filter(|series| series.run == run && series.sensor.axis == axis)
        };
        if there().any(|series| series.sensor.location == sensor.location && series.sensor.quantity == quantity) {
            continue;
        }
        let like = there()
            .find(|series| series.sensor.quantity == quantity)
            .or(there().next());
        let Some(like) = like.map(|series| &series.sensor) else {
            continue;
        };
        more.series
            .extend(there().filter(|series| series.sensor == *like).map(|series| Series {
                sensor: sensor.clone(),
                ..series.clone()
            }));
    }
    let what = format!("{word} of {} along {}", signal.location, signal.axis);
    (more.series.len() > fitted.series.len()).then_some((what, more))
}

/// True if the law of a link has a fitted parameter.
fn has_free_parameter(refit: &Refit, link: &Link) -> bool {
    let mut free = refit.free.iter();
    free.any(|free| link.parameters.iter().any(|&own| usize::from(own) == free.parameter))
}

fn is_measured(fitted: &Evidence, link: &Link) -> bool {
    fitted.runs.iter().any(|run| match &run.stimulus {
        Stimulus::Dynamometer { link: own, axis, .. } => *own == link.name && axis.name() == link.axis,
        _ => false,
    })
}

fn with_dynamometer(fitted: &Evidence, link: &Link) -> Evidence {
    let axis = Axis::new(link.axis.clone());
    let out = SPEEDS.iter().copied();
    let speeds: Vec<f64> = out.clone().rev().map(|speed| -speed).chain(out).collect();
    let mut more = fitted.clone();
    more.series.push(Series {
        run: more.runs.len(),
        sensor: Point::new(&format!("{}_on_dynamometer", link.name), axis.clone(), Quantity::Force),
        kind: Kind::Speed,
        value: vec![Complex::ONE; speeds.len()],
        sigma: vec![UNCERTAINTY; speeds.len()],
        noise: vec![UNCERTAINTY; speeds.len()],
        at: speeds,
        least_discrepancy: 0.0,
    });
    more.runs.push(Run {
        name: format!("{} on a dynamometer", link.name),
        role: Role::Fit,
        level: SPEEDS[SPEEDS.len() - 1],
        stimulus: Stimulus::Dynamometer {
            link: link.name.to_string(),
            axis,
            amplitude: AMPLITUDE,
        },
    });
    more
}

/// Replaces the values of all new series by the predictions of the fitted model.
fn predicted(
    refit: &Refit,
    model: &dyn Model,
    fitted: &Evidence,
    mut more: Evidence,
) -> Result<Evidence, PredictError> {
    let new: Vec<usize> = more.series[fitted.series.len()..]
        .iter()
        .map(|series| series.run)
        .collect();
    let names: Vec<String> = new.iter().map(|&run| more.runs[run].name.clone()).collect();
    let wanted = |run: &Run| names.contains(&run.name);
    let sides = [&refit.values, &refit.side];
    let predicted = predict_sides(model, sides, &TestConditions::default(), &[], &more, &wanted)?;
    for own in predicted.into_iter().filter(|own| own.series >= fitted.series.len()) {
        let series = &mut more.series[own.series];
        let size = |values: &[Complex<f64>]| rms(values.iter().map(|value| value.norm()));
        let (before, after) = (size(&series.value), size(&own.value));
        let same = fitted
            .series
            .iter()
            .any(|other| other.run == series.run && other.sensor.quantity == series.sensor.quantity);
        // A sensor of a quantity that the run lacks has the relative noise of the sensor that it was copied from.
        if series.run < fitted.runs.len() && !same || series.kind == Kind::Speed {
            let times = after / before.max(f64::MIN_POSITIVE);
            series
                .sigma
                .iter_mut()
                .chain(&mut series.noise)
                .for_each(|sigma| *sigma *= times);
        }
        series.value = own.value;
    }
    Ok(more)
}
