//! Cars displaced along the directions of a tangent: difference quotients of their equations of motion, eight
//! directions at a time.
//!
//! The contact with the road takes longer than all else and depends on few states. So its inputs to the axle are
//! displaced by their derivatives, and only a direction that changes the contact itself has contacts of its own.

use super::super::rolling::{GIVEN, Rolling, slope};
use crate::model::{Contacts, LANES, Model};
use crate::tyre::Touch;
use crate::vectors::Rows;

/// Step of the central difference along a direction. Directions are about as large as the parameters, so the truncation
/// error is the square of the step, and the rounding error is 1e-16 divided by it.
pub const STEP: f64 = 1e-5;

/// Signs of the steps forward and backward.
const SIGNS: [f64; 2] = [1.0, -1.0];

/// A car in motion.
pub struct Here<'r, 'a, M: ?Sized> {
    pub rolling: &'r Rolling<'a, M>,
    /// Time, s.
    pub t: f64,
    pub x: &'r [f64],
    /// How its tyre touches the road; `None` in the air.
    pub touch: Option<&'r Touch>,
    /// The inputs from its contact.
    pub given: [f64; GIVEN],
}

/// Difference quotients along all directions.
pub struct Displaced<'a, M: ?Sized> {
    /// For each direction the cars with parameters one step forward and one step backward.
    pub moved: Vec<[Rolling<'a, M>; 2]>,
    /// The states on which the contact depends, each with a small change.
    touching: Vec<(usize, f64)>,
    /// For each direction whether it changes the contact of a state.
    changes_contact: Vec<bool>,
    /// Constants of eight directions at a time, forward and backward.
    constants: Vec<[Rows; 2]>,
    inputs: Rows,
    /// Buffers for eight directions: the sensitivities of their states, the displaced states and contacts, and rates and
    /// outputs forward and backward.
    directions: Rows,
    states: Rows,
    contacts: Contacts,
    rates: [Rows; 2],
    outputs: [Rows; 2],
    /// For each direction the derivatives of the contact's inputs.
    given_slopes: Vec<[f64; GIVEN]>,
    /// Buffer for a state.
    state: Vec<f64>,
}

impl<'a, M: Model + ?Sized> Displaced<'a, M> {
    pub fn new(rolling: &Rolling<'a, M>, moved: Vec<[Rolling<'a, M>; 2]>) -> Self {
        let (states, outputs) = rolling.sizes();
        let group = |group: &[[Rolling<'a, M>; 2]]| {
            [0, 1].map(|side| {
                let mut constants = Rows::zero(rolling.constants.len());
                for (place, row) in constants.iter_mut().enumerate() {
                    // The lanes without a direction have the constants of the car itself.
                    let of_lane = |lane: usize| group.get(lane).map_or(rolling, |sides| &sides[side]);
                    *row = std::array::from_fn(|lane| of_lane(lane).constants[place]);
                }
                constants
            })
        };
        Self {
            touching: rolling.touching(),
            changes_contact: moved
                .iter()
                .map(|sides| sides.iter().any(|own| !own.is_touched_like(rolling)))
                .collect(),
            constants: moved.chunks(LANES).map(group).collect(),
            inputs: Rows::zero(rolling.inputs.len()),
            directions: Rows::zero(states),
            states: Rows::zero(states),
            contacts: Contacts::default(),
            rates: [0, 1].map(|_| Rows::zero(states)),
            outputs: [0, 1].map(|_| Rows::zero(outputs)),
            given_slopes: vec![[0.0; GIVEN]; moved.len()],
            state: vec![0.0; states],
            moved,
        }
    }

    /// Computes the derivatives of the rates and of the signals: the outputs, then the vertical force of the tyre. The
    /// `sensitivities` of the states, `rates` and `signals` have a row for each direction.
    #[inline(always)]
    pub fn slopes(
        &mut self,
        here: &Here<'_, 'a, M>,
        sensitivities: &[f64],
        (rates, signals): (&mut [f64], &mut [f64]),
    ) {
        self.vary_contact(here, sensitivities);
        let (states, outputs) = (self.states.len(), self.outputs[0].len());
        for group in 0..self.constants.len() {
            let first = group * LANES;
            self.gather(&sensitivities[first * states..]);
            for (side, sign) in SIGNS.into_iter().enumerate() {
                self.displace(here, first, sign * STEP);
                self.evaluate(here.rolling, group, side);
            }
            let rates = rates.chunks_exact_mut(states).skip(first);
            let signals = signals.chunks_exact_mut(outputs + 1).skip(first);
            for (lane, (rates, signals)) in rates.zip(signals).take(LANES).enumerate() {
                quotients(&self.rates, lane, rates);
                quotients(&self.outputs, lane, &mut signals[..outputs]);
                signals[outputs] = self.given_slopes[first + lane][0];
            }
        }
    }

    /// Computes the derivatives of the contact's inputs along each direction.
    fn vary_contact(&mut self, here: &Here<'_, 'a, M>, sensitivities: &[f64]) {
        self.given_slopes.fill([0.0; GIVEN]);
        let known = (here.rolling, here.touch);
        let ways = self.changes_contact.iter().zip(&self.moved).zip(&mut self.given_slopes);
        for ((_, sides), slopes) in ways.filter(|((changes, _), _)| **changes) {
            let [up, down] = sides.each_ref().map(|own| own.given_beside(known, here.t, here.x));
            *slopes = slope(down, up, 2.0 * STEP);
        }
        self.state.copy_from_slice(here.x);
        for &(place, change) in &self.touching {
            let [up, down] = SIGNS.map(|sign| {
                self.state[place] = here.x[place] + sign * change;
                here.rolling.given(here.t, &self.state)
            });
            self.state[place] = here.x[place];
            let by_state = slope(down, up, 2.0 * change);
            let ways = sensitivities.chunks_exact(here.x.len()).zip(&mut self.given_slopes);
            for (s, slopes) in ways {
                slopes
                    .iter_mut()
                    .zip(by_state)
                    .for_each(|(slope, by)| *slope += by * s[place]);
            }
        }
    }

    /// Takes the sensitivities of a group, which are the first ones given.
    #[inline(always)]
    fn gather(&mut self, sensitivities: &[f64]) {
        let states = self.directions.len();
        for lane in 0..LANES {
            let of_lane = sensitivities.get(lane * states..(lane + 1) * states);
            for (place, row) in self.directions.iter_mut().enumerate() {
                row[lane] = of_lane.map_or(0.0, |own| own[place]);
            }
        }
    }

    /// Displaces the states and contacts of a group by a step along its directions, of which the first is known.
    #[inline(always)]
    fn displace(&mut self, here: &Here<'_, 'a, M>, first: usize, step: f64) {
        let rows = self.states.iter_mut().zip(here.x).zip(self.directions.iter());
        for ((row, x), direction) in rows {
            (0..LANES).for_each(|lane| row[lane] = x + step * direction[lane]);
        }
        let mut inputs = here.given.map(|given| [given; LANES]);
        for (lane, slopes) in self.given_slopes[first..].iter().take(LANES).enumerate() {
            for (row, slope) in inputs.iter_mut().zip(slopes) {
                row[lane] += step * slope;
            }
        }
        let [up, ahead, s, v] = inputs;
        self.contacts = Contacts {
            s,
            v,
            force: [up, ahead],
        };
    }

    /// Computes the rates and outputs of the displaced cars on one side.
    fn evaluate(&mut self, rolling: &Rolling<'a, M>, group: usize, side: usize) {
        let constants = &self.constants[group][side];
        let (states, inputs, contacts) = (&self.states, &self.inputs, &self.contacts);
        let (rates, outputs) = (&mut self.rates[side], &mut self.outputs[side]);
        rolling
            .model
            .rolling_derivative_sets(constants, states, inputs, contacts, rates);
        rolling
            .model
            .rolling_outputs_sets(constants, states, inputs, contacts, outputs);
        for &place in &rolling.locked {
            rates[place] = [0.0; LANES];
        }
    }
}

/// Central differences of a lane.
#[inline(always)]
fn quotients([forward, backward]: &[Rows; 2], lane: usize, into: &mut [f64]) {
    for (slope, (forward, backward)) in into.iter_mut().zip(forward.iter().zip(backward.iter())) {
        *slope = (forward[lane] - backward[lane]) / (2.0 * STEP);
    }
}
