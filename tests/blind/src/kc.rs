//! The K&C rig: wheel against a clamped body, quasi-static or slow.

use crate::corner::Corner;
use crate::random::Random;

/// A vertical cycle of `amplitude` m: rows of displacement (compression positive) and force.
pub fn bounce(corner: &Corner, amplitude: f64, random: &mut Random) -> Vec<[f64; 2]> {
    let mut friction = Friction::default();
    let mut last = amplitude;
    (0..=1200)
        .map(|i| {
            let x = amplitude * (std::f64::consts::TAU * f64::from(i) / 1200.0).cos();
            friction.slide(corner, x - last);
            last = x;
            let force = -corner.spring(-x) + friction.force();
            [x + 2e-5 * random.normal(), force + 0.004 * 3000.0 * random.normal()]
        })
        .collect()
}

/// What resists slow travel, N: Dahl's friction and the loop of a hysteresis.
#[derive(Default)]
struct Friction {
    dry: f64,
    hysteresis: f64,
}

impl Friction {
    /// After a slow step of travel.
    fn slide(&mut self, corner: &Corner, step: f64) {
        if let Some(law) = corner.laws.friction {
            let towards = law.f_coulomb * step.signum();
            self.dry = towards + (self.dry - towards) * (-law.k_presliding * step.abs() / law.f_coulomb).exp();
        }
        if let Some(b) = corner.laws.bouc_wen {
            const FINER: u32 = 50;
            let d = step / f64::from(FINER);
            for _ in 0..FINER {
                let part = self.hysteresis / b.f_hysteresis;
                let lost = b.loop_shape * d.abs() * part * part.abs() + (1.0 - b.loop_shape) * d * part * part;
                self.hysteresis += b.k_hysteresis * (d - lost);
            }
        }
    }

    fn force(&self) -> f64 {
        self.dry + self.hysteresis
    }
}

/// Two sine cycles at a peak velocity: rows of time, displacement, velocity, force.
pub fn dynamic_bounce(corner: &Corner, amplitude: f64, peak_velocity: f64, random: &mut Random) -> Vec<[f64; 4]> {
    let omega = peak_velocity / amplitude;
    let steps = (2.75 * std::f64::consts::TAU / omega / 0.005) as usize;
    let mut friction = Friction::default();
    let mut last = amplitude;
    (0..=steps)
        .map(|i| {
            let t = 0.005 * i as f64;
            let (x, v) = (amplitude * (omega * t).cos(), -amplitude * omega * (omega * t).sin());
            friction.slide(corner, x - last);
            last = x;
            let force = -corner.spring(-x) - corner.damper_law(0.5, -x, -v) + friction.force();
            let noisy = |value: f64, sigma: f64, random: &mut Random| value + sigma * random.normal();
            [
                t,
                noisy(x, 3e-5, random),
                noisy(v, 5e-4, random),
                noisy(force, 8.0, random),
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
