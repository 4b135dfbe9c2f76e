//! A point contact between two events.
//!
//! Its force jumps where the road has a step or changes its slope, and where the tyre lands. Between these events it is
//! held on one piece of the road or in the air. So its force is smooth there, also for neighbouring motions, which reach
//! the event earlier or later.

use crate::road::Road;
use crate::tyre::{Touch, Tyre, Wheel};

/// What a point contact is held on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Held {
    /// The piece of road under the point.
    piece: usize,
    grounded: bool,
}

/// Number of event functions.
pub(super) const EVENTS: usize = 2;

impl Held {
    /// The contact of a wheel, until its next event.
    pub fn of(tyre: &Tyre, road: &Road, wheel: &Wheel) -> Self {
        let piece = road.segment_at(wheel.position[0]);
        Self {
            piece,
            grounded: tyre.touch_piece(road.segment(piece), wheel).deflection >= 0.0,
        }
    }

    /// The contact of this wheel or of a neighbouring one; `None` in the air.
    pub fn touch(&self, tyre: &Tyre, road: &Road, wheel: &Wheel) -> Option<Touch> {
        self.grounded.then(|| tyre.touch_piece(road.segment(self.piece), wheel))
    }

    /// The event functions: the deflection, m, which is negative in the air, and the distance by which the point is past
    /// the end of its piece, m.
    pub fn events(&self, tyre: &Tyre, road: &Road, wheel: &Wheel) -> [f64; EVENTS] {
        let [_, end] = road.span(self.piece);
        let deflection = tyre.touch_piece(road.segment(self.piece), wheel).deflection;
        [deflection, wheel.position[0] - end]
    }

    /// The rates of the event functions, m/s.
    pub fn rates(&self, tyre: &Tyre, road: &Road, wheel: &Wheel) -> [f64; EVENTS] {
        let touch = tyre.touch_piece(road.segment(self.piece), wheel);
        [touch.growth.rate - touch.shrinkage.rate, wheel.velocity[0]]
    }

    /// Time until the point reaches the end of its piece, s, predicted with the acceleration of the wheel in x (m/s²).
    pub fn until_end(&self, road: &Road, wheel: &Wheel, acceleration: f64) -> f64 {
        let [_, end] = road.span(self.piece);
        let after = (end - wheel.position[0]) / wheel.velocity[0];
        after - 0.5 * acceleration * after * after / wheel.velocity[0]
    }
}
