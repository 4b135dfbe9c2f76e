//! A model on a K&C rig: the body is held, the wheel follows a path, and the masses between them stay in equilibrium.
//!
//! The rig is slow, so the inertia of these masses is neglected: the forces on each of them balance. Laws with
//! memory (dry friction, relaxing branches, dampers in series with springs) are integrated by the implicit Euler
//! method, which is stable for any stiffness.

use std::rc::Rc;

use nalgebra::{DMatrix, DVector, Dyn, LU, SVD};

use crate::campaign::Axis;
use crate::kc::of_unit_force;
use crate::model::{About, InputKind, Matrix, Model, Quantity, StateKind};
use crate::roles::{OnRig, state};

/// Most Newton steps at an instant.
const STEPS: usize = 30;
/// Step size that counts as converged, relative to a state.
const CONVERGED: f64 = 1e-9;
/// Absolute part of this tolerance over its relative part, in the unit of the state.
const ABSOLUTE: f64 = 1e-3;
/// Relative difference of two time steps that counts as rounding error.
const EQUAL: f64 = 1e-9;

/// Motion of the wheel at an instant; by default at rest, before the first step.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Instant {
    /// Travel against the body, m.
    pub travel: f64,
    /// Speed, m/s.
    pub speed: f64,
    /// Time since the previous instant, s.
    pub step: f64,
    /// True if the force is read at this instant.
    pub is_read: bool,
}

impl Instant {
    /// Both halves of the way from another instant to this one.
    fn halves(&self, from: &Instant) -> [Instant; 2] {
        let step = self.step / 2.0;
        let middle = Instant {
            travel: from.travel.midpoint(self.travel),
            speed: from.speed.midpoint(self.speed),
            step,
            is_read: false,
        };
        [middle, Instant { step, ..*self }]
    }
}

/// Positions of the rig's parts in a model.
pub struct Bench {
    /// The wheel that the rig moves and the body that it holds.
    on: OnRig,
    /// Axis of the motion.
    axis: Axis,
    /// Position of the wheel's displacement among the states.
    wheel: usize,
    /// Position of the wheel's velocity among the states.
    pub(super) wheel_speed: usize,
    /// Position of the body's velocity among the states.
    pub(super) held_speed: usize,
    /// Inputs of the ground under the wheel. It moves with the wheel, so the tyre has no force, which the rig does not
    /// measure.
    ground: Vec<(usize, Quantity)>,
    pub(super) free: Vec<FreeState>,
    pub(super) slopes: Vec<Slope>,
    /// Entries in the row of the wheel.
    pub(super) of_wheel: Vec<Slope>,
}

/// A state that the rig does not prescribe.
pub(super) struct FreeState {
    pub place: usize,
    /// Position of its velocity if it belongs to a mass; `None` for an inner state.
    pub speed: Option<usize>,
}

/// An entry of `∂f/∂x` in a column of a free state.
pub(super) struct Slope {
    /// Position among the nonzeros of the model.
    pub entry: usize,
    /// Row and column among the free states.
    pub row: usize,
    pub column: usize,
    /// True if the entry belongs to the velocity of the state.
    pub of_speed: bool,
}

impl Bench {
    /// The positions in a model; `None` if the model lacks the parts that the rig moves along this axis.
    pub fn new(about: &About, on: &OnRig, axis: &Axis) -> Option<Self> {
        let along = |kind| {
            let states = about.states.iter().enumerate();
            states.filter(move |(_, state)| state.kind == kind && state.axis == axis.name())
        };
        let called = |kind, name: &str| state(about, kind, name, axis.name());
        let held = called(StateKind::Position, &on.body)?;
        let wheel = called(StateKind::Position, &on.wheel)?;
        let wheel_speed = called(StateKind::Velocity, &on.wheel)?;
        let positions = along(StateKind::Position).filter(|(place, _)| ![wheel, held].contains(place));
        let of_mass = |(place, state): (usize, &crate::model::State)| FreeState {
            place,
            speed: called(StateKind::Velocity, &state.location),
        };
        let inner = along(StateKind::Inner).map(|(place, _)| FreeState { place, speed: None });
        let free: Vec<FreeState> = positions.map(of_mass).chain(inner).collect();
        let of_axis = |excitation: u16| about.excitations[usize::from(excitation)].axis == axis.name();
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
            wheel_speed,
            held_speed: called(StateKind::Velocity, &on.body)?,
            on: on.clone(),
            axis: axis.clone(),
            ground: ground.collect(),
            slopes: slopes(about, &free, |row| free.iter().position(|b| b.row() == row)),
            of_wheel: slopes(about, &free, |row| (row == wheel_speed).then_some(0)),
            free,
        })
    }

    /// Accelerations by a unit force on the wheel. `None` if it accelerates nothing.
    pub(super) fn of_unit_force(&self, model: &dyn Model, p: &[f64]) -> Option<Vec<f64>> {
        of_unit_force(model, p, &self.on.wheel, self.axis.name())
    }

    /// Acceleration of the wheel by a unit force on it and the opposite force on the body. By symmetry, a force on the
    /// body accelerates the wheel through inerters as much as a force on the wheel accelerates the body.
    pub(super) fn wheel_of(&self, of_unit: &[f64]) -> f64 {
        of_unit[self.wheel_speed] - of_unit[self.held_speed]
    }

    /// Acceleration of a free mass over that of the wheel, by the force of the rig; zero for an inner state.
    pub(super) fn share(&self, of_unit: &[f64], of: &FreeState) -> f64 {
        of.speed.map_or(0.0, |speed| of_unit[speed] / self.wheel_of(of_unit))
    }
}

/// Entries that couple the free states to some rows of the model.
fn slopes(about: &About, free: &[FreeState], row: impl Fn(usize) -> Option<usize>) -> Vec<Slope> {
    let column = |state: usize| {
        let of_speed = free.iter().position(|b| b.speed == Some(state));
        let of_place = free.iter().position(|b| b.place == state);
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

impl FreeState {
    /// Row of the equation of motion that determines this state.
    pub fn row(&self) -> usize {
        self.speed.unwrap_or(self.place)
    }
}

/// A model that follows the path.
pub(super) struct Drive<'a> {
    pub bench: &'a Bench,
    pub model: &'a dyn Model,
    pub p: &'a [f64],
    constants: Vec<f64>,
    /// Accelerations by a unit force on the wheel; with inerters, other masses accelerate too.
    pub of_unit: Vec<f64>,
    pub x: Vec<f64>,
    pub u: Vec<f64>,
    pub dx: Vec<f64>,
    pub nonzeros: Vec<f64>,
    /// The factorised Jacobian of a linear model, and its time step (s).
    constant: Option<(f64, Rc<Factor>)>,
}

impl<'a> Drive<'a> {
    pub fn new(bench: &'a Bench, model: &'a dyn Model, p: &'a [f64]) -> Option<Self> {
        let about = model.about();
        let mut constants = vec![0.0; about.constants];
        model.prepare(p, &mut constants);
        Some(Self {
            bench,
            model,
            p,
            constants,
            of_unit: bench.of_unit_force(model, p)?,
            x: vec![0.0; about.states.len()],
            u: vec![0.0; about.inputs.len()],
            dx: vec![0.0; about.states.len()],
            nonzeros: vec![0.0; about.matrices.len()],
            constant: None,
        })
    }

    /// Sets the wheel and the ground to an instant.
    fn set_motion(&mut self, at: &Instant) {
        let bench = self.bench;
        (self.x[bench.wheel], self.x[bench.wheel_speed]) = (at.travel, at.speed);
        for &(place, quantity) in &bench.ground {
            self.u[place] = match quantity {
                Quantity::Position => at.travel,
                Quantity::Velocity => at.speed,
                Quantity::Acceleration => 0.0,
            };
        }
    }

    /// Updates the derivatives and returns the force of the rig.
    pub fn force(&mut self) -> f64 {
        self.model.derivative(&self.constants, &self.x, &self.u, &mut self.dx);
        self.rig_force()
    }

    /// Force of the rig on the wheel, from the acceleration that the wheel would have without it.
    fn rig_force(&self) -> f64 {
        -self.dx[self.bench.wheel_speed] / self.wheel_of_unit()
    }

    pub fn wheel_of_unit(&self) -> f64 {
        self.bench.wheel_of(&self.of_unit)
    }

    /// Moves the wheel and all states to an instant, and calls `then` there. Where Newton's method does not converge, it
    /// first goes halfway, and so on up to `halvings` times, with `then` at each of these instants. If friction slips
    /// within a small part of the way, the whole step goes back and forth between both signs of it. False if no
    /// halving helps.
    pub fn advance(
        &mut self,
        from: &Instant,
        to: &Instant,
        halvings: usize,
        then: &mut dyn FnMut(&mut Self, &Instant),
    ) -> bool {
        let start = self.x.clone();
        self.set_motion(to);
        if self.follow(to.step) {
            then(self, to);
            return true;
        }
        let Some(halvings) = halvings.checked_sub(1) else {
            return false;
        };
        self.x = start;
        let [middle, end] = to.halves(from);
        self.advance(from, &middle, halvings, then) && self.advance(&middle, &end, halvings, then)
    }

    /// Moves the free states over `h` s by Newton's method; false if it does not converge. A linear model has a constant
    /// Jacobian, so its first step is exact.
    fn follow(&mut self, h: f64) -> bool {
        let last = self.free_values();
        for _ in 0..STEPS {
            let residual = self.residual(&last, h);
            let step = self.factor(h).and_then(|factor| factor.solve(residual));
            let Some(step) = step else {
                return last.is_empty();
            };
            if self.step(&step, &last, h) || self.model.about().linear {
                return true;
            }
        }
        false
    }

    /// The factorised Jacobian at the present states; `None` if there are no free states or an entry is not finite.
    pub fn factor(&mut self, h: f64) -> Option<Rc<Factor>> {
        let is_linear = self.model.about().linear;
        if let Some((step, factor)) = &self.constant
            && (step / h - 1.0).abs() < EQUAL
        {
            return Some(Rc::clone(factor));
        }
        let factor = Factor::of(self.slope(h)).map(Rc::new);
        self.constant = factor.clone().filter(|_| is_linear).map(|factor| (h, factor));
        factor
    }

    /// Values of the free states.
    pub fn free_values(&self) -> Vec<f64> {
        self.bench.free.iter().map(|b| self.x[b.place]).collect()
    }

    /// Applies a Newton step to the free states; true if it has converged.
    fn step(&mut self, step: &DVector<f64>, last: &[f64], h: f64) -> bool {
        let mut converged = true;
        for (b, step) in self.bench.free.iter().zip(step) {
            self.x[b.place] += step;
            converged &= step.abs() <= CONVERGED * (self.x[b.place].abs() + ABSOLUTE);
        }
        self.set_speeds(last, h);
        converged
    }

    fn set_speeds(&mut self, last: &[f64], h: f64) {
        for (b, last) in self.bench.free.iter().zip(last) {
            if let Some(speed) = b.speed {
                self.x[speed] = (self.x[b.place] - last) / h;
            }
        }
    }

    /// Residual of the implicit step for each free state; for a mass, the unbalanced force.
    fn residual(&mut self, last: &[f64], h: f64) -> DVector<f64> {
        self.set_speeds(last, h);
        let rig_force = self.force();
        let residual = |(b, last): (&FreeState, &f64)| match b.speed {
            Some(speed) => -self.dx[speed] - rig_force * self.of_unit[speed],
            None => h * self.dx[b.place] + last - self.x[b.place],
        };
        DVector::from_iterator(last.len(), self.bench.free.iter().zip(last).map(residual))
    }

    /// Negative Jacobian of this residual by the free states.
    fn slope(&mut self, h: f64) -> DMatrix<f64> {
        self.model.matrices(self.p, &self.x, &self.u, &mut self.nonzeros);
        let free = &self.bench.free;
        let mut slope = DMatrix::zeros(free.len(), free.len());
        let along = |of: &Slope| self.nonzeros[of.entry] * if of.of_speed { 1.0 / h } else { 1.0 };
        for of in &self.bench.slopes {
            slope[(of.row, of.column)] += along(of);
        }
        for (row, b) in free.iter().enumerate() {
            let share = self.bench.share(&self.of_unit, b);
            for of in &self.bench.of_wheel {
                slope[(row, of.column)] -= share * along(of);
            }
        }
        for (row, _) in free.iter().enumerate().filter(|(_, b)| b.speed.is_none()) {
            slope.row_mut(row).scale_mut(-h);
            slope[(row, row)] += 1.0;
        }
        slope
    }
}

/// Factorised Jacobian.
pub(super) enum Factor {
    Regular(LU<f64, Dyn, Dyn>),
    /// Solved by the pseudo-inverse. It gives the smallest step, so a state that no force holds keeps its value.
    Singular(SVD<f64, Dyn, Dyn>),
}

impl Factor {
    /// `None` if there are no free states or an entry is not finite.
    fn of(slope: DMatrix<f64>) -> Option<Self> {
        if slope.is_empty() || !slope.iter().all(|entry| entry.is_finite()) {
            return None;
        }
        let factor = slope.clone().lu();
        Some(if factor.is_invertible() {
            Factor::Regular(factor)
        } else {
            Factor::Singular(slope.svd(true, true))
        })
    }

    /// Newton step; `None` if it is not finite.
    pub fn solve(&self, mut residual: DVector<f64>) -> Option<DVector<f64>> {
        let step = match self {
            Factor::Regular(factor) => factor.solve_mut(&mut residual).then_some(residual),
            Factor::Singular(factor) => factor.solve(&residual, f64::EPSILON).ok(),
        };
        step.filter(|step| step.iter().all(|step| step.is_finite()))
    }
}
