//! The K&C rig: it moves the wheel against a clamped body.

use std::f64::consts::{PI, TAU};

use crate::corner::{BELT, BODY, COORDINATES, Corner, Push, RESONATOR, STATES, State, WHEEL};
use crate::hidden::Laws;
use crate::integrate::step;
use crate::other_law::Other;
use crate::random::Random;

/// Peak velocity of a quasi-static cycle, m/s.
const SLOW: f64 = 0.008;
/// Time from the design position to the end of the travel, where each cycle begins, s.
const RUN_IN: f64 = 2.0;
/// Largest integration step, s.
const STEP: f64 = 5e-4;
/// A damper that is many times stiffer at the ends of the travel makes a light top mount settle that many times faster,
/// so the steps are shorter by this factor.
const STIFF: f64 = 10.0;

/// A vertical sine of the wheel.
struct Sine {
    /// Amplitude, m.
    amplitude: f64,
    /// Angular frequency, rad/s.
    omega: f64,
}

impl Sine {
    fn new(amplitude: f64, peak_velocity: f64) -> Self {
        Self {
            amplitude,
            omega: peak_velocity / amplitude,
        }
    }

    /// Travel, m, and velocity, m/s. Times before zero lead from the design position to the start of the cycle.
    fn at(&self, t: f64) -> [f64; 2] {
        let a = self.amplitude;
        if t < 0.0 {
            let angle = PI * t / RUN_IN;
            return [a / 2.0 * (1.0 + angle.cos()), -a / 2.0 * PI / RUN_IN * angle.sin()];
        }
        let angle = self.omega * t;
        [a * angle.cos(), -a * self.omega * angle.sin()]
    }

    /// Rows of time, travel, velocity and force, `every` s apart. The rig is so slow that inertia forces are
    /// negligible.
    fn run(&self, corner: &Corner, samples: usize, apart: f64) -> Vec<[f64; 4]> {
        let laws = Laws {
            inertance: None,
            ..corner.laws.clone()
        };
        let (axle, laws) = (corner.axle, &laws);
        let corner = Corner { axle, laws };
        let derivative = |t: f64, y: &State| corner.derivative(0.5, &self.clamped(t, y), Push::default(), false);
        let most = match &laws.other {
            Some(Other::PositionDamper { .. }) => STEP / STIFF,
            _ => STEP,
        };
        let finer = (apart / most).ceil();
        let mut y = [0.0; STATES];
        for i in 0..(RUN_IN / most) as usize {
            y = step(i as f64 * most - RUN_IN, &y, most, &derivative);
        }
        let wheel = laws.carried_by_the_wheel(axle.m_wheel);
        let mut rows = Vec::new();
        for i in 0..samples {
            let t = i as f64 * apart;
            let [travel, velocity] = self.at(t);
            rows.push([t, travel, velocity, -wheel * derivative(t, &y)[COORDINATES + WHEEL]]);
            for k in 0..finer as usize {
                y = step(t + k as f64 * apart / finer, &y, apart / finer, &derivative);
            }
        }
        rows
    }

    /// The state with the body clamped and the wheel at the rig's position. Masses attached to the wheel move with it.
    fn clamped(&self, t: f64, y: &State) -> State {
        let mut y = *y;
        let [travel, velocity] = self.at(t);
        (y[BODY], y[COORDINATES + BODY]) = (0.0, 0.0);
        for part in [WHEEL, BELT, RESONATOR] {
            (y[part], y[COORDINATES + part]) = (travel, velocity);
        }
        y
    }
}

/// A vertical cycle of `amplitude` m: rows of displacement (compression positive) and force.
pub fn bounce(corner: &Corner, amplitude: f64, random: &mut Random) -> Vec<[f64; 2]> {
    let sine = Sine::new(amplitude, SLOW);
    let rows = sine.run(corner, 1201, TAU / sine.omega / 1200.0);
    rows.into_iter()
        .map(|[_, x, _, force]| [x + 2e-5 * random.normal(), force + 0.004 * 3000.0 * random.normal()])
        .collect()
}

/// Two sine cycles and three quarters at a peak velocity: rows of time, displacement, velocity, force.
pub fn dynamic_bounce(corner: &Corner, amplitude: f64, peak_velocity: f64, random: &mut Random) -> Vec<[f64; 4]> {
    let sine = Sine::new(amplitude, peak_velocity);
    let apart = 0.005;
    let samples = (2.75 * TAU / sine.omega / apart) as usize + 1;
    let rows = sine.run(corner, samples, apart);
    rows.into_iter()
        .map(|[t, x, v, force]| {
            [
                t,
                x + 3e-5 * random.normal(),
                v + 5e-4 * random.normal(),
                force + 8.0 * random.normal(),
            ]
        })
        .collect()
}

/// A longitudinal cycle of ±3500 N: rows of displacement and force.
pub fn longitudinal(corner: &Corner, random: &mut Random) -> Vec<[f64; 2]> {
    let a = corner.axle;
    (0..=800)
        .map(|i| {
            let force = 3500.0 * (std::f64::consts::TAU * f64::from(i) / 800.0).sin();
            let mut x = force / a.k_wheel_x;
            for _ in 0..60 {
                let slope = a.k_wheel_x + (corner.saturation(x + 1e-7) - corner.saturation(x - 1e-7)) / 2e-7;
                x -= (a.k_wheel_x * x + corner.saturation(x) - force) / slope;
            }
            if a.layout.subframe {
                x += force / a.k_sf_x;
            }
            [x + 1e-6 * random.normal(), force + 8.0 * random.normal()]
        })
        .collect()
}
