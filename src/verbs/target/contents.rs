//! The data of the report: the result, and the rides of the present axle and of the design, with the measurement.

use qcar_runtime::campaign::{Channel, Quantity};
use qcar_runtime::metric::{Ground, Trace};
use qcar_runtime::model::Signal;
use qcar_runtime::response::parameters::Values;
use qcar_runtime::simulate::Cleat;
use qcar_runtime::target::Move;
use serde::Serialize;

use super::gather::Answer;
use crate::report::rounded::curve;
use crate::verbs::sensitivity::subject::Subject;
use crate::verbs::simulate::comparison::{Pair, alignment};

/// The data of the report.
#[derive(Serialize)]
pub(super) struct Contents<'a> {
    #[serde(flatten)]
    answer: &'a Answer,
    rides: Vec<Ride>,
    moves: Vec<DependentParameter<'a>>,
    elasticities: &'a [Vec<f64>],
}

/// A parameter of the model that follows a parameter of the file: `factor` times its value, plus `constant`.
#[derive(Serialize)]
struct DependentParameter<'a> {
    /// Position of the parameter in the file.
    variable: usize,
    parameter: &'a str,
    factor: f64,
    constant: f64,
}

/// A run with both axles.
#[derive(Serialize)]
struct Ride {
    run: String,
    /// Time after the wheel of the present axle reaches the obstacle, s.
    time: Vec<f64>,
    traces: Vec<Both>,
}

/// Accelerations of a mass, m/s^2.
#[derive(Serialize)]
struct Both {
    mass: String,
    axis: String,
    today: Vec<f64>,
    design: Vec<f64>,
    /// Measured acceleration, aligned with the present axle at the peak of the wheel.
    measured: Option<Vec<f64>>,
}

impl<'a> Contents<'a> {
    /// Simulates the present axle and the design; a ride that fails is left out.
    pub fn of(
        answer: &'a Answer,
        moves: &[Move],
        (subject, ground): (&Subject, &'a Ground<'_>),
        axles: [&Values; 2],
    ) -> Self {
        let rides = (0..ground.courses().len()).filter_map(|course| ride((subject, ground), course, axles));
        let moves = moves.iter().map(|own| DependentParameter {
            variable: own.variable,
            parameter: &ground.about().parameters[own.parameter].name,
            factor: own.factor,
            constant: own.constant,
        });
        Self {
            answer,
            rides: rides.collect(),
            moves: moves.collect(),
            elasticities: &answer.elasticities,
        }
    }
}

fn ride((subject, ground): (&Subject, &Ground<'_>), at: usize, [today, design]: [&Values; 2]) -> Option<Ride> {
    let course = &ground.courses()[at];
    let (before, after) = (ground.trace(today, at).ok()?, ground.trace(design, at).ok()?);
    let measured = subject.measured.get(at).map(|cleat| beside(subject, cleat, &before));
    let mut measured = measured.unwrap_or_default().into_iter();
    let pairs = before.accelerations.into_iter().zip(after.accelerations);
    let both = pairs.map(|((signal, today), (_, design))| Both {
        mass: signal.location.to_string(),
        axis: signal.axis.to_string(),
        today: curve(today),
        design: curve(design),
        measured: measured.next().flatten().map(curve),
    });
    let time = (0..course.samples).map(|sample| sample as f64 / course.sample_rate - before.onset);
    Some(Ride {
        run: course.name.clone(),
        traces: both.collect(),
        time: curve(time),
    })
}

/// The measured signal of each acceleration of a ride, at its samples; `None` without a sensor, or if the records
/// cannot be aligned.
fn beside(subject: &Subject, cleat: &Cleat, ride: &Trace) -> Vec<Option<Vec<f64>>> {
    let sensors = ride.accelerations.iter().map(|(signal, _)| sensor(cleat, signal));
    let sensors: Vec<Option<&(Channel, Vec<f64>)>> = sensors.collect();
    let pairs = sensors.iter().zip(&ride.accelerations);
    let pairs: Vec<Pair<'_>> = pairs
        .filter_map(|(sensor, (signal, simulated))| {
            let (sensor, measured) = (*sensor)?;
            Some(Pair {
                mass: &signal.location,
                axis: sensor.axis.clone(),
                measured,
                simulated,
            })
        })
        .collect();
    let Ok(Some(alignment)) = alignment(subject.model.about(), &subject.roles, &pairs) else {
        return Vec::new();
    };
    // Beyond the ends of the record, the acceleration is zero.
    let shifted = |measured: &[f64]| {
        let at = |sample: usize| usize::try_from(sample as isize - alignment.delay).ok();
        let value = |sample: usize| at(sample).and_then(|sample| measured.get(sample).copied());
        (0..measured.len()).map(|sample| value(sample).unwrap_or(0.0)).collect()
    };
    let measured = sensors.into_iter();
    measured
        .map(|sensor| sensor.map(|(_, measured)| shifted(measured)))
        .collect()
}

fn sensor<'a>(cleat: &'a Cleat, signal: &Signal) -> Option<&'a (Channel, Vec<f64>)> {
    let is_of = |sensor: &Channel| {
        let place = sensor.location == *signal.location && *signal.axis == *sensor.axis.name();
        place && sensor.quantity == Quantity::Acceleration
    };
    cleat.measured.signals.iter().find(|(sensor, _)| is_of(sensor))
}
