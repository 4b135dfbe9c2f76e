//! What a moving circle sweeps: the part of an arc that advances into the ground, and the part that retreats.

use super::circle::segment_ratio;

/// Integrals over the arcs that advance, or over those that retreat; `n` is the normal out of the circle.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Sweep {
    /// `∫ |v·n| ds`: the area swept per second, m²/s.
    pub flux: f64,
    /// `∫ n |v·n| ds`, m²/s: times the radius, the first moment of what is swept, about the circle's centre.
    pub moment: [f64; 2],
}

/// Growth and shrinkage of a contact.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Sweeps {
    radius: f64,
    velocity: [f64; 2],
    /// Where the circle moves along itself: the lower of the two points, relative to the centre.
    turning: [f64; 2],
    pub growth: Sweep,
    pub shrinkage: Sweep,
}

impl Sweeps {
    #[inline]
    pub fn new(radius: f64, velocity: [f64; 2]) -> Self {
        let [vx, vz] = velocity;
        let speed = (vx * vx + vz * vz).sqrt();
        let turning = if speed > 0.0 {
            [vz / speed * radius, -vx / speed * radius]
        } else {
            [0.0, radius]
        };
        let down = if turning[1] > 0.0 {
            [-turning[0], -turning[1]]
        } else {
            turning
        };
        Self {
            radius,
            velocity,
            turning: down,
            growth: Sweep::default(),
            shrinkage: Sweep::default(),
        }
    }

    /// Adds the lower arc between two points of the circle, from the rear to the front.
    #[inline]
    pub fn add(&mut self, from: [f64; 2], to: [f64; 2]) {
        if from[0] < self.turning[0] && self.turning[0] < to[0] {
            self.add_one_way(from, self.turning);
            self.add_one_way(self.turning, to);
        } else {
            self.add_one_way(from, to);
        }
    }

    /// An arc that advances, or retreats, as a whole. In the frame of its chord the integral is
    /// `∫ n n·v ds = r (e (v·e) (δ + sin δ cos δ) + t (v·t) (δ - sin δ cos δ))` with the half angle δ, `e` across the
    /// chord and `t` along it.
    #[inline]
    fn add_one_way(&mut self, from: [f64; 2], to: [f64; 2]) {
        let along = [to[0] - from[0], to[1] - from[1]];
        let across = [along[1], -along[0]];
        let dot = |a: [f64; 2]| self.velocity[0] * a[0] + self.velocity[1] * a[1];
        let (flux, slip) = (dot(across), dot(along));
        let chord2 = along[0] * along[0] + along[1] * along[1];
        let sine2 = chord2 / (4.0 * self.radius * self.radius);

        if sine2 <= 0.0 {
            return;
        }
        let thin = sine2 * segment_ratio(sine2);
        let wide = thin + 2.0 * (1.0 - sine2).max(0.0).sqrt();
        let scale = flux.signum() / (4.0 * self.radius * sine2.sqrt());
        let (across_part, along_part) = (scale * flux * wide, scale * slip * thin);
        let side = if flux > 0.0 {
            &mut self.growth
        } else {
            &mut self.shrinkage
        };
        side.flux += flux.abs();
        side.moment[0] += across[0] * across_part + along[0] * along_part;
        side.moment[1] += across[1] * across_part + along[1] * along_part;
    }
}
