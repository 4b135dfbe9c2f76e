//! Quasi-static K&C cycles: the body is held, the wheel is moved, and all between them is where it comes to rest.

use nalgebra::{Complex, DMatrix, DVector};

use super::{Free, PredictError, Prediction};
use crate::campaign::Axis;
use crate::discover::evidence::Evidence;
use crate::discover::evidence::travel::{HELD, MOVED};
use crate::model::{About, InputKind, Model, Quantity, StateKind};
use crate::response::parameters::Values;

/// Change of a parameter for its difference, relative to its value or, near zero, to a part of its range.
const DIFFERENCE: f64 = 1e-5;
const PART_OF_RANGE: f64 = 1e-3;
/// Change of a position for its difference, m.
const NUDGE: f64 = 1e-7;
/// Newton's steps to rest, and when one is small enough, m.
const STEPS: usize = 30;
const RESTS: f64 = 1e-10;

pub(super) fn travel(
    model: &dyn Model,
    values: &Values,
    free: &[Free],
    evidence: &Evidence,
    (run, axis): (usize, Axis),
) -> Vec<Prediction> {
    let bench = Bench::new(model.about(), axis);
    let of_run = evidence
        .series
        .iter()
        .enumerate()
        .filter(|(_, series)| series.run == run);
    let predict = |(place, series): (usize, &crate::discover::evidence::Series)| {
        let value = bench.forces(model, values.as_slice(), &series.at);
        let slope = |free: &Free| {
            let at = values.as_slice()[free.parameter];
            let step = DIFFERENCE * at.abs().max(PART_OF_RANGE * (free.upper - free.lower).min(f64::MAX));
            let mut moved = values.clone();
            moved.set(free.parameter, at + step);
            let moved = bench.forces(model, moved.as_slice(), &series.at);
            let slopes = moved
                .iter()
                .zip(&value)
                .map(|(moved, value)| Complex::from((moved - value) / step));
            slopes.collect()
        };
        Prediction {
            series: place,
            slopes: free.iter().map(slope).collect(),
            value: value.iter().copied().map(Complex::from).collect(),
        }
    };
    of_run.map(predict).collect()
}

/// Refuses a model without the parts that the rig moves.
///
/// # Errors
/// A model that lacks them.
pub(super) fn check(model: &dyn Model, evidence: &Evidence, run: usize, axis: Axis) -> Result<(), PredictError> {
    let bench = Bench::new(model.about(), axis);
    match (bench.moved, bench.held, bench.force) {
        (Some(_), Some(_), Some(_)) => Ok(()),
        _ => Err(PredictError::NoInput {
            model: model.about().name.to_string(),
            location: MOVED.to_owned(),
            run: evidence.runs[run].name.clone(),
        }),
    }
}

/// Places in a model on the rig.
struct Bench {
    /// Position of the wheel, and the row that says what moves it.
    moved: Option<(usize, usize)>,
    /// Position of the body.
    held: Option<usize>,
    /// The force on the wheel.
    force: Option<usize>,
    /// Positions that come to rest, and the row of each that is zero then.
    between: Vec<(usize, usize)>,
    /// The ground under the wheel, which goes with it: the force of the tyre is none of the curve's.
    ground: Vec<usize>,
}

impl Bench {
    fn new(about: &About, axis: Axis) -> Self {
        let along = about
            .states
            .iter()
            .enumerate()
            .filter(|(_, state)| state.axis == axis.name());
        let positions = along.clone().filter(|(_, state)| state.kind == StateKind::Position);
        let row = |place: usize| {
            let location = &about.states[place].location;
            let mut speeds = along.clone().filter(|(_, state)| state.kind == StateKind::Velocity);
            let speed = speeds.find(|(_, state)| state.location == *location);
            (place, speed.map_or(place, |(speed, _)| speed))
        };
        let called = |name: &str| {
            positions
                .clone()
                .find(|(_, s)| s.location == name)
                .map(|(place, _)| place)
        };
        let (moved, held) = (called(MOVED), called(HELD));
        let others = positions.clone().map(|(place, _)| place);
        let of_axis = |excitation: u16| about.excitations[usize::from(excitation)].axis == axis.name();
        let is_force = |kind| matches!(kind, InputKind::Force(excitation) if of_axis(excitation));
        let is_ground = |kind| matches!(kind, InputKind::Motion(excitation, Quantity::Position) if of_axis(excitation));
        let inputs = || about.inputs.iter().enumerate();
        Self {
            moved: moved.map(row),
            held,
            force: inputs().find(|(_, input)| is_force(input.kind)).map(|(place, _)| place),
            between: others
                .filter(|place| Some(*place) != moved && Some(*place) != held)
                .map(row)
                .collect(),
            ground: inputs()
                .filter(|(_, input)| is_ground(input.kind))
                .map(|(place, _)| place)
                .collect(),
        }
    }

    /// The force on the wheel at each travel against the body.
    fn forces(&self, model: &dyn Model, p: &[f64], travels: &[f64]) -> Vec<f64> {
        let about = model.about();
        let mut constants = vec![0.0; about.constants];
        model.prepare(p, &mut constants);
        let (mut x, mut u) = (vec![0.0; about.states.len()], vec![0.0; about.inputs.len()]);
        let force = |&travel: &f64| {
            let (Some((wheel, row)), Some(force)) = (self.moved, self.force) else {
                return f64::NAN;
            };
            x[wheel] = travel;
            self.ground.iter().for_each(|&place| u[place] = travel);
            let rates = |x: &[f64], u: &[f64]| {
                let mut dx = vec![0.0; x.len()];
                model.derivative(&constants, x, u, &mut dx);
                dx
            };
            self.rest(&mut x, &|x| rates(x, &u));
            let pulled = rates(&x, &u)[row];
            u[force] = 1.0;
            let of_unit = rates(&x, &u)[row] - pulled;
            u[force] = 0.0;
            -pulled / of_unit
        };
        travels.iter().map(force).collect()
    }

    /// Moves what is between to where nothing pulls at it (Newton's method).
    fn rest(&self, x: &mut [f64], rates: &dyn Fn(&[f64]) -> Vec<f64>) {
        let n = self.between.len();
        if n == 0 {
            return;
        }
        for _ in 0..STEPS {
            let here = rates(x);
            let columns: Vec<Vec<f64>> = self
                .between
                .iter()
                .map(|&(place, _)| {
                    let mut nudged = x.to_vec();
                    nudged[place] += NUDGE;
                    rates(&nudged)
                })
                .collect();
            let row = |i: usize| self.between[i].1;
            let slope = DMatrix::from_fn(n, n, |i, j| (columns[j][row(i)] - here[row(i)]) / NUDGE);
            let pull = DVector::from_fn(n, |i, _| -here[row(i)]);
            if !slope.iter().chain(&pull).all(|entry| entry.is_finite()) {
                return;
            }
            // What nothing holds stays where it is: the smallest step of all.
            let Ok(step) = slope.svd(true, true).solve(&pull, f64::EPSILON) else {
                return;
            };
            self.between
                .iter()
                .zip(&step)
                .for_each(|(&(place, _), step)| x[place] += step);
            if step.amax() < RESTS {
                return;
            }
        }
    }
}
