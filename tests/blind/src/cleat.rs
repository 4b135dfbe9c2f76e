//! The track: a tyre rolls over a cleat. Its force follows from the area of its overlap with the road, summed column by
//! column.

use crate::corner::{
    BODY, COORDINATES, Corner, FLEX, PITCH, PWT, Push, SF, STATES, State, WHEEL, X_BODY, X_PWT, X_SF, X_WHEEL,
};
use crate::enveloping::EffectiveRoad;
use crate::integrate::step;
use crate::programme::CleatRun;
use crate::radial::Radial;
use crate::rig::RATE;
use crate::road::Road;

/// Overlap of the circle with the ground.
#[derive(Default)]
struct Overlap {
    area: f64,
    moment: [f64; 2],
    growth: [f64; 3],
    shrinkage: [f64; 3],
}

/// Width of a column of the sum, m.
const COLUMN: f64 = 5e-4;

/// The columns of the circle that can overlap the ground: all others are above the highest point of the ground under
/// the circle.
fn touching(road: &Road, radius: f64, centre: [f64; 2]) -> (usize, usize) {
    let above = centre[1] - road.highest(centre[0] - radius, centre[0] + radius);
    if above >= radius {
        return (0, 0);
    }
    let half = (radius * radius - above.max(0.0).powi(2)).sqrt();
    let columns = (2.0 * radius / COLUMN) as usize;
    let first = ((radius - half) / COLUMN) as usize;
    let end = ((radius + half) / COLUMN) as usize;
    (first.saturating_sub(2), (end + 2).min(columns))
}

fn overlap(road: &Road, radius: f64, centre: [f64; 2], velocity: [f64; 2]) -> Overlap {
    let mut sum = Overlap::default();
    let reach = |dx: f64| (radius * radius - dx * dx).max(0.0).sqrt();
    let depth = |dx: f64| road.height(centre[0] + dx) - centre[1] + reach(dx);
    let middle = |k: usize| -radius + (k as f64 + 0.5) * COLUMN;
    let (first, end) = touching(road, radius, centre);
    let mut left = match first {
        0 => depth(-radius),
        _ => depth(middle(first - 1) + COLUMN / 2.0),
    };
    for k in first..end {
        let dx = middle(k);
        let right = depth(dx + COLUMN / 2.0);
        let inside = left.max(0.0) + right.max(0.0);
        // A column at an edge is only partly in the ground. If it counted in full, the force would jump when it enters
        // or leaves.
        let share = inside / (left.abs() + right.abs()).max(f64::MIN_POSITIVE);
        left = right;
        if inside <= 0.0 {
            continue;
        }
        let (reach, depth) = (reach(dx), inside / 2.0);
        let area = depth * share * COLUMN;
        sum.area += area;
        sum.moment[0] += area * dx;
        sum.moment[1] += area * (depth / 2.0 - reach);
        // The arc over this column moves with the wheel: normal speed times arc length is the rate at which it sweeps
        // area.
        let (nx, nz) = (dx / radius, -reach / radius);
        let swept = (velocity[0] * nx + velocity[1] * nz) * share * COLUMN * radius / reach;
        let part = if swept > 0.0 {
            &mut sum.growth
        } else {
            &mut sum.shrinkage
        };
        part[0] += swept;
        part[1] += swept * dx;
        part[2] += swept * -reach;
    }
    sum
}

/// Area of a circle's segment of depth `d`, m².
fn segment(radius: f64, d: f64) -> f64 {
    let d = d.clamp(0.0, radius);
    radius * radius * (1.0 - d / radius).acos() - (radius - d) * (2.0 * radius * d - d * d).sqrt()
}

fn deflection(radius: f64, area: f64) -> f64 {
    let (mut low, mut high) = (0.0, radius);
    for _ in 0..45 {
        let middle = 0.5 * (low + high);
        if segment(radius, middle) < area {
            low = middle
        } else {
            high = middle
        }
    }
    0.5 * (low + high)
}

fn towards_centre(moment: [f64; 2], scale: f64) -> [f64; 2] {
    let (x, z) = (-moment[0] / scale, -moment[1] / scale);
    let length = x.hypot(z).max(1e-12);
    [x / length, z / length]
}

/// The tyre of a corner over a road at constant speed.
struct Rolling<'a> {
    corner: &'a Corner<'a>,
    road: &'a Road,
    law: Law,
    speed: f64,
    /// Delay of the logger's trigger, s.
    late: f64,
    drag: f64,
}

/// The force law between tyre and road.
enum Law {
    Area,
    Radial(Radial),
    Cams(EffectiveRoad),
}

impl Law {
    fn of(corner: &Corner, road: &Road) -> Self {
        let (axle, laws) = (corner.axle, corner.laws);
        if let Some(cams) = laws.cams {
            return Self::Cams(EffectiveRoad::new(road, axle, cams));
        }
        laws.radial_springs
            .map_or(Self::Area, |springs| Self::Radial(Radial::new(axle, springs)))
    }
}

/// Time step of the difference quotient that gives the rate of deflection, s.
const MOMENT: f64 = 1e-4;

impl Rolling<'_> {
    /// Force on the tyre's ring beyond the static load, and the longitudinal force at rest.
    fn push(&self, t: f64, y: &State) -> Push {
        let t = t + self.late;
        match &self.law {
            Law::Area => self.push_of_area(t, y),
            Law::Radial(radial) => self.push_of_springs(radial, t, y),
            Law::Cams(felt) => self.push_of_cams(felt, t, y),
        }
    }

    /// Position and velocity of the wheel's centre.
    fn hub(&self, t: f64, y: &State) -> ([f64; 2], [f64; 2]) {
        let a = self.corner.axle;
        let ring = self.corner.ring();
        (
            [self.speed * t + y[X_WHEEL], a.r_tire - self.tread_at_rest() + y[ring]],
            [self.speed + y[COORDINATES + X_WHEEL], y[COORDINATES + ring]],
        )
    }

    /// A spring and damper along the sum of the radial springs (see [`crate::hardware::RadialSprings`]).
    fn push_of_springs(&self, radial: &Radial, t: f64, y: &State) -> Push {
        let (hub, velocity) = self.hub(t, y);
        let (deflection, direction) = radial.touch(self.road, hub);
        let soon = [hub[0] + velocity[0] * MOMENT, hub[1] + velocity[1] * MOMENT];
        let rate = (radial.touch(self.road, soon).0 - deflection) / MOMENT;
        self.along(y, deflection, rate, direction)
    }

    /// The same across the effective plane (see [`crate::hardware::Cams`]).
    fn push_of_cams(&self, felt: &EffectiveRoad, t: f64, y: &State) -> Push {
        let (hub, velocity) = self.hub(t, y);
        let [height, growth, slope] = felt.at(hub[0]);
        let cosine = 1.0 / slope.hypot(1.0);
        let deflection = self.tread_at_rest() + (height - y[self.corner.ring()]) * cosine;
        let rate = (growth * velocity[0] - velocity[1]) * cosine;
        self.along(y, deflection, rate, [-slope * cosine, cosine])
    }

    /// Force of a spring and damper along a direction. The road cannot pull.
    fn along(&self, y: &State, deflection: f64, rate: f64, direction: [f64; 2]) -> Push {
        let a = self.corner.axle;
        let spring = self.pressed(deflection.max(0.0)) + self.corner.tire_memory(y);
        let force = if deflection > 0.0 {
            (spring + a.c_tire * rate).max(0.0)
        } else {
            0.0
        };
        Push {
            z: force * direction[1] - a.static_load(),
            x: force * direction[0] - self.drag,
            compression_rate: if deflection > 0.0 { rate } else { 0.0 },
        }
    }

    fn push_of_area(&self, t: f64, y: &State) -> Push {
        let a = self.corner.axle;
        let (centre, velocity) = self.hub(t, y);
        let o = overlap(self.road, a.r_tire, centre, velocity);
        if o.area <= 0.0 {
            return Push {
                z: -a.static_load(),
                x: -self.drag,
                compression_rate: 0.0,
            };
        }
        let d = deflection(a.r_tire, o.area);
        let width = 2.0 * (2.0 * a.r_tire * a.static_tire_def - a.static_tire_def.powi(2)).sqrt();
        let e = towards_centre(o.moment, o.area);
        let spring = (self.pressed(d) + self.corner.tire_memory(y)).max(0.0);
        let grow = a.c_tire * o.growth[0] / width;
        let shrink = (a.c_tire * o.shrinkage[0] / width).max(-spring);
        let eg = towards_centre([o.growth[1], o.growth[2]], o.growth[0].max(1e-12));
        let es = towards_centre([-o.shrinkage[1], -o.shrinkage[2]], (-o.shrinkage[0]).max(1e-12));
        Push {
            z: spring * e[1] + grow * eg[1] + shrink * es[1] - a.static_load(),
            x: spring * e[0] + grow * eg[0] + shrink * es[0] - self.drag,
            compression_rate: (o.growth[0] + o.shrinkage[0]) / width,
        }
    }

    /// Deflection of the tread under the static load, m. The sidewalls have the rest of the tyre's deflection.
    fn tread_at_rest(&self) -> f64 {
        let a = self.corner.axle;
        let sidewalls = self
            .corner
            .laws
            .belt
            .map_or(0.0, |belt| a.static_load() / belt.k_sidewall);
        a.static_tire_def - sidewalls
    }

    /// Static force over the deflection of the tread, N.
    fn pressed(&self, tread: f64) -> f64 {
        self.elastic(self.corner.whole_tire(tread, |d| self.elastic(d.max(0.0))))
    }

    /// Static force, N, over the deflection of the whole tyre. The curve passes through zero and the static point,
    /// where it has the slope measured on the rig.
    fn elastic(&self, d: f64) -> f64 {
        let a = self.corner.axle;
        let (f0, d0) = (a.static_load(), a.static_tire_def);
        let exponent = a.k_tire * d0 / f0;
        let growth = self.corner.laws.tire_increase.unwrap_or(0.0);
        let other = self.corner.laws.other.map_or(0.0, |law| law.tire(a.k_tire, d - d0));
        f0 * (d / d0).powf(exponent) + 0.5 * a.k_tire * growth / d0 * (d - d0).max(0.0).powi(2) + other
    }
}

/// Accelerations sampled at [`RATE`], m/s².
#[derive(Default)]
pub struct Track {
    pub wheel_z: Vec<f64>,
    pub body_z: Vec<f64>,
    pub sf_front_z: Vec<f64>,
    pub sf_rear_z: Vec<f64>,
    pub pwt_z: Vec<f64>,
    pub wheel_x: Vec<f64>,
    pub body_x: Vec<f64>,
    pub sf_x: Vec<f64>,
    pub pwt_x: Vec<f64>,
}

/// Readings that the logger averages for each sample.
const FINER: usize = 4;
/// Integration steps between two readings if friction sticks: a sticking element follows a fast damper within 0.1 ms.
const STICKING: usize = 4;

/// Drives a corner over a cleat. The record starts `late` s after the right time.
pub fn run(corner: &Corner, drive: &CleatRun, late: f64) -> Track {
    let road = &Road::cleat(f64::from(drive.height) / 1000.0);
    let speed = drive.speed / 3.6;
    let mut rolling = Rolling {
        corner,
        road,
        law: Law::of(corner, road),
        speed,
        late,
        drag: 0.0,
    };
    rolling.drag = rolling.push(0.5 / speed, &[0.0; STATES]).x;
    let h = 1.0 / (RATE * FINER as f64);
    let derivative = |t: f64, y: &State| corner.derivative(0.0, y, rolling.push(t, y), false);
    let mut y = [0.0; STATES];
    let laws = corner.laws;
    let is_dry = laws.friction.is_some() || laws.bouc_wen.is_some() || laws.other.is_some_and(|law| law.is_dry());
    let steps = if is_dry { STICKING } else { 1 };
    let half = laws.pitch.map_or(0.0, |pitch| pitch.half_length);
    let mut track = Track::default();
    let mut mean = Average::default();
    for i in 0..(drive.seconds * RATE) as usize * FINER {
        let t = i as f64 * h;
        mean.take(&derivative(t, &y)[COORDINATES..2 * COORDINATES]);
        if i % FINER == FINER - 1 {
            track.push(&mean.give(), corner.sensor_beside_bend(), half);
        }
        for k in 0..steps {
            let part = h / steps as f64;
            y = step(t + k as f64 * part, &y, part, &derivative);
        }
    }
    track
}

/// The logger's anti-alias filter: the mean over a sample.
#[derive(Default)]
struct Average {
    sum: [f64; COORDINATES],
}

impl Average {
    fn take(&mut self, a: &[f64]) {
        for (sum, a) in self.sum.iter_mut().zip(a) {
            *sum += a / FINER as f64;
        }
    }

    fn give(&mut self) -> [f64; COORDINATES] {
        std::mem::replace(&mut self.sum, [0.0; COORDINATES])
    }
}

impl Track {
    /// The sub-frame's sensors are at its bushings, `half` m before and behind its centre.
    fn push(&mut self, a: &[f64; COORDINATES], beside_bend: f64, half: f64) {
        self.wheel_z.push(a[WHEEL]);
        self.body_z.push(a[BODY] - beside_bend * a[FLEX]);
        self.sf_front_z.push(a[SF] + half * a[PITCH]);
        self.sf_rear_z.push(a[SF] - half * a[PITCH]);
        self.pwt_z.push(a[PWT]);
        self.wheel_x.push(a[X_WHEEL]);
        self.body_x.push(a[X_BODY]);
        self.sf_x.push(a[X_SF]);
        self.pwt_x.push(a[X_PWT]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::axle::{Axle, Layout, Mount};
    use crate::hidden::{Hidden, Laws};

    /// A car whose tyre has a belt is in equilibrium before the cleat: its tread carries the static load from the
    /// start.
    #[test]
    fn a_tyre_with_a_belt_carries_its_load_before_the_cleat() {
        let layout = Layout {
            top_mount: true,
            subframe: false,
            powertrain: Mount::None,
        };
        let axle = Axle::draw(layout, 1);
        let belt = [("m_belt", 7.0), ("k_sidewall", 700e3), ("c_sidewall", 200.0)];
        let laws = Laws::of(&[Hidden::new("tire_belt", "tire", &belt)]);
        let corner = Corner {
            axle: &axle,
            laws: &laws,
        };
        let road = Road::cleat(0.01);
        let rolling = Rolling {
            corner: &corner,
            road: &road,
            law: Law::Area,
            speed: 5.0,
            late: 0.0,
            drag: 0.0,
        };
        let rest = rolling.tread_at_rest();
        assert!((rest + axle.static_load() / 700e3 - axle.static_tire_def).abs() < 1e-12);
        // The sum over columns differs from the closed form of the segment by a few thousandths of the load.
        let above_load = rolling.push(0.1, &[0.0; STATES]).z;
        assert!(above_load.abs() < 0.01 * axle.static_load(), "{above_load} N");
        let mut lower = [0.0; STATES];
        lower[rolling.corner.ring()] = -1e-4;
        let slope = (rolling.push(0.1, &lower).z - above_load) / 1e-4;
        let in_series = 1.0 / (1.0 / slope + 1.0 / 700e3);
        assert!((in_series / axle.k_tire - 1.0).abs() < 0.03, "{in_series} N/m");
    }
}
