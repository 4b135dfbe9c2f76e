//! The data of the page: the answer, and the rides of today's axle and of the design.

use qcar_runtime::metric::Ground;
use qcar_runtime::response::parameters::Values;
use qcar_runtime::target::Move;
use serde::Serialize;

use super::gather::Answer;
use crate::report::rounded::curve;

/// All of it.
#[derive(Serialize)]
pub(super) struct Contents<'a> {
    #[serde(flatten)]
    answer: &'a Answer,
    rides: Vec<Ride>,
    moves: Vec<Moved<'a>>,
}

/// A parameter of the model that a parameter of the file moves: `factor` times its value, and `constant`.
#[derive(Serialize)]
struct Moved<'a> {
    /// The place of that in the file.
    knob: usize,
    parameter: &'a str,
    factor: f64,
    constant: f64,
}

/// A run by both axles.
#[derive(Serialize)]
struct Ride {
    run: String,
    /// s after the wheel of today's axle feels the obstacle.
    time: Vec<f64>,
    traces: Vec<Both>,
}

/// What a mass does, m/s^2.
#[derive(Serialize)]
struct Both {
    mass: String,
    axis: String,
    today: Vec<f64>,
    design: Vec<f64>,
}

impl<'a> Contents<'a> {
    /// Drives both axles, today's and the design; what cannot be driven has no ride.
    pub fn of(answer: &'a Answer, moves: &[Move], ground: &'a Ground<'_>, axles: [&Values; 2]) -> Self {
        let rides = (0..ground.courses().len()).filter_map(|course| ride(ground, course, axles));
        let moves = moves.iter().map(|own| Moved {
            knob: own.knob,
            parameter: &ground.about().parameters[own.parameter].name,
            factor: own.factor,
            constant: own.constant,
        });
        Self {
            answer,
            rides: rides.collect(),
            moves: moves.collect(),
        }
    }
}

fn ride(ground: &Ground<'_>, at: usize, [today, design]: [&Values; 2]) -> Option<Ride> {
    let course = &ground.courses()[at];
    let (before, after) = (ground.trace(today, at).ok()?, ground.trace(design, at).ok()?);
    let pairs = before.accelerations.into_iter().zip(after.accelerations);
    let both = pairs.map(|((signal, today), (_, design))| Both {
        mass: signal.location.to_string(),
        axis: signal.axis.to_string(),
        today: curve(today),
        design: curve(design),
    });
    let time = (0..course.samples).map(|sample| sample as f64 / course.sample_rate - before.onset);
    Some(Ride {
        run: course.name.clone(),
        time: curve(time),
        traces: both.collect(),
    })
}
