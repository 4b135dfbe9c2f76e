//! Derivatives of a ride by the parameters of its car, for a fit: on the grid of the samples if the axle is linear and
//! the force of its tyre does not jump.
//!
//! Such an axle is linear apart from the inputs g from the contact: its force, and for a tyre with inner states its
//! deflection and rate. The variational equations of all parameters, `dS/dt = A S + B (K S + ∂g/∂p) + ∂A/∂p x + ∂B/∂p
//! g`, share the matrix of the axle and the derivatives `K` of the contact, so they are stepped together. Between
//! points the inputs are taken as linear in time. A derivative is accurate to about one percent, which suffices for a
//! least-squares fit. Those of any other axle, and of a point contact, are integrated with the motion by [`tangent`],
//! which no grid limits.

// The matrices of the axle, and their derivatives by each parameter.
mod matrices;

use std::array;

use nalgebra::{DMatrix, Matrix4, Vector4};
use rayon::prelude::*;

use matrices::{Axle, Direction, forced, slopes_at_rest};

use super::car::Car;
use super::failure::SimulateError;
use super::ride::Drive;
use super::rolling::{GIVEN, Rolling, slope};
use super::sampling::{Grid, Tape};
use super::settings::{Method, Settings};
use super::tangent::{Tangent, tangent};
use crate::model::{LANES, Model};
use crate::solver::Hold;
use crate::tyre::Geometry;

/// Relative tolerance of a motion that is not linear, with its derivatives.
const TOLERANCE: f64 = 3e-6;
/// Largest number of derivatives of such a motion that are integrated together.
const TOGETHER: usize = 4 * LANES;
/// Number of changes in a direction: a change is some thousandths of a parameter, a direction as large as it.
const CHANGES: f64 = 300.0;

/// Derivatives of some `outputs` of a ride at its samples, for each of the `moved` parameter sets by its change.
///
/// Those of a linear axle are accurate to about 1 % of the signal with two points per sample, and to about 5 % with
/// one. Those of any other axle, and of a point contact, have the accuracy of its ride.
///
/// # Errors
/// Fails as [`ride`](super::ride()) does, and if a car with a moved set has no static equilibrium.
pub fn variation<M: Model + ?Sized>(
    car: &Car<'_, M>,
    drive: &Drive<'_>,
    outputs: &[usize],
    moved: &[(&[f64], f64)],
    points_a_sample: usize,
) -> Result<Vec<Vec<Vec<f64>>>, SimulateError> {
    let tyre = car.rolling_tyre();
    drive.check(&tyre)?;
    if moved.is_empty() {
        return Ok(Vec::new());
    }
    let grid = Grid::new(drive.sample_rate, drive.samples, points_a_sample);
    let start = drive.start(&tyre).min(grid.start());
    let (rolling, x) = Rolling::at_rest(car, drive.road, drive.speed, start)?;
    if tyre.geometry() == Geometry::Point || !rolling.is_linear_beside_contact() {
        return integrated(car, drive, outputs, moved);
    }
    let axle = Axle::of(&rolling, outputs);
    let mut directions = Vec::with_capacity(moved.len());
    for &(parameters, change) in moved {
        let moved = Car { parameters, ..*car };
        directions.push(Direction::new(
            Rolling::at_rest_near(&x, &moved, drive.road, drive.speed, start)?,
            change,
            (&rolling, &x),
            (&axle, outputs),
        ));
    }
    let begins = drive.reaches(&tyre).max(start);
    match Variation::new(rolling, axle, directions, grid, begins, x) {
        Some(variation) => Ok(variation.slopes()),
        None => integrated(car, drive, outputs, moved),
    }
}

/// The derivatives of any axle, integrated with its motion.
fn integrated<M: Model + ?Sized>(
    car: &Car<'_, M>,
    drive: &Drive<'_>,
    outputs: &[usize],
    moved: &[(&[f64], f64)],
) -> Result<Vec<Vec<Vec<f64>>>, SimulateError> {
    let settings = Settings {
        method: Method::Adaptive(TOLERANCE),
        ..Settings::default()
    };
    let some = |moved: &[(&[f64], f64)]| {
        let direction = |(to, _): &(&[f64], f64)| {
            let changes = to.iter().zip(car.parameters);
            changes.map(|(to, from)| CHANGES * (to - from)).collect()
        };
        let directions: Vec<Vec<f64>> = moved.iter().map(direction).collect();
        tangent(car, drive, &settings, &directions)
    };
    let found: Result<Vec<Tangent>, _> = moved.par_chunks(TOGETHER).map(some).collect();
    let slopes = found?.into_iter().flat_map(|found| found.slopes);
    let of = |(signals, (_, by)): (Vec<Vec<f64>>, &(&[f64], f64))| {
        let own = outputs.iter().map(|&output| &signals[output]);
        own.map(|signal| signal.iter().map(|value| value / (CHANGES * by)).collect())
            .collect()
    };
    Ok(slopes.zip(moved).map(of).collect())
}

/// A ride and its derivatives at a point of the grid.
struct Variation<'a, M: ?Sized> {
    rolling: Rolling<'a, M>,
    axle: Axle,
    directions: Vec<Direction<'a, M>>,
    /// States on which the contact or a parameter acts directly.
    forced: Vec<usize>,
    hold: Hold,
    /// Effect of the contact's inputs at the end of a step on the states there.
    of_contact: DMatrix<f64>,
    tape: Tape,
    time: f64,
    spacing: f64,
    x: Vec<f64>,
    /// The states on which the contact depends, each with a small change for a difference quotient.
    touching: Vec<(usize, f64)>,
    contact: ContactInputs,
    /// Change of the contact's inputs in the last step.
    grew: [f64; GIVEN],
    /// Number of parameters, rounded up to a multiple of the lanes.
    lanes: usize,
    /// Derivatives of each state, of the sum that acts on each forced state, and of the contact's inputs.
    slopes: Vec<f64>,
    acting: Vec<f64>,
    given_slopes: [Vec<f64>; GIVEN],
    /// Buffers for the next states, for their derivatives, for the previous sums, and for the derivatives of the
    /// outputs.
    next: Vec<f64>,
    next_slopes: Vec<f64>,
    before: Vec<f64>,
    shown: Vec<f64>,
}

/// Inputs from a contact at a point.
struct ContactInputs {
    given: [f64; GIVEN],
    /// Derivatives by the states on which they depend.
    by_state: Vec<(usize, [f64; GIVEN])>,
}

impl ContactInputs {
    fn new<M: Model + ?Sized>(rolling: &Rolling<'_, M>, touching: &[(usize, f64)], t: f64, x: &mut [f64]) -> Self {
        let given = rolling.given(t, x);
        let by_state = touching.iter().map(|&(state, change)| {
            let here = x[state];
            x[state] += change;
            let there = rolling.given(t, x);
            x[state] = here;
            (state, slope(given, there, change))
        });
        Self {
            by_state: by_state.collect(),
            given,
        }
    }
}

/// Adds a multiple of numbers to others; zero factors, the most frequent ones, are skipped.
fn add(factor: f64, of: &[f64], to: &mut [f64]) {
    if factor == 0.0 {
        return;
    }
    to.iter_mut().zip(of).for_each(|(to, of)| *to += factor * of);
}

impl<'a, M: Model + ?Sized> Variation<'a, M> {
    /// Starts at the last point before the time `begins` at which the car starts to move from its rest `x`. `None` if
    /// the axle is much too fast for the grid.
    fn new(
        rolling: Rolling<'a, M>,
        axle: Axle,
        mut directions: Vec<Direction<'a, M>>,
        grid: Grid,
        begins: f64,
        mut x: Vec<f64>,
    ) -> Option<Self> {
        let forced = forced(&axle, &directions);
        directions.iter_mut().for_each(|direction| direction.renumber(&forced));
        let spacing = grid.spacing();
        let hold = Hold::new(&axle.a, &forced, spacing)?;
        let pushed = DMatrix::from_fn(forced.len(), GIVEN, |place, axis| axle.b[(forced[place], axis)]);
        let time = grid.start() + ((begins - grid.start()) / spacing).floor() * spacing;
        // A multiple of the number that is computed together.
        let lanes = directions.len().next_multiple_of(4);
        let slopes = slopes_at_rest(&directions, x.len(), lanes);
        let signals = axle.c.nrows() * lanes;
        let touching = rolling.touching();
        let contact = ContactInputs::new(&rolling, &touching, time, &mut x);
        let mut variation = Self {
            of_contact: hold.of_end() * pushed,
            tape: Tape::new(grid, signals),
            acting: vec![0.0; forced.len() * lanes],
            before: vec![0.0; forced.len() * lanes],
            given_slopes: array::from_fn(|_| vec![0.0; lanes]),
            next: vec![0.0; x.len()],
            next_slopes: vec![0.0; slopes.len()],
            shown: vec![0.0; signals],
            grew: [0.0; GIVEN],
            rolling,
            axle,
            directions,
            forced,
            hold,
            time,
            spacing,
            x,
            touching,
            contact,
            lanes,
            slopes,
        };
        variation.record_rest();
        Some(variation)
    }

    /// Records the derivatives of the outputs at rest up to the first point.
    fn record_rest(&mut self) {
        self.vary_given();
        self.act_beside_contact();
        self.act_by_contact();
        self.show();
        let until = self.time - 0.5 * self.spacing;
        self.tape.record_rest(until, self.shown.iter().copied());
    }

    /// The derivatives of the outputs.
    fn slopes(mut self) -> Vec<Vec<Vec<f64>>> {
        while self.tape.next(f64::INFINITY).is_some() {
            if self.tape.next(self.time + 0.5 * self.spacing).is_some() {
                self.show();
                self.tape.record(self.shown.iter().copied());
            }
            self.advance();
        }
        let (outputs, lanes) = (self.axle.c.nrows(), self.lanes);
        let of = |lane: usize| {
            (0..outputs)
                .map(|output| self.tape.filtered(output * lanes + lane))
                .collect()
        };
        (0..self.directions.len()).map(of).collect()
    }

    /// Advances to the next point.
    fn advance(&mut self) {
        std::mem::swap(&mut self.before, &mut self.acting);
        self.advance_ride();
        // The effect of the contact at the end of the step follows from the states without that effect.
        self.act_beside_contact();
        let forces = [&self.before, &self.acting].map(Vec::as_slice);
        self.hold.step(self.lanes, &self.slopes, forces, &mut self.next_slopes);
        std::mem::swap(&mut self.slopes, &mut self.next_slopes);
        self.vary_given();
        let solve = self.solver();
        for lane in 0..self.lanes {
            let without = Vector4::from_fn(|axis, _| self.given_slopes[axis][lane]);
            let given = solve * without;
            self.given_slopes
                .iter_mut()
                .zip(given.iter())
                .for_each(|(slopes, given)| slopes[lane] = *given);
        }
        for (state, slopes) in self.slopes.chunks_exact_mut(self.lanes).enumerate() {
            for (axis, of_given) in self.given_slopes.iter().enumerate() {
                add(self.of_contact[(state, axis)], of_given, slopes);
            }
        }
        self.act_by_contact();
    }

    /// Advances the ride itself: the contact's inputs are predicted from their last change and corrected by their
    /// derivatives.
    fn advance_ride(&mut self) {
        let was = self.contact.given;
        let predicted: [f64; GIVEN] = array::from_fn(|axis| was[axis] + self.grew[axis]);
        let acts = |given: [f64; GIVEN]| {
            let of = |&state: &usize| {
                self.axle
                    .b
                    .row(state)
                    .iter()
                    .zip(given)
                    .map(|(b, given)| b * given)
                    .sum()
            };
            self.forced.iter().map(of).collect::<Vec<f64>>()
        };
        self.hold
            .step(1, &self.x, [&acts(was), &acts(predicted)], &mut self.next);
        std::mem::swap(&mut self.x, &mut self.next);
        self.time += self.spacing;
        self.contact = ContactInputs::new(&self.rolling, &self.touching, self.time, &mut self.x);
        let found = self.contact.given;
        let off = self.solver() * Vector4::from_fn(|axis, _| found[axis] - predicted[axis]);
        for (state, x) in self.x.iter_mut().enumerate() {
            *x += self
                .of_contact
                .row(state)
                .iter()
                .zip(off.iter())
                .map(|(by, off)| by * off)
                .sum::<f64>();
        }
        self.contact.given = array::from_fn(|axis| predicted[axis] + off[axis]);
        self.grew = array::from_fn(|axis| self.contact.given[axis] - was[axis]);
    }

    /// The matrix from the contact's inputs at the states without its effect to those with it, since the contact
    /// changes the states in the same step.
    fn solver(&self) -> Matrix4<f64> {
        let mut answers = Matrix4::identity();
        for (state, by_state) in &self.contact.by_state {
            answers -= Vector4::from(*by_state) * self.of_contact.fixed_view::<1, GIVEN>(*state, 0);
        }
        answers.try_inverse().unwrap_or_else(Matrix4::identity)
    }

    /// Computes the derivatives of the contact's inputs from those of the states.
    fn vary_given(&mut self) {
        self.given_slopes.iter_mut().for_each(|slopes| slopes.fill(0.0));
        let others = self.directions.iter().map(|own| own.other.as_ref()).enumerate();
        let mut known = None;
        for (lane, (other, by)) in others.filter_map(|(lane, other)| Some((lane, other?))) {
            let (touch, here) = known.get_or_insert_with(|| {
                let touch = self.rolling.touch(self.time, &self.x);
                let contact = touch.as_ref().map(|touch| self.rolling.contact(Some(touch), &self.x));
                (touch, self.rolling.inputs_of(contact))
            });
            let there = other.given_beside((&self.rolling, touch.as_ref()), self.time, &self.x);
            let own = slope(*here, there, *by);
            self.given_slopes
                .iter_mut()
                .zip(own)
                .for_each(|(slopes, own)| slopes[lane] = own);
        }
        for (state, by_state) in &self.contact.by_state {
            let of_state = &self.slopes[state * self.lanes..][..self.lanes];
            for (axis, slopes) in self.given_slopes.iter_mut().enumerate() {
                add(by_state[axis], of_state, slopes);
            }
        }
    }

    /// Computes the direct effect of the parameters on the derivatives of the forced states.
    fn act_beside_contact(&mut self) {
        self.acting.fill(0.0);
        for (lane, direction) in self.directions.iter().enumerate() {
            for &(place, column, slope) in &direction.a {
                self.acting[place * self.lanes + lane] += slope * self.x[column];
            }
            for &(place, axis, slope) in &direction.b {
                self.acting[place * self.lanes + lane] += slope * self.contact.given[axis];
            }
        }
    }

    /// Adds the effect of the contact.
    fn act_by_contact(&mut self) {
        for (&state, acting) in self.forced.iter().zip(self.acting.chunks_exact_mut(self.lanes)) {
            for (axis, of_given) in self.given_slopes.iter().enumerate() {
                add(self.axle.b[(state, axis)], of_given, acting);
            }
        }
    }

    /// Computes the derivatives of the outputs at this point, output by output.
    fn show(&mut self) {
        self.shown.fill(0.0);
        for (output, shown) in self.shown.chunks_exact_mut(self.lanes).enumerate() {
            let (of_states, of_given) = (self.axle.c.row(output), self.axle.d.row(output));
            let states = self.slopes.chunks_exact(self.lanes).zip(of_states.iter());
            let forces = self.given_slopes.iter().map(Vec::as_slice).zip(of_given.iter());
            for (slopes, factor) in states.chain(forces) {
                add(*factor, slopes, shown);
            }
        }
        for (lane, direction) in self.directions.iter().enumerate() {
            for &(row, column, slope) in &direction.c {
                self.shown[row * self.lanes + lane] += slope * self.x[column];
            }
            for &(row, axis, slope) in &direction.d {
                self.shown[row * self.lanes + lane] += slope * self.contact.given[axis];
            }
        }
    }
}
