//! The area swept by a moving circle: the part of an arc that advances into the ground, and the part that retreats.
//!
//! The two meet at the turning point, where the circle moves along itself. At an angle θ ahead of it the circle
//! advances with `v·n = w sin θ`, so in the frame of the turning point all integrals are those of sines and cosines.

use std::array;

use super::circle::{angles, swept_directions};
use super::{against, combined, dot};

/// Integrals over the arcs that advance, or over those that retreat; `n` is the normal out of the circle.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Sweep {
    /// `∫ |v·n| ds`: the area swept per second, m²/s.
    pub flux: f64,
    /// `∫ n |v·n| ds`, m²/s; times the radius, it is the first moment of the swept area per second about the circle's
    /// centre.
    pub moment: [f64; 2],
}

/// The parts of a contact's rim before and after the turning point: one grows, the other shrinks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Sweeps {
    radius: f64,
    per_radius: f64,
    /// Speed w along the circle at the turning point, positive to the front.
    speed: f64,
    /// The direction of the circle there; its normal out of the circle points down.
    along: [f64; 2],
    /// The part ahead of the turning point, with the moment along the circle and across it there.
    ahead: Sweep,
    /// The part behind, with the sign of `sin θ`: negative.
    behind: Sweep,
}

/// One of the two parts of a contact's rim, without its moment: that of a single arc has a closed direction.
#[derive(Clone, Copy, Debug)]
pub(super) struct Part {
    /// The area swept per second, m²/s.
    pub flux: f64,
    /// The unit vector from the centroid of the swept area to the circle's centre.
    pub direction: [f64; 2],
}

/// A point of the circle by its angle θ ahead of the turning point, with integrals from there to it.
#[derive(Clone, Copy, Debug)]
struct Rim {
    angle: f64,
    sine: f64,
    /// `∫ sin θ dθ`, and with the normal `∫ n sin θ dθ`.
    sweep: Sweep,
}

impl Sweeps {
    #[inline(always)]
    pub fn new(radius: f64, velocity: [f64; 2]) -> Self {
        let speed = dot(velocity, velocity).sqrt().copysign(velocity[0]);
        // A wheel at rest sweeps nothing, wherever its arcs are split.
        let direction = |axis: usize, at_rest: f64| if speed != 0.0 { velocity[axis] / speed } else { at_rest };
        Self::turning(radius, speed, [direction(0, 1.0), direction(1, 0.0)])
    }

    /// The sweeps of a circle that moves along itself at its turning point, with a speed in a direction.
    #[inline(always)]
    pub fn turning(radius: f64, speed: f64, along: [f64; 2]) -> Self {
        Self {
            radius,
            per_radius: 1.0 / radius,
            speed,
            along,
            ahead: Sweep::default(),
            behind: Sweep::default(),
        }
    }

    /// Speed and direction along the circle at its turning point.
    #[inline(always)]
    pub fn turn(&self) -> (f64, [f64; 2]) {
        (self.speed, self.along)
    }

    /// Adds the lower arc between two points of the circle, from the rear to the front. Returns its angle.
    #[inline]
    pub fn add(&mut self, from: [f64; 2], to: [f64; 2]) -> f64 {
        let [from, to] = self.rims([from, to]);
        if from.sine < 0.0 && 0.0 < to.sine {
            self.ahead = self.ahead.plus(&to.sweep, 1.0);
            self.behind = self.behind.plus(&from.sweep, -1.0);
        } else {
            let side = if from.sine < 0.0 {
                &mut self.behind
            } else {
                &mut self.ahead
            };
            *side = side.plus(&to.sweep, 1.0).plus(&from.sweep, -1.0);
        }
        to.angle - from.angle
    }

    /// Growth and shrinkage of a single arc, and true if it is short and contains the turning point; otherwise they are
    /// not valid.
    #[inline(always)]
    pub fn across(&self, from: [f64; 2], to: [f64; 2]) -> ([Part; 2], bool) {
        self.between(self.places([from, to]))
    }

    /// The same between sines and cosines.
    #[inline(always)]
    pub fn between(&self, (sine, cosine): ([f64; 2], [f64; 2])) -> ([Part; 2], bool) {
        let up = [-self.along[1], self.along[0]];
        let (directions, are_short) = swept_directions(sine, cosine);
        let [behind, ahead] = array::from_fn(|i| Part {
            flux: self.radius * self.speed.abs() * (1.0 - cosine[i]),
            direction: combined([-directions[i][0], directions[i][1]], self.along, up),
        });
        let is_across = (sine[0] < 0.0) & (0.0 < sine[1]) & are_short;
        let forward = self.speed > 0.0;
        let parts = [ahead.or(behind, !forward), behind.or(ahead, !forward)];
        (parts, is_across)
    }

    /// Growth and shrinkage of all arcs.
    #[inline]
    pub fn finish(&self) -> [Sweep; 2] {
        let scale = self.radius * self.speed.abs();
        let down = [self.along[1], -self.along[0]];
        let swept = |sweep: &Sweep, scale: f64| Sweep {
            flux: scale * sweep.flux,
            moment: combined([scale * sweep.moment[0], scale * sweep.moment[1]], self.along, down),
        };
        self.growth_first(swept(&self.ahead, scale), swept(&self.behind, -scale))
    }

    /// Orders the parts as growth and shrinkage: the part ahead of the turning point grows if the wheel rolls to the
    /// front.
    #[inline(always)]
    fn growth_first<T>(&self, ahead: T, behind: T) -> [T; 2] {
        if self.speed > 0.0 {
            [ahead, behind]
        } else {
            [behind, ahead]
        }
    }

    #[inline]
    fn rims(&self, points: [[f64; 2]; 2]) -> [Rim; 2] {
        let (sine, cosine) = self.places(points);
        let angle = angles(sine, cosine);
        array::from_fn(|i| Rim {
            angle: angle[i],
            sine: sine[i],
            sweep: Sweep {
                flux: 1.0 - cosine[i],
                moment: [0.5 * (angle[i] - sine[i] * cosine[i]), 0.5 * sine[i] * sine[i]],
            },
        })
    }

    /// Sines and cosines of the angles of two points of the circle.
    #[inline(always)]
    pub fn places(&self, points: [[f64; 2]; 2]) -> ([f64; 2], [f64; 2]) {
        let [along, down] = [self.along, [self.along[1], -self.along[0]]].map(|v| v.map(|v| v * self.per_radius));
        (
            points.map(|point| dot(point, along)),
            points.map(|point| dot(point, down)),
        )
    }
}

impl Sweep {
    #[inline]
    fn plus(&self, other: &Self, times: f64) -> Self {
        Self {
            flux: self.flux + times * other.flux,
            moment: [
                self.moment[0] + times * other.moment[0],
                self.moment[1] + times * other.moment[1],
            ],
        }
    }
}

impl Part {
    /// This part, or `other` if `wanted`: number by number, so that each lane can choose.
    #[inline(always)]
    fn or(self, other: Self, wanted: bool) -> Self {
        let choose = |own: f64, other: f64| if wanted { other } else { own };
        Self {
            flux: choose(self.flux, other.flux),
            direction: array::from_fn(|axis| choose(self.direction[axis], other.direction[axis])),
        }
    }
}

impl From<Sweep> for Part {
    #[inline]
    fn from(sweep: Sweep) -> Self {
        Self {
            flux: sweep.flux,
            direction: against(sweep.moment),
        }
    }
}
