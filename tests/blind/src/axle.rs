//! The axles of the blind tests: their layout and true values, drawn by a seed.

use crate::hardware::Hardware;
use crate::random::Random;

/// The parts that the simulated axle has.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Layout {
    /// The damper's upper end is a mass on a bushing (the top mount).
    pub top_mount: bool,
    /// A sub-frame that carries arms, spring and damper through motion ratios.
    pub subframe: bool,
    /// A powertrain mass.
    pub powertrain: Mount,
}

/// The mass that carries the powertrain.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mount {
    None,
    Body,
    Subframe,
}

/// True parameter values of one corner, SI units. Values of absent parts are unused.
#[derive(Clone, Copy, Debug)]
pub struct Axle {
    pub layout: Layout,
    pub m_corner: f64,
    pub m_half_vehicle: f64,
    pub m_wheel_other_axle: f64,
    pub m_wheel: f64,
    pub m_tm: f64,
    pub m_sf: f64,
    pub m_pwt: f64,
    pub k_wheel_z: f64,
    pub c_wheel_z: f64,
    pub k_tm: f64,
    pub c_tm: f64,
    pub k_sf_z: f64,
    pub c_sf_z: f64,
    pub k_pwt_z: f64,
    pub c_pwt_z: f64,
    pub mr_spring: f64,
    pub mr_damper: f64,
    pub k_wheel_x: f64,
    pub c_wheel_x: f64,
    pub k_sf_x: f64,
    pub c_sf_x: f64,
    pub k_pwt_x: f64,
    pub c_pwt_x: f64,
    pub k_tire: f64,
    pub c_tire: f64,
    pub r_tire: f64,
    pub static_tire_def: f64,
}

/// Gravity, m/s².
pub const GRAVITY: f64 = 9.81;

impl Axle {
    /// Plausible true values, drawn by the seed.
    pub fn draw(layout: Layout, seed: u64) -> Self {
        let mut random = Random::new(seed, "axle");
        let mut around = |value: f64, spread: f64| value * random.uniform(1.0 - spread, 1.0 + spread);
        let on_subframe = layout.powertrain == Mount::Subframe;
        let m_corner = around(if layout.subframe { 560.0 } else { 440.0 }, 0.12);
        let body_frequency = around(8.0, 0.12);
        let m_wheel = around(45.0, 0.12);
        let m_pwt = around(if on_subframe { 42.0 } else { 70.0 }, 0.25);
        let k_wheel_z = m_corner * body_frequency * body_frequency;
        let k_tire = around(240e3, 0.15);
        let resonance = |m: f64, hertz: f64| m * (std::f64::consts::TAU * hertz).powi(2);
        let k_pwt_z = resonance(m_pwt, around(if on_subframe { 14.0 } else { 10.0 }, 0.2));
        Self {
            layout,
            m_corner,
            m_half_vehicle: m_corner * around(2.05, 0.05),
            m_wheel_other_axle: around(41.0, 0.15),
            m_wheel,
            m_tm: around(5.0, 0.25),
            m_sf: around(24.0, 0.2),
            m_pwt,
            k_wheel_z,
            c_wheel_z: 2.0 * around(0.33, 0.2) * (k_wheel_z * m_corner).sqrt() * 0.9,
            k_tm: around(520e3, 0.35),
            c_tm: around(750.0, 0.35),
            k_sf_z: around(560e3, 0.2),
            c_sf_z: around(700.0, 0.25),
            k_pwt_z,
            c_pwt_z: 2.0 * around(0.07, 0.3) * (k_pwt_z * m_pwt).sqrt(),
            mr_spring: around(0.64, 0.06),
            mr_damper: around(0.68, 0.06),
            k_wheel_x: around(500e3, 0.15),
            c_wheel_x: around(800.0, 0.3),
            k_sf_x: around(2.3e6, 0.15),
            c_sf_x: around(1300.0, 0.2),
            k_pwt_x: k_pwt_z * around(1.15, 0.15),
            c_pwt_x: around(500.0, 0.3),
            k_tire,
            c_tire: around(170.0, 0.35),
            r_tire: around(0.335, 0.04),
            static_tire_def: m_corner * GRAVITY / k_tire * around(1.13, 0.04),
        }
    }

    /// The corner on the other side of the car: each rate and mass differs by 1 to 2 %, or by more if the hardware
    /// flaws say so.
    pub fn other_side(&self, seed: u64, hardware: &Hardware) -> Self {
        let mut random = Random::new(seed, "asymmetry");
        let mut uneven = hardware.sides();
        let mut vary = |value: &mut f64| {
            *value *= 1.0
                + match &mut uneven {
                    Some(share) => share(),
                    None => 0.012 * random.uniform(-1.0, 1.0),
                };
        };
        let mut side = *self;
        [
            &mut side.k_wheel_z,
            &mut side.c_wheel_z,
            &mut side.k_tm,
            &mut side.c_tm,
            &mut side.k_tire,
            &mut side.c_tire,
            &mut side.m_wheel,
        ]
        .into_iter()
        .for_each(&mut vary);
        side
    }

    /// Static load of the tyre, N.
    pub fn static_load(&self) -> f64 {
        self.m_corner * GRAVITY
    }
}
