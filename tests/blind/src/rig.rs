//! The 4-poster: logarithmic sine sweeps of constant peak velocity.

use std::f64::consts::TAU;

use crate::corner::{BODY, COORDINATES, Corner, FLEX, PITCH, PWT, Push, SF, STATES, State, WHEEL};
use crate::hardware::Pad;
use crate::integrate::step;
use crate::programme::SweepRun;

/// Sampling rate of a record, Hz.
pub const RATE: f64 = 1000.0;
/// Integration steps per sample.
const FINER: usize = 5;
/// Time at rest before the sweep, s.
const RUN_IN: f64 = 0.5;
/// Length of the tapers, s.
const TAPER: f64 = 0.5;

/// A logarithmic sweep.
pub struct Sweep {
    /// m/s
    pub peak_velocity: f64,
    /// Hz
    pub from: f64,
    /// Hz
    pub to: f64,
    /// s
    pub seconds: f64,
    /// The actuator of the pad; `None` if it is ideal.
    pub pad: Option<Pad>,
}

/// Accelerations of the pad and of the masses with sensors, m/s², one value per sample.
#[derive(Default)]
pub struct Motion {
    pub pad: Vec<f64>,
    pub wheel: Vec<f64>,
    pub body: Vec<f64>,
    pub sf_front: Vec<f64>,
    pub sf_rear: Vec<f64>,
    pub pwt: Vec<f64>,
}

impl Sweep {
    /// The pad's motion for a sweep of a programme.
    pub fn new(run: &SweepRun, pad: Option<Pad>) -> Self {
        Self {
            peak_velocity: f64::from(run.level) / 1000.0,
            from: run.from,
            to: run.to,
            seconds: run.seconds,
            pad,
        }
    }

    /// Height of the pad, m. A cosine taper at both ends keeps its acceleration finite.
    fn height(&self, t: f64) -> f64 {
        let t = t - RUN_IN;
        if t <= 0.0 || t > self.seconds {
            return 0.0;
        }
        let growth = (self.to / self.from).ln() / self.seconds;
        let omega = TAU * self.from * (growth * t).exp();
        let edge = (t.min(self.seconds - t) / TAPER).min(1.0);
        let window = 0.5 - 0.5 * (std::f64::consts::PI * edge).cos();
        let phase = (omega - TAU * self.from) / growth;
        let wave = self.pad.map_or_else(|| phase.sin(), |pad| real(pad, omega, phase));
        window * self.peak_velocity / omega * wave
    }

    /// Height, m, velocity, m/s, and acceleration, m/s², of the pad, by differences.
    fn pad(&self, t: f64) -> [f64; 3] {
        let d = 1e-4;
        let (before, now, after) = (self.height(t - d), self.height(t), self.height(t + d));
        [
            now,
            (after - before) / (2.0 * d),
            (after - 2.0 * now + before) / (d * d),
        ]
    }

    /// Length of the record, in samples.
    pub fn samples(&self) -> usize {
        ((self.seconds + 2.0 * RUN_IN) * RATE) as usize + 1
    }
}

/// Response of an actuator to a sine of unit amplitude and slowly growing frequency. Harmonics are shares of the
/// acceleration.
fn real(pad: Pad, omega: f64, phase: f64) -> f64 {
    let (gain, lag) = pad.response(omega);
    let harmonic = |(n, (share, offset)): (i32, (f64, f64))| {
        share / f64::from(n * n) * (f64::from(n) * (phase + lag) + offset).sin()
    };
    let harmonics: f64 = (2..).zip(pad.harmonics).map(harmonic).sum();
    gain * ((phase + lag).sin() + harmonics)
}

/// Simulates a corner on a sweep.
pub fn run(corner: &Corner, sweep: &Sweep) -> Motion {
    let h = 1.0 / (RATE * FINER as f64);
    let total = sweep.samples() as f64 / RATE;
    let derivative = |t: f64, y: &State| {
        let ring = corner.ring();
        let [height, rate, _] = sweep.pad(t);
        let (compression, speed) = (height - y[ring], rate - y[COORDINATES + ring]);
        let z = corner.tire_force(y, compression, speed);
        corner.derivative(
            t / total,
            y,
            Push {
                z,
                x: 0.0,
                compression_rate: speed,
            },
            false,
        )
    };
    let mut y = [0.0; STATES];
    let mut motion = Motion::default();
    let half = corner.laws.pitch.map_or(0.0, |p| p.half_length);
    for i in 0..sweep.samples() {
        let t = i as f64 / RATE;
        let dy = derivative(t, &y);
        let a = |coordinate: usize| dy[COORDINATES + coordinate];
        motion.pad.push(sweep.pad(t)[2]);
        motion.wheel.push(a(WHEEL));
        motion.body.push(a(BODY) - corner.sensor_beside_bend() * a(FLEX));
        motion.sf_front.push(a(SF) + half * a(PITCH));
        motion.sf_rear.push(a(SF) - half * a(PITCH));
        motion.pwt.push(a(PWT));
        for k in 0..FINER {
            y = step(t + k as f64 * h, &y, h, &derivative);
        }
    }
    motion
}
