//! A model on a K&C rig: its body is held, its wheel follows a path, and all between them goes along.
//!
//! The rig is slow, so that the masses between weigh nothing: each is where no force is left on it. What remembers
//! (dry friction, relaxing branches, dampers in series with springs) follows by implicit steps (backward Euler), which
//! no stiffness upsets.

use nalgebra::{DMatrix, DVector};

use crate::campaign::Axis;
use crate::discover::evidence::travel::{HELD, MOVED};
use crate::model::{About, InputKind, Matrix, Model, Quantity, StateKind};

/// Newton's steps of an instant, and when one is small enough: relative to a state, or to `SMALL` of its unit.
const STEPS: usize = 30;
const RESTS: f64 = 1e-9;
const SMALL: f64 = 1e-3;

/// Where the rig holds the wheel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Instant {
    /// m, against the body.
    pub travel: f64,
    /// m/s.
    pub speed: f64,
    /// s since the instant before.
    pub step: f64,
}

/// Places in a model on the rig.
pub struct Bench {
    /// Position and velocity of the wheel.
    wheel: usize,
    wheel_speed: usize,
    /// The force on the wheel.
    handle: usize,
    /// The ground under the wheel, which goes with it: the force of the tyre is none of the rig's.
    ground: Vec<(usize, Quantity)>,
    between: Vec<Between>,
    slopes: Vec<Slope>,
}

/// A state that the rig does not prescribe.
struct Between {
    place: usize,
    /// Where its velocity is, of a mass.
    speed: Option<usize>,
}

/// An entry of `∂f/∂x` that couples what is between.
struct Slope {
    /// Its place among the model's nonzeros.
    entry: usize,
    row: usize,
    column: usize,
    /// Whether it belongs to the velocity of its column.
    of_speed: bool,
}

impl Bench {
    /// `None` of a model that lacks the parts that the rig moves along this axis.
    pub fn new(about: &About, axis: Axis) -> Option<Self> {
        let along = |kind| {
            let states = about.states.iter().enumerate();
            states.filter(move |(_, state)| state.kind == kind && state.axis == axis.name())
        };
        let called = |kind, name: &str| {
            along(kind)
                .find(|(_, state)| state.location == name)
                .map(|(place, _)| place)
        };
        let held = called(StateKind::Position, HELD)?;
        let wheel = called(StateKind::Position, MOVED)?;
        let positions = along(StateKind::Position).filter(|(place, _)| ![wheel, held].contains(place));
        let of_mass = |(place, state): (usize, &crate::model::State)| Between {
            place,
            speed: called(StateKind::Velocity, &state.location),
        };
        let inner = along(StateKind::Inner).map(|(place, _)| Between { place, speed: None });
        let between: Vec<Between> = positions.map(of_mass).chain(inner).collect();
        let of_axis = |excitation: u16| about.excitations[usize::from(excitation)].axis == axis.name();
        let is_force = |kind| matches!(kind, InputKind::Force(excitation) if of_axis(excitation));
        let ground = about
            .inputs
            .iter()
            .enumerate()
            .filter_map(|(place, input)| match input.kind {
                InputKind::Motion(excitation, quantity) if of_axis(excitation) => Some((place, quantity)),
                _ => None,
            });
        Some(Self {
            wheel,
            wheel_speed: called(StateKind::Velocity, MOVED)?,
            handle: about.inputs.iter().position(|input| is_force(input.kind))?,
            ground: ground.collect(),
            slopes: slopes(about, &between),
            between,
        })
    }

    /// The force on the wheel (N) at each instant of a path that begins at rest.
    pub fn forces(&self, model: &dyn Model, p: &[f64], path: &[Instant]) -> Vec<f64> {
        let mut drive = Drive::new(self, model, p);
        path.iter().map(|instant| drive.force(instant)).collect()
    }
}

/// What couples the states between.
fn slopes(about: &About, between: &[Between]) -> Vec<Slope> {
    let row = |state: usize| between.iter().position(|b| b.row() == state);
    let column = |state: usize| {
        let of_speed = between.iter().position(|b| b.speed == Some(state));
        let of_place = between.iter().position(|b| b.place == state);
        of_speed.map(|column| (column, true)).or(of_place.map(|c| (c, false)))
    };
    let slope = |(entry, of): (usize, &crate::model::Entry)| {
        let (column, of_speed) = column(usize::from(of.column)).filter(|_| of.matrix == Matrix::A)?;
        Some(Slope {
            entry,
            row: row(usize::from(of.row))?,
            column,
            of_speed,
        })
    };
    about.matrices.iter().enumerate().filter_map(slope).collect()
}

impl Between {
    /// The row of the equations of motion that says where it goes.
    fn row(&self) -> usize {
        self.speed.unwrap_or(self.place)
    }
}

/// A model with a parameter set, on its way.
struct Drive<'a> {
    bench: &'a Bench,
    model: &'a dyn Model,
    p: &'a [f64],
    constants: Vec<f64>,
    x: Vec<f64>,
    u: Vec<f64>,
    dx: Vec<f64>,
    nonzeros: Vec<f64>,
}

impl<'a> Drive<'a> {
    fn new(bench: &'a Bench, model: &'a dyn Model, p: &'a [f64]) -> Self {
        let about = model.about();
        let mut constants = vec![0.0; about.constants];
        model.prepare(p, &mut constants);
        Self {
            bench,
            model,
            p,
            constants,
            x: vec![0.0; about.states.len()],
            u: vec![0.0; about.inputs.len()],
            dx: vec![0.0; about.states.len()],
            nonzeros: vec![0.0; about.matrices.len()],
        }
    }

    /// Goes to the next instant, and says what the rig pushes with.
    fn force(&mut self, to: &Instant) -> f64 {
        let bench = self.bench;
        (self.x[bench.wheel], self.x[bench.wheel_speed]) = (to.travel, to.speed);
        for &(place, quantity) in &bench.ground {
            self.u[place] = match quantity {
                Quantity::Position => to.travel,
                Quantity::Velocity => to.speed,
                Quantity::Acceleration => 0.0,
            };
        }
        self.follow(to.step);
        let pulled = self.pull();
        self.u[bench.handle] = 1.0;
        let of_unit = self.pull() - pulled;
        self.u[bench.handle] = 0.0;
        -pulled / of_unit
    }

    /// The acceleration of the wheel if it were let go.
    fn pull(&mut self) -> f64 {
        self.move_on();
        self.dx[self.bench.wheel_speed]
    }

    fn move_on(&mut self) {
        self.model.derivative(&self.constants, &self.x, &self.u, &mut self.dx);
    }

    /// Takes what is between to where it is after `h` s (Newton's method).
    fn follow(&mut self, h: f64) {
        let between = &self.bench.between;
        if between.is_empty() {
            return;
        }
        let last: Vec<f64> = between.iter().map(|b| self.x[b.place]).collect();
        for _ in 0..STEPS {
            for (b, last) in between.iter().zip(&last) {
                if let Some(speed) = b.speed {
                    self.x[speed] = (self.x[b.place] - last) / h;
                }
            }
            self.move_on();
            let missing = |(b, last): (&Between, &f64)| match b.speed {
                Some(speed) => -self.dx[speed],
                None => h * self.dx[b.place] + last - self.x[b.place],
            };
            let missing = DVector::from_iterator(last.len(), between.iter().zip(&last).map(missing));
            let Some(step) = solve(self.slope(h), missing) else {
                return;
            };
            let mut rests = true;
            for (b, step) in between.iter().zip(&step) {
                self.x[b.place] += step;
                rests &= step.abs() <= RESTS * (self.x[b.place].abs() + SMALL);
            }
            if rests {
                return;
            }
        }
    }

    /// How what is missing changes with where the states are, with the opposite sign.
    fn slope(&mut self, h: f64) -> DMatrix<f64> {
        self.model.matrices(self.p, &self.x, &self.u, &mut self.nonzeros);
        let between = &self.bench.between;
        let mut slope = DMatrix::zeros(between.len(), between.len());
        for of in &self.bench.slopes {
            let of_place = if of.of_speed { 1.0 / h } else { 1.0 };
            slope[(of.row, of.column)] += self.nonzeros[of.entry] * of_place;
        }
        for (row, _) in between.iter().enumerate().filter(|(_, b)| b.speed.is_none()) {
            slope.row_mut(row).scale_mut(-h);
            slope[(row, row)] += 1.0;
        }
        slope
    }
}

/// `None` without a number. What nothing holds stays where it is: the smallest step of all.
fn solve(slope: DMatrix<f64>, missing: DVector<f64>) -> Option<DVector<f64>> {
    if !slope.iter().chain(&missing).all(|entry| entry.is_finite()) {
        return None;
    }
    let regular = slope.clone().lu().solve(&missing);
    let is_number = |step: &DVector<f64>| step.iter().all(|step| step.is_finite());
    regular
        .filter(is_number)
        .or_else(|| slope.svd(true, true).solve(&missing, f64::EPSILON).ok())
}
