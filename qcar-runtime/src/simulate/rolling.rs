//! A model whose tyre rolls over a road: the right-hand side of thesis figure 3.2.

use std::array;
use std::cell::Cell;

use super::car::Car;
use super::equilibrium;
use super::failure::{SimulateError, positive};
use super::held::{self, Held};
use super::settings::scales;
use crate::model::{Contact, ContactAbout, Model};
use crate::road::Road;
use crate::tyre::{Geometry, Touch, Tyre, Wheel};

/// The rolling model, its road and its speed.
pub(super) struct Rolling<'a, M: ?Sized> {
    pub model: &'a M,
    pub constants: Vec<f64>,
    /// Inputs, all zero: the preloads of the links balance gravity, and the road acts through the contact only.
    pub inputs: Vec<f64>,
    pub tyre: Tyre,
    /// Static load of the tyre, N.
    pub load: f64,
    pub road: &'a Road,
    /// Height of the wheel's centre in the design position, m.
    pub height: f64,
    /// Speed, m/s.
    pub speed: f64,
    pub wheel: WheelStates,
    /// Indices of states that do not move.
    pub locked: Vec<usize>,
    /// The constant force in x that balances the rolling drag on a flat road, N.
    pub traction: f64,
    /// The piece of road that was last under the tyre.
    pub piece: Cell<usize>,
    /// For derivatives, what a point contact is held on until its next event.
    pub held: Option<Held>,
    /// Position of the next vertical step, m, for a tyre that responds to a step at once.
    smooth_until: f64,
    /// Sharp edges of the road. The force of a circle has a kink when its rim reaches one of these points.
    edges: Vec<[f64; 2]>,
    /// Position from which the ground under the circle is level, m.
    level_from: f64,
    /// Position from which the force is smooth except at edges, m: a point contact responds to each piece of the road.
    pub smooth_from: f64,
}

/// Number of inputs of an axle from its contact: forces in z and x, deflection and rate.
pub(super) const GIVEN: usize = 4;

/// Changes of a position, m, and of a velocity, m/s, for difference quotients of the contact's force: large enough that
/// rounding is negligible, and far below the deflection of any tyre.
const SMALL_MOTION: [f64; 2] = [1e-7, 1e-5];
/// The same for a state of the tyre, on which its law depends linearly, relative to the size of the state.
const SMALL_PART: f64 = 1e-3;
/// Deflections, m, and their rates, m/s, at which two laws of a contact are compared.
const PROBES: [[f64; 2]; 3] = [[-0.01, 0.1], [-0.02, -1.0], [-0.035, 0.4]];

/// Indices of the wheel's position and velocity in z and, if it moves there, in x.
#[derive(Clone, Copy)]
pub(super) struct WheelStates {
    pub z: [usize; 2],
    pub x: Option<[usize; 2]>,
}

impl WheelStates {
    fn new(about: &ContactAbout) -> Self {
        let mut places = about
            .axes
            .iter()
            .map(|axis| [axis.position, axis.velocity].map(usize::from));
        Self {
            z: places.next().unwrap_or_default(),
            x: places.next(),
        }
    }
}

impl<'a, M: Model + ?Sized> Rolling<'a, M> {
    /// A car at rest at time `t` on flat ground, and its state.
    ///
    /// On a flat road, the tyre's damping causes a drag, since the contact grows at its front and shrinks at its rear.
    /// A constant traction balances it, so that the car does not move on flat ground.
    pub fn at_rest(car: &Car<'a, M>, road: &'a Road, speed: f64, t: f64) -> Result<(Self, Vec<f64>), SimulateError> {
        Self::at_rest_near(&vec![0.0; car.model.about().states.len()], car, road, speed, t)
    }

    /// The same, with a state that is near a known one.
    pub fn at_rest_near(
        known: &[f64],
        car: &Car<'a, M>,
        road: &'a Road,
        speed: f64,
        t: f64,
    ) -> Result<(Self, Vec<f64>), SimulateError> {
        let (contact, about, tyre) = (car.contact()?, car.model.about(), car.rolling_tyre());
        let level_from = level_from(road) + tyre.radius();
        let mut rolling = Self {
            model: car.model,
            constants: car.constants(),
            inputs: vec![0.0; about.inputs.len()],
            tyre,
            load: positive("the static load of the tyre", car.load, "N")?,
            road,
            height: road.vertices()[0][1] + tyre.radius() - tyre.static_deflection(),
            speed,
            wheel: WheelStates::new(contact),
            locked: car.locked(contact),
            traction: 0.0,
            piece: Cell::new(0),
            held: None,
            smooth_until: f64::INFINITY,
            edges: edges(tyre.geometry(), road),
            level_from,
            smooth_from: match tyre.geometry() {
                Geometry::Area | Geometry::Radial => f64::NEG_INFINITY,
                Geometry::Point => level_from,
            },
        };
        let mut x = known.to_vec();
        let scales: Vec<f64> = scales(about).collect();
        let settled = equilibrium::settle(&scales, |x, dx| rolling.derivative_without_drag(t, x, dx), &mut x);
        settled.map_err(|unbalanced| car.unbalanced(&unbalanced))?;
        rolling.check_stands(t, &x)?;
        rolling.traction = -rolling.contact(rolling.touch(t, &x).as_ref(), &x).force[1];
        Ok((rolling, x))
    }

    /// Checks that the static deflection is less than the radius, and that the force increases with the deflection.
    fn check_stands(&self, t: f64, x: &[f64]) -> Result<(), SimulateError> {
        let (radius, deflection) = (self.tyre.radius(), self.deflection(t, x));
        if deflection >= radius {
            return Err(SimulateError::TooSoft { deflection, radius });
        }
        let push = |x: &[f64]| self.contact(self.touch(t, x).as_ref(), x).force[0];
        let mut lower = x.to_vec();
        lower[self.wheel.z[0]] -= 1e-3 * deflection;
        if push(&lower) > push(x) {
            Ok(())
        } else {
            Err(SimulateError::Unstable { deflection })
        }
    }

    fn derivative_without_drag(&self, t: f64, x: &[f64], dx: &mut [f64]) {
        let mut contact = self.driven(self.contact(self.touch(t, x).as_ref(), x));
        contact.force[1] = 0.0;
        self.model
            .rolling_derivative(&self.constants, x, &self.inputs, &contact, dx);
    }

    /// Computes `dx/dt` and, if `y` is not empty, the outputs of the model at time `t`. Returns the contact; `None` in
    /// the air.
    #[inline(always)]
    pub fn motion(&self, t: f64, x: &[f64], dx: &mut [f64], y: &mut [f64]) -> Option<Contact> {
        let contact = self.touch(t, x).map(|touch| self.contact(Some(&touch), x));
        self.move_by(&self.driven(contact.unwrap_or_default()), x, dx, y);
        contact
    }

    /// Computes `dx/dt` and, if `y` is not empty, the outputs of the model under given forces.
    #[inline(always)]
    pub fn move_by(&self, driven: &Contact, x: &[f64], dx: &mut [f64], y: &mut [f64]) {
        self.model
            .rolling_derivative(&self.constants, x, &self.inputs, driven, dx);
        for &place in &self.locked {
            dx[place] = 0.0;
        }
        if !y.is_empty() {
            self.model.rolling_outputs(&self.constants, x, &self.inputs, driven, y);
        }
    }

    /// Number of states and of outputs of the model.
    pub fn sizes(&self) -> (usize, usize) {
        let about = self.model.about();
        (about.states.len(), about.outputs.len())
    }

    /// True if the model is linear apart from the contact.
    pub fn is_linear_beside_contact(&self) -> bool {
        let deflected = |by: f64| {
            let given = Contact {
                s: by,
                v: 2.0 * by,
                force: [0.0; 2],
            };
            let states = vec![0.0; self.sizes().0];
            let mut rate = states.clone();
            self.move_by(&given, &states, &mut rate, &mut []);
            rate
        };
        let twice = |once: f64| 2.0 * once;
        self.model.about().linear && deflected(1.0).into_iter().map(twice).eq(deflected(2.0))
    }

    /// True if, in addition, the contact acts by its force only: the tyre has no inner states.
    pub fn is_linear(&self) -> bool {
        let states = vec![0.0; self.sizes().0];
        let mut rate = states.clone();
        let moving = Contact {
            s: 1.0,
            v: 1.0,
            force: [0.0; 2],
        };
        self.move_by(&moving, &states, &mut rate, &mut []);
        self.model.about().linear && rate == states
    }

    /// The contact at time `t`; `None` in the air.
    #[inline(always)]
    pub fn contact_at(&self, t: f64, x: &[f64]) -> Option<Contact> {
        let touch = self.touch(t, x)?;
        Some(self.contact(Some(&touch), x))
    }

    /// The inputs of the axle from the contact at time `t`: the forces on the wheel relative to rest, N, in z and x,
    /// and for a tyre with inner states its deflection and rate, m and m/s.
    pub fn given(&self, t: f64, x: &[f64]) -> [f64; GIVEN] {
        self.inputs_of(self.contact_at(t, x))
    }

    /// The same from a known contact; `None` in the air.
    pub fn inputs_of(&self, contact: Option<Contact>) -> [f64; GIVEN] {
        let contact = self.driven(contact.unwrap_or_default());
        [contact.force[0], contact.force[1], contact.s, contact.v]
    }

    /// The same, computed from what is known of another car in the same state: how its tyre touches the road.
    pub fn given_beside(&self, (other, touch): (&Self, Option<&Touch>), t: f64, x: &[f64]) -> [f64; GIVEN] {
        if self.tyre == other.tyre && self.height == other.height {
            self.inputs_of(touch.map(|touch| self.contact(Some(touch), x)))
        } else {
            self.given(t, x)
        }
    }

    /// Indices of the states on which the contact depends, each with a small change for a difference quotient.
    pub fn touching(&self) -> Vec<(usize, f64)> {
        let axes = [Some(self.wheel.z), self.wheel.x].into_iter().flatten();
        let of_axis = |[position, velocity]: [usize; 2]| [(position, SMALL_MOTION[0]), (velocity, SMALL_MOTION[1])];
        let mut touching: Vec<(usize, f64)> = axes.flat_map(of_axis).collect();
        let mut x = self.nowhere_zero();
        for (state, scale) in scales(self.model.about()).enumerate() {
            let was = self.laws(&x);
            x[state] += scale;
            if self.laws(&x) != was {
                touching.push((state, SMALL_PART * scale));
            }
            x[state] -= scale;
        }
        touching
    }

    /// True if the contact of another car gives the same inputs at the same state.
    pub fn is_touched_like(&self, other: &Self) -> bool {
        let laws = [self, other].map(|own| own.laws(&own.nowhere_zero()));
        let others = |own: &Self| (own.tyre, own.height, own.load, own.traction);
        laws[0] == laws[1] && others(self) == others(other)
    }

    /// Forces of the contact's law at some deflections and rates.
    fn laws(&self, x: &[f64]) -> [f64; 3] {
        PROBES.map(|[s, v]| self.model.contact_force(&self.constants, x, s, v))
    }

    /// A state without zeros, at which every law that depends on a state has an effect of it.
    fn nowhere_zero(&self) -> Vec<f64> {
        let scales = scales(self.model.about()).enumerate();
        scales.map(|(state, scale)| (1 + state) as f64 * scale).collect()
    }

    /// Position of the wheel's centre at time `t`, m.
    pub fn centre(&self, t: f64, x: &[f64]) -> [f64; 2] {
        self.wheel(t, x).position
    }

    /// True if a wheel with this centre is on ground that stays level.
    pub fn is_level(&self, centre: [f64; 2]) -> bool {
        centre[0] >= self.level_from
    }

    /// True if the force of the tyre is not smooth between two positions of the wheel's centre: its rim has passed an
    /// edge of the road, or it is a point contact on uneven ground.
    #[inline(always)]
    pub fn has_kink_between(&self, from: [f64; 2], to: [f64; 2]) -> bool {
        let squared = self.tyre.radius() * self.tyre.radius();
        let inside = |centre: [f64; 2], edge: &[f64; 2]| {
            let [x, z] = [centre[0] - edge[0], centre[1] - edge[1]];
            x * x + z * z < squared
        };
        from[0] < self.smooth_from
            || !self.is_level(from) && self.edges_near(to).any(|edge| inside(from, edge) != inside(to, edge))
    }

    /// The edges of the road near a wheel with this centre.
    fn edges_near(&self, centre: [f64; 2]) -> impl Iterator<Item = &[f64; 2]> {
        let [behind, ahead] = [-2.0, 2.0].map(|radii| centre[0] + radii * self.tyre.radius());
        let first = self.edges.partition_point(|edge| edge[0] < behind);
        self.edges[first..].iter().take_while(move |edge| edge[0] <= ahead)
    }

    /// The contact of the tyre with the road at time `t`.
    #[inline(always)]
    pub fn touch(&self, t: f64, x: &[f64]) -> Option<Touch> {
        let mut wheel = self.wheel(t, x);
        if let Some(held) = &self.held {
            return held.touch(&self.tyre, self.road, &wheel);
        }
        // Before a step of the road becomes an event, the solver extrapolates as if there were none.
        wheel.position[0] = wheel.position[0].min(self.smooth_until);
        self.tyre.touch_near(self.road, &wheel, &self.piece)
    }

    /// Deflection of the tyre at time `t`, m.
    pub fn deflection(&self, t: f64, x: &[f64]) -> f64 {
        self.touch(t, x).map_or(0.0, |touch| touch.deflection)
    }

    /// Distance of the wheel's centre from the next vertical step to which its tyre responds at once, m.
    pub fn to_next_step(&self, t: f64, x: &[f64]) -> f64 {
        self.smooth_until.next_up() - self.wheel(t, x).position[0]
    }

    /// Updates the position of the next vertical step after the wheel has passed one.
    pub fn pass_steps(&mut self, t: f64, x: &[f64]) {
        if self.tyre.geometry() == Geometry::Point {
            let here = self.wheel(t, x).position[0];
            let next = self.road.steps().find(|&step| step > here);
            self.smooth_until = next.map_or(f64::INFINITY, f64::next_down);
        }
    }

    /// What a point contact is held on from time `t` to its next event; `None` for other tyres.
    pub fn held_at(&self, t: f64, x: &[f64]) -> Option<Held> {
        let is_point = self.tyre.geometry() == Geometry::Point;
        is_point.then(|| Held::of(&self.tyre, self.road, &self.wheel(t, x)))
    }

    /// The event functions of a contact that is held, and their rates.
    pub fn held_events(&self, t: f64, x: &[f64]) -> Option<[[f64; held::EVENTS]; 2]> {
        let (held, wheel) = (self.held?, self.wheel(t, x));
        Some([Held::events, Held::rates].map(|of| of(&held, &self.tyre, self.road, &wheel)))
    }

    /// The first time after `from` at which the rim of the tyre reaches or leaves an edge of the road, or a held point
    /// the end of its piece, predicted at time `t`.
    pub fn next_kink(&self, t: f64, x: &[f64], dx: &[f64], from: f64) -> f64 {
        let (wheel, radius) = (self.wheel(t, x), self.tyre.radius());
        let acceleration = [self.wheel.x.map_or(0.0, |x| dx[x[1]]), dx[self.wheel.z[1]]];
        if let Some(held) = &self.held {
            let end = t + held.until_end(self.road, &wheel, acceleration[0]);
            return if end > from { end } else { f64::INFINITY };
        }
        let near = self.edges_near(wheel.position);
        let crossings = near.flat_map(|edge| crossings(&wheel, acceleration, radius, edge));
        let times = crossings.map(|after| t + after).filter(|&time| time > from);
        times.fold(f64::INFINITY, f64::min)
    }

    /// The wheel's centre. It is above x = 0 at t = 0, and then moves with the constant speed plus the displacement
    /// `x_wheel`.
    #[inline]
    fn wheel(&self, t: f64, x: &[f64]) -> Wheel {
        let [z, vz] = self.wheel.z.map(|place| x[place]);
        let [ahead, faster] = self.wheel.x.map_or([0.0; 2], |places| places.map(|place| x[place]));
        Wheel {
            position: [self.speed * t + ahead, self.height + z],
            velocity: [self.speed + faster, vz],
        }
    }

    /// The inputs of the model from a contact. Without contact, the force is zero and the tyre's link is at rest.
    #[inline]
    pub fn contact(&self, touch: Option<&Touch>, x: &[f64]) -> Contact {
        let law = |s: f64, v: f64| self.model.contact_force(&self.constants, x, s, v);
        touch.map_or(Contact::default(), |touch| match self.held {
            Some(_) => touch.continued_force(law),
            None => touch.force(law),
        })
    }

    /// The forces on the wheel relative to rest: that of the contact, minus the static load, which the preloads of the
    /// suspension balance, plus the traction.
    #[inline]
    pub fn driven(&self, mut contact: Contact) -> Contact {
        contact.force[0] -= self.load;
        contact.force[1] += self.traction;
        contact
    }
}

/// Difference quotient of the inputs from a contact.
pub(super) fn slope(from: [f64; GIVEN], to: [f64; GIVEN], by: f64) -> [f64; GIVEN] {
    array::from_fn(|input| (to[input] - from[input]) / by)
}

fn edges(geometry: Geometry, road: &Road) -> Vec<[f64; 2]> {
    match geometry {
        Geometry::Area | Geometry::Radial => road.edges().collect(),
        // For a point contact, a step is an event, and nothing acts before the point reaches it.
        Geometry::Point => Vec::new(),
    }
}

/// Position from which a road stays level, m; minus infinity if it is level everywhere.
fn level_from(road: &Road) -> f64 {
    let uneven = road.vertices().windows(2).rfind(|pair| pair[0][1] != pair[1][1]);
    uneven.map_or(f64::NEG_INFINITY, |pair| pair[1][0])
}

/// Times until the rim of a circle reaches a point and until it leaves it, s; NaN if it does not.
fn crossings(wheel: &Wheel, acceleration: [f64; 2], radius: f64, point: &[f64; 2]) -> [f64; 2] {
    let ([x, z], [vx, vz], [ax, az]) = (wheel.position, wheel.velocity, acceleration);
    let (dx, dz) = (point[0] - x, point[1] - z);
    // At constant velocity the squared distance is a parabola of time; the acceleration gives a correction.
    let (squared, along) = (vx * vx + vz * vz, dx * vx + dz * vz);
    let root = (along * along - squared * (dx * dx + dz * dz - radius * radius)).sqrt();
    [-root, root].map(|root| {
        let after = (along + root) / squared;
        let (x, z) = (dx - after * vx, dz - after * vz);
        after - 0.5 * after * after * (x * ax + z * az) / (x * vx + z * vz)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_rim_comes_over_a_point_at_the_predicted_time() {
        let wheel = Wheel {
            position: [1.2, 0.29],
            velocity: [8.0, -0.3],
        };
        let (radius, acceleration, point) = (0.32, [5.0, 40.0], [1.41, 0.03]);
        let distance = |after: f64| {
            let at = |axis: usize| {
                wheel.position[axis] + after * (wheel.velocity[axis] + 0.5 * after * acceleration[axis]) - point[axis]
            };
            at(0).hypot(at(1))
        };
        let [over, left] = crossings(&wheel, acceleration, radius, &point);
        assert!(0.0 < over && over < left, "{over} {left}");
        assert!((distance(over) - radius).abs() < 1e-5, "{}", distance(over));
        let out_of_reach = crossings(&wheel, acceleration, radius, &[1.41, -0.1]);
        assert!(out_of_reach.iter().all(|after| after.is_nan()));
    }

    #[test]
    fn edges_are_the_ends_of_steps_and_not_the_chords_of_curves() {
        let cleat = Road::from_points(&[
            [0.0, 0.0],
            [1.5, 0.0],
            [1.5, 0.03],
            [1.9, 0.005],
            [1.95, 0.0027],
            [2.0, 0.0013],
            [2.05, 0.0006],
            [2.1, 0.0003],
            [9.0, 0.0003],
        ]);
        let edges = edges(Geometry::Area, &cleat.expect("a road"));
        assert_eq!(edges, [[1.5, 0.0], [1.5, 0.03]]);
    }
}
