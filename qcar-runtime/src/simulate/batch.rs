//! Linear axles on smooth ground, integrated together with one lane for each: the exponential method, the contact and
//! the equations of motion run over the lanes.
//!
//! Each lane has the same bits as an [`ExponentialStepper`] alone. The contact of a tyre on more than one straight piece
//! of road is computed alone.

use super::exponential::ExponentialStepper;
use super::rolling::{Rolling, WheelStates};
use crate::model::{Contact, Contacts, LANES, Lanes, Model};
use crate::solver::ExponentialAbreast;
use crate::tyre::{Pieces, Tyre, Wheels};
use crate::vectors::{Loops, Rows, over_lanes};

const NOTHING: Lanes = [0.0; LANES];

/// A batch of rides, one in each lane.
pub(super) struct Batch<'a, M: ?Sized> {
    model: &'a M,
    tyre: Tyre,
    method: ExponentialAbreast<2>,
    relative: f64,
    /// End of the step of each lane, s.
    times: Lanes,
    constants: Rows,
    inputs: Rows,
    /// Speeds, m/s.
    speeds: Lanes,
    /// Heights of the wheels' centres in the design position, m.
    heights: Lanes,
    /// Forces on the wheels other than that of the contact, in z and x, N.
    offsets: [Lanes; 2],
    wheel: WheelStates,
    /// Indices of states that do not change.
    locked: Vec<usize>,
    pieces: Pieces,
    wheels: Wheels,
    /// True for each lane whose contact is already computed.
    found: [bool; LANES],
    contacts: Contacts,
    /// Contact forces with the other forces on the wheels added.
    driven: Contacts,
    rates: Rows,
    /// Buffer for the state of one lane.
    state: Vec<f64>,
}

impl<'a, M: Model + ?Sized> Batch<'a, M> {
    /// An empty batch for rides of this model.
    pub fn like(stepper: &mut ExponentialStepper, rolling: &Rolling<'a, M>) -> Self {
        let (relative, absolute) = stepper.tolerance();
        let absolute = absolute.to_vec();
        let (states, _) = rolling.sizes();
        Self {
            model: rolling.model,
            tyre: rolling.tyre,
            method: ExponentialAbreast::like(stepper.method(), &absolute),
            relative,
            times: NOTHING,
            constants: Rows::zero(rolling.constants.len()),
            inputs: Rows::zero(rolling.inputs.len()),
            speeds: NOTHING,
            heights: NOTHING,
            offsets: [NOTHING; 2],
            wheel: rolling.wheel,
            locked: rolling.locked.clone(),
            pieces: Pieces::none(),
            wheels: Wheels::none(),
            found: [false; LANES],
            contacts: Contacts::default(),
            driven: Contacts::default(),
            rates: Rows::zero(states),
            state: vec![0.0; states],
        }
    }

    /// True if a ride can join: its tyre, its fixed states and its method agree with the others.
    pub fn fits(&self, stepper: &mut ExponentialStepper, rolling: &Rolling<'a, M>) -> bool {
        self.tyre == rolling.tyre && self.locked == rolling.locked && self.method.fits(stepper.method())
    }

    /// Loads a ride whose stepper has begun into a lane.
    pub fn load(&mut self, lane: usize, stepper: &mut ExponentialStepper, rolling: &Rolling<'a, M>) {
        self.method.take(lane, stepper.method());
        let constants = self.constants.iter_mut().zip(&rolling.constants);
        constants.for_each(|(row, constant)| row[lane] = *constant);
        self.speeds[lane] = rolling.speed;
        self.heights[lane] = rolling.height;
        (self.offsets[0][lane], self.offsets[1][lane]) = (-rolling.load, rolling.traction);
        self.pieces.put(lane, rolling.road, rolling.piece.get());
    }

    /// Copies the state of a lane back to its ride.
    pub fn unload(&mut self, lane: usize, stepper: &mut ExponentialStepper, x: &mut [f64]) {
        self.method.give(lane, stepper.method());
        x.copy_from_slice(stepper.state());
    }

    /// Doubles the step of a lane if that is possible and enough past forces are known.
    #[inline]
    pub fn lengthen(&mut self, lane: usize, stepper: &mut ExponentialStepper, rolling: &Rolling<'_, M>) {
        if stepper.wants_longer(rolling) && self.method.may_lengthen(lane) {
            self.method.give(lane, stepper.method());
            stepper.lengthen();
            self.method.take(lane, stepper.method());
        }
    }

    /// Sets the end of the step of a lane, s.
    pub fn set_time(&mut self, lane: usize, time: f64) {
        self.times[lane] = time;
    }

    /// The end of the step of a lane, s.
    pub fn time(&self, lane: usize) -> f64 {
        self.times[lane]
    }

    /// Predicts the states of all lanes at the ends of their steps.
    pub fn predict(&mut self) {
        over_lanes(Predictor(self));
    }

    /// Predicted position of the wheel's centre of a lane, m.
    pub fn centre(&self, lane: usize) -> [f64; 2] {
        self.wheels.position.map(|axis| axis[lane])
    }

    /// Computes the contact of a lane if it is not known yet. Returns whether its force is smooth.
    #[inline]
    pub fn find_contact(&mut self, lane: usize, rolling: &Rolling<'_, M>, from: [f64; 2]) -> bool {
        let smooth = !rolling.has_kink_between(from, self.centre(lane));
        if !smooth || self.found[lane] {
            return smooth;
        }
        let predicted = self.state.iter_mut().zip(self.method.ahead());
        predicted.for_each(|(value, row)| *value = row[lane]);
        let contact = rolling.contact_at(self.times[lane], &self.state);
        self.contacts.set(lane, &contact.unwrap_or_default());
        self.pieces.put(lane, rolling.road, rolling.piece.get());
        contact.is_some()
    }

    /// Completes the step of each lane whose force is smooth. Returns which lanes stepped.
    pub fn advance(&mut self, smooth: [bool; LANES]) -> [bool; LANES] {
        over_lanes(Advance { of: self, smooth })
    }

    /// The contact of a lane.
    pub fn contact(&self, lane: usize) -> Contact {
        self.contacts.get(lane)
    }

    /// The rates of all states.
    pub fn find_rates(&mut self) {
        let (constants, state) = (&self.constants, self.method.state());
        self.model
            .rolling_derivative_sets(constants, state, &self.inputs, &self.driven, &mut self.rates);
        for &place in &self.locked {
            self.rates[place] = NOTHING;
        }
    }

    /// The computed rates.
    pub fn rates(&self) -> &[Lanes] {
        &self.rates
    }

    /// The state of a lane.
    pub fn state(&mut self, lane: usize) -> &[f64] {
        let rows = self.state.iter_mut().zip(self.method.state());
        rows.for_each(|(value, row)| *value = row[lane]);
        &self.state
    }
}

/// Prediction: states, wheels, and the contacts of wheels on a single straight piece of road.
struct Predictor<'f, 'a, M: ?Sized>(&'f mut Batch<'a, M>);

impl<M: Model + ?Sized> Loops for Predictor<'_, '_, M> {
    type Result = ();

    #[inline(always)]
    fn run(self) {
        let of = self.0;
        of.method.predict();
        let ahead = of.method.ahead();
        let still = [NOTHING; 2];
        let along = of.wheel.x.map_or(still, |places| places.map(|place| ahead[place]));
        let up = of.wheel.z.map(|place| ahead[place]);
        for lane in 0..LANES {
            of.wheels.position[0][lane] = of.speeds[lane] * of.times[lane] + along[0][lane];
            of.wheels.position[1][lane] = of.heights[lane] + up[0][lane];
            of.wheels.velocity[0][lane] = of.speeds[lane] + along[1][lane];
            of.wheels.velocity[1][lane] = up[1][lane];
        }
        let touches = of.tyre.touches(&of.pieces, &of.wheels);
        of.found = touches.holds;
        let (model, constants) = (of.model, &of.constants);
        let law = |[s, v]: [Lanes; 2]| model.contact_force_sets(constants, ahead, &s, &v);
        of.contacts = touches.pushing(&touches.strains().map(law));
    }
}

/// A step under the computed contacts.
struct Advance<'f, 'a, M: ?Sized> {
    of: &'f mut Batch<'a, M>,
    smooth: [bool; LANES],
}

impl<M: Model + ?Sized> Loops for Advance<'_, '_, M> {
    type Result = [bool; LANES];

    #[inline(always)]
    fn run(self) -> [bool; LANES] {
        let of = self.of;
        of.driven = of.contacts;
        for (force, offset) in of.driven.force.iter_mut().zip(&of.offsets) {
            for lane in 0..LANES {
                let driven = force[lane] + offset[lane];
                force[lane] = if self.smooth[lane] { driven } else { f64::NAN };
            }
        }
        of.method.advance(&of.driven.force, of.relative)
    }
}
