//! A tyre of radial springs on a road: a law that differs from the area of overlap.

use crate::axle::Axle;
use crate::hardware::RadialSprings;
use crate::road::Road;

/// Angle between two springs, rad.
const APART: f64 = 0.01;
/// Half of the sector in which springs can touch the road, rad.
const SECTOR: f64 = 0.8;
/// Deepest compression of a spring, as share of the radius.
const DEEPEST: f64 = 0.4;
/// Tolerance of the position of a spring's end, m.
const EXACT: f64 = 2e-6;
/// Number of deflections at which the sum on flat ground is tabulated.
const TABLE: usize = 400;

/// Springs between hub and tread. The road compresses each along its own direction.
pub struct Radial {
    exponent: f64,
    radius: f64,
    /// Sum of the springs' forces on flat ground for deflections up to [`DEEPEST`].
    flat: Vec<f64>,
}

impl Radial {
    /// The springs of an axle's tyre.
    pub fn new(axle: &Axle, springs: RadialSprings) -> Self {
        let mut radial = Self {
            exponent: springs.exponent,
            radius: axle.r_tire,
            flat: Vec::new(),
        };
        let flat = Road::flat();
        let sum = |k: usize| {
            let deflection = k as f64 / TABLE as f64 * DEEPEST * axle.r_tire;
            radial.sum(&flat, [1.0, axle.r_tire - deflection])[1]
        };
        radial.flat = (0..=TABLE).map(sum).collect();
        radial
    }

    /// For a position of the hub: the deflection on flat ground that gives the same force, m, and the direction of the
    /// force.
    pub fn touch(&self, road: &Road, hub: [f64; 2]) -> (f64, [f64; 2]) {
        let [x, z] = self.sum(road, hub);
        let push = x.hypot(z);
        if push <= 0.0 {
            return (0.0, [0.0, 1.0]);
        }
        let above = self.flat.partition_point(|flat| *flat < push).clamp(1, TABLE);
        let (low, high) = (self.flat[above - 1], self.flat[above]);
        let place = (above - 1) as f64 + (push - low) / (high - low);
        (place / TABLE as f64 * DEEPEST * self.radius, [x / push, z / push])
    }

    /// Sum of the springs' forces on the hub, along x and z.
    fn sum(&self, road: &Road, hub: [f64; 2]) -> [f64; 2] {
        let above = hub[1] - road.highest(hub[0] - self.radius, hub[0] + self.radius);
        let half = (above / self.radius).clamp(-1.0, 1.0).acos().min(SECTOR);
        let springs = (half / APART) as i32 + 1;
        let mut sum = [0.0; 2];
        for k in -springs..=springs {
            let (sine, cosine) = (f64::from(k) * APART).sin_cos();
            let pushed = self.compression(road, hub, [sine, -cosine]);
            if pushed > 0.0 {
                let force = (pushed / self.radius).powf(self.exponent) * APART;
                sum[0] -= force * sine;
                sum[1] += force * cosine;
            }
        }
        sum
    }

    /// Compression of the spring in a direction, m.
    fn compression(&self, road: &Road, hub: [f64; 2], direction: [f64; 2]) -> f64 {
        let depth = |length: f64| road.height(hub[0] + length * direction[0]) - hub[1] - length * direction[1];
        let (mut free, mut pushed) = ((1.0 - DEEPEST) * self.radius, self.radius);
        let (mut above, mut below) = (-depth(free), depth(pushed));
        if below <= 0.0 {
            return 0.0;
        }
        // Secant steps with the Illinois rule, which halves the depth at the retained end: exact in one step if the
        // road is straight, and convergent at a step of the road.
        while pushed - free > EXACT && above > 0.0 {
            let between = free + (pushed - free) * above / (above + below);
            let found = depth(between);
            if found.abs() < EXACT {
                return self.radius - between;
            }
            if found > 0.0 {
                (pushed, below, above) = (between, found, 0.5 * above);
            } else {
                (free, above, below) = (between, -found, 0.5 * below);
            }
        }
        self.radius - 0.5 * (free + pushed)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::axle::{Layout, Mount};

    /// On flat ground a spring at an angle is compressed by `r - (r - d) / cos`. Simpson's rule integrates over the
    /// angle.
    #[test]
    fn on_the_flat_the_deflection_comes_back() {
        let layout = Layout {
            top_mount: true,
            subframe: false,
            powertrain: Mount::None,
        };
        let axle = Axle::draw(layout, 1);
        let radial = Radial::new(&axle, RadialSprings { exponent: 1.5 });
        for deflection in [0.01, 0.02, 0.035] {
            let hub = [5.0, axle.r_tire - deflection];
            let (found, direction) = radial.touch(&Road::flat(), hub);
            assert!((found - deflection).abs() < 2e-5, "{found}, not {deflection}");
            assert!(direction[0].abs() < 1e-9);
            let half = (hub[1] / axle.r_tire).acos();
            let force = |angle: f64| {
                let pushed = (1.0 - hub[1] / axle.r_tire / angle.cos()).max(0.0);
                pushed.powf(1.5) * angle.cos()
            };
            let step = half / 1000.0;
            let whole: f64 = (-1000..1000).map(|k| force((f64::from(k) + 0.5) * step) * step).sum();
            let sum = radial.sum(&Road::flat(), hub)[1];
            assert!((sum / whole - 1.0).abs() < 0.01, "{sum}, not {whole}");
        }
    }

    /// Before a step the springs ahead push backwards; behind it the tyre stands higher by the step's height.
    #[test]
    fn a_step_pushes_back() {
        let layout = Layout {
            top_mount: true,
            subframe: false,
            powertrain: Mount::None,
        };
        let axle = Axle::draw(layout, 1);
        let radial = Radial::new(&axle, RadialSprings { exponent: 0.7 });
        let (deflection, direction) = radial.touch(&Road::cleat(0.02), [1.4, axle.r_tire - 0.02]);
        assert!(deflection > 0.02 && direction[0] < -0.01, "{deflection} {direction:?}");
    }
}
