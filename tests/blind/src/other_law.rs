//! Laws that differ from the catalogue's for the same mechanism, and laws that the catalogue has in no form.
//!
//! A corner hides at most one of them; `inner` are its states.

use std::f64::consts::{FRAC_2_PI, TAU};

/// Largest number of states of a law.
pub const INNER: usize = 3;

/// One of the laws, by its names and parameters in the matrix.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Other {
    /// Friction of elastic bristles with a Stribeck peak (Canudas de Wit, C., Olsson, H., Åström, K. J., Lischinsky,
    /// P.: A new model for control of systems with friction, IEEE Trans. Automatic Control 40, 1995).
    LuGre {
        f_coulomb: f64,
        f_static: f64,
        v_stribeck: f64,
        sigma0: f64,
        sigma1: f64,
    },
    /// Friction as a smooth function of velocity (Andersson, S., Söderberg, A., Björklund, S.: Friction models for
    /// sliding dry, boundary and mixed lubricated contacts, Tribology Int. 40, 2007).
    Arctan { f_coulomb: f64, v_slip: f64 },
    /// Parallel elements that stick and slip (Iwan, W. D.: A distributed-element model for hysteresis, J. Appl. Mech.
    /// 33, 1966).
    SlipStack { f_slip: f64, k_stick: f64 },
    /// A foam stop: its force is a power of its compression, with the rate `k_stop` at 10 mm.
    FoamStop { gap: f64, k_stop: f64, power: f64 },
    /// A spring whose force is a hyperbolic sine of its travel over a length.
    SinhSpring { length: f64 },
    /// A damper whose force is a power of its velocity. At `v_same` it equals that of the linear damper.
    PowerDamper { exponent: f64, v_same: f64 },
    /// A damper with a force table that is interpolated linearly: digressive, and stronger in rebound.
    TableDamper { digression: f64, asymmetry: f64 },
    /// Play in a damper with a smooth onset of the force.
    SoftPlay { gap: f64 },
    /// A tyre that stiffens exponentially with its compression over a length.
    ExponentialTire { length: f64 },
    /// A tyre with two Maxwell branches whose frequencies differ by a factor of five.
    TwoBranchTire { stiffness_ratio: f64, frequency: f64 },
    /// Rubber of nearly fractional order: three Maxwell branches whose frequencies differ by factors of five
    /// (Schiessel, H., Blumen, A.: Hierarchical analogues to fractional relaxation equations, J. Phys. A 26, 1993).
    FractionalMount { k_middle: f64, frequency: f64 },
    /// Rubber of a powertrain mount whose filler sticks and slips: elements as in [`Self::SlipStack`].
    RubberSlip { f_slip: f64, k_stick: f64 },
    /// A bushing along x that stiffens with the square of its travel: at `travel` its force is twice the linear one.
    CubicBushing { travel: f64 },
    /// Drag on the body, proportional to the square of its velocity.
    QuadraticDrag { c2: f64 },
    /// In no form in the catalogue: a damper whose damping grows with the square of its travel and is doubled at
    /// `travel`.
    PositionDamper { travel: f64 },
    /// In no form in the catalogue: a hydraulic rebound stop, whose damping grows beyond a travel in rebound only.
    HydraulicStop { gap: f64, c_per_metre: f64 },
}

/// Velocities at which the slope of a table damper changes, m/s.
const KNEES: [f64; 3] = [0.03, 0.12, 0.4];
/// Compression at which the foam's rate is given, m.
const FOAM: f64 = 0.01;
/// Below this velocity a power of it is smoothed, m/s.
const ROUNDED: f64 = 0.005;

impl Other {
    /// The law with this name and its parameters, if it is one of these.
    pub fn named(name: &str, get: impl Fn(&str) -> f64) -> Option<Self> {
        Some(match name {
            "lugre_friction" => Self::LuGre {
                f_coulomb: get("f_coulomb"),
                f_static: get("f_coulomb") * get("static_ratio"),
                v_stribeck: get("v_stribeck"),
                sigma0: get("sigma0"),
                sigma1: get("sigma1"),
            },
            "arctan_friction" => Self::Arctan {
                f_coulomb: get("f_coulomb"),
                v_slip: get("v_slip"),
            },
            "slip_stack" => Self::SlipStack {
                f_slip: get("f_slip"),
                k_stick: get("k_stick"),
            },
            "rubber_slip" => Self::RubberSlip {
                f_slip: get("f_slip"),
                k_stick: get("k_stick"),
            },
            "foam_stop" => Self::FoamStop {
                gap: get("gap"),
                k_stop: get("k_stop"),
                power: get("power"),
            },
            "sinh_spring" => Self::SinhSpring { length: get("length") },
            "power_damper" => Self::PowerDamper {
                exponent: get("exponent"),
                v_same: get("v_same"),
            },
            "table_damper" => Self::TableDamper {
                digression: get("digression"),
                asymmetry: get("asymmetry"),
            },
            "soft_play" => Self::SoftPlay { gap: get("gap") },
            "exponential_tire" => Self::ExponentialTire { length: get("length") },
            "two_branch_tire" => Self::TwoBranchTire {
                stiffness_ratio: get("stiffness_ratio"),
                frequency: get("frequency"),
            },
            "fractional_mount" => Self::FractionalMount {
                k_middle: get("k_middle"),
                frequency: get("frequency"),
            },
            "cubic_bushing" => Self::CubicBushing { travel: get("travel") },
            "quadratic_drag" => Self::QuadraticDrag { c2: get("c2") },
            "position_damper" => Self::PositionDamper { travel: get("travel") },
            "hydraulic_stop" => Self::HydraulicStop {
                gap: get("gap"),
                c_per_metre: get("c_per_metre"),
            },
            _ => return None,
        })
    }

    /// Whether the law can stick, which needs shorter integration steps.
    pub fn is_dry(&self) -> bool {
        matches!(
            self,
            Self::LuGre { .. } | Self::Arctan { .. } | Self::SlipStack { .. } | Self::RubberSlip { .. }
        )
    }

    /// Friction force parallel to the damper, N, at a velocity, m/s.
    pub fn friction(&self, v: f64, inner: &[f64], rate: &mut [f64]) -> f64 {
        match *self {
            Self::LuGre {
                f_coulomb,
                f_static,
                v_stribeck,
                sigma0,
                sigma1,
            } => {
                let slipping = f_coulomb + (f_static - f_coulomb) * (-(v / v_stribeck).powi(2)).exp();
                rate[0] = v - sigma0 * v.abs() * inner[0] / slipping;
                sigma0 * inner[0] + sigma1 * rate[0]
            }
            Self::Arctan { f_coulomb, v_slip } => f_coulomb * FRAC_2_PI * (v / v_slip).atan(),
            Self::SlipStack { f_slip, k_stick } => slip_stack(f_slip, k_stick, v, inner, rate),
            _ => 0.0,
        }
    }

    /// Force of a spring beyond `k` times its extension, N.
    pub fn spring(&self, k: f64, s: f64) -> f64 {
        match *self {
            Self::FoamStop { gap, k_stop, power } => {
                let pressed = (-s - gap).max(0.0) / FOAM;
                -k_stop * FOAM / power * pressed.powf(power)
            }
            Self::SinhSpring { length } => k * (length * (s / length).sinh() - s),
            _ => 0.0,
        }
    }

    /// Force of the damper, N, which replaces `c v`.
    pub fn damper(&self, c: f64, s: f64, v: f64) -> Option<f64> {
        match *self {
            Self::PowerDamper { exponent, v_same } => Some(c * v * (v.hypot(ROUNDED) / v_same).powf(exponent - 1.0)),
            Self::TableDamper { digression, asymmetry } => {
                let side = if v > 0.0 { asymmetry } else { 1.0 };
                Some(c * 2.0 * side / (1.0 + asymmetry) * table(digression, v.abs()) * v.signum())
            }
            Self::SoftPlay { gap } => Some(c * v * (1.0 - (-(2.0 * s / gap).powi(2)).exp())),
            Self::PositionDamper { travel } => Some(c * v * (1.0 + (s / travel).powi(2))),
            Self::HydraulicStop { gap, c_per_metre } => {
                let beyond = if v > 0.0 { (s - gap).max(0.0) } else { 0.0 };
                Some((c + c_per_metre * beyond) * v)
            }
            _ => None,
        }
    }

    /// Force of a tyre beyond `k` times its compression from rest, N.
    pub fn tire(&self, k: f64, compression: f64) -> f64 {
        match *self {
            Self::ExponentialTire { length } => k * (length * ((compression / length).exp() - 1.0) - compression),
            _ => 0.0,
        }
    }

    /// Force of the relaxing branches in the tyre, N.
    pub fn tire_memory(&self, inner: &[f64]) -> f64 {
        match self {
            Self::TwoBranchTire { .. } => inner[0] + inner[1],
            _ => 0.0,
        }
    }

    /// Derivative of the states in a tyre of rate `k`.
    pub fn tire_relaxes(&self, k: f64, compression_rate: f64, inner: &[f64], rate: &mut [f64]) {
        if let Self::TwoBranchTire {
            stiffness_ratio,
            frequency,
        } = *self
        {
            let added = 0.5 * (stiffness_ratio - 1.0) * k;
            maxwell(
                &[(added, frequency), (added, 5.0 * frequency)],
                compression_rate,
                inner,
                rate,
            );
        }
    }

    /// Force of the relaxing branches in the top mount, N.
    pub fn top_mount(&self, v: f64, inner: &[f64], rate: &mut [f64]) -> f64 {
        match *self {
            Self::FractionalMount { k_middle, frequency } => {
                let branch = |power: f64| (k_middle * 1.6_f64.powf(power), frequency * 5_f64.powf(power));
                maxwell(&[-1.0, 0.0, 1.0].map(branch), v, inner, rate)
            }
            _ => 0.0,
        }
    }

    /// Friction in the powertrain mount, N.
    pub fn powertrain_mount(&self, v: f64, inner: &[f64], rate: &mut [f64]) -> f64 {
        match *self {
            Self::RubberSlip { f_slip, k_stick } => slip_stack(f_slip, k_stick, v, inner, rate),
            _ => 0.0,
        }
    }

    /// Force of a bushing along x beyond `k` times its travel, N.
    pub fn bushing(&self, k: f64, s: f64) -> f64 {
        match *self {
            Self::CubicBushing { travel } => k * s * (s / travel).powi(2),
            _ => 0.0,
        }
    }

    /// Drag on the body, N.
    pub fn drag(&self, v: f64) -> f64 {
        match *self {
            Self::QuadraticDrag { c2 } => c2 * v * v.abs(),
            _ => 0.0,
        }
    }
}

/// Integral of the slopes of a table damper from rest to a velocity, m/s; slopes are shares of its damping.
fn table(digression: f64, v: f64) -> f64 {
    let starts = [0.0, KNEES[0], KNEES[1], KNEES[2]];
    let ends = [KNEES[0], KNEES[1], KNEES[2], f64::INFINITY];
    let segment = |(k, (start, end)): (u8, (f64, f64))| {
        let slope = 1.0 + digression * (0.8 - 0.6 * f64::from(k));
        slope * (v.min(end) - start).max(0.0)
    };
    (0..).zip(starts.into_iter().zip(ends)).map(segment).sum()
}

/// Total force, N, of three springs in series with sliders, with unequal shares of the slip force `f_slip`, N, and of the
/// stiffness `k_stick`, N/m. `inner` are their forces; their derivatives go to `rate`.
fn slip_stack(f_slip: f64, k_stick: f64, v: f64, inner: &[f64], rate: &mut [f64]) -> f64 {
    for (k, (force, stiffness)) in [(0.2, 0.5), (0.3, 0.3), (0.5, 0.2)].into_iter().enumerate() {
        let part = inner[k] / (force * f_slip);
        let slips = if part * v > 0.0 { part.powi(6) } else { 0.0 };
        rate[k] = stiffness * k_stick * v * (1.0 - slips);
    }
    inner.iter().sum()
}

/// Total force, N, of parallel Maxwell branches, each with a stiffness, N/m, and a frequency, Hz. `inner` are the
/// forces of the branches; their derivatives go to `rate`.
fn maxwell(branches: &[(f64, f64)], v: f64, inner: &[f64], rate: &mut [f64]) -> f64 {
    for (i, (k, frequency)) in branches.iter().enumerate() {
        rate[i] = k * v - TAU * frequency * inner[i];
    }
    inner[..branches.len()].iter().sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Force of a friction element after it has slid at a constant velocity for a long time.
    fn sliding(law: Other, v: f64) -> f64 {
        let mut inner = [0.0; INNER];
        let (step, mut force) = (2e-6, 0.0);
        for _ in 0..(0.4 / step) as usize {
            let mut rate = [0.0; INNER];
            force = law.friction(v, &inner, &mut rate);
            for (inner, rate) in inner.iter_mut().zip(rate) {
                *inner += step * rate;
            }
        }
        force
    }

    #[test]
    fn friction_slides_at_its_level() {
        let lugre = Other::LuGre {
            f_coulomb: 60.0,
            f_static: 90.0,
            v_stribeck: 0.005,
            sigma0: 600e3,
            sigma1: 300.0,
        };
        let stack = Other::SlipStack {
            f_slip: 80.0,
            k_stick: 200e3,
        };
        for v in [0.02_f64, 0.2] {
            let stribeck = 60.0 + 30.0 * (-(v / 0.005).powi(2)).exp();
            assert!((sliding(lugre, v) - stribeck).abs() < 0.1, "{}", sliding(lugre, v));
            assert!((sliding(stack, -v) + 80.0).abs() < 0.1, "{}", sliding(stack, -v));
        }
        assert!((sliding(lugre, 0.005) - 60.0 - 30.0 / std::f64::consts::E).abs() < 0.1);
    }

    /// The force is continuous where the slope changes.
    #[test]
    fn a_table_has_its_slopes() {
        let slope = |v: f64| (table(0.5, v + 1e-6) - table(0.5, v - 1e-6)) / 2e-6;
        for (v, expected) in [(0.01, 1.4), (0.1, 1.1), (0.2, 0.8), (0.9, 0.5)] {
            assert!((slope(v) - expected).abs() < 1e-6, "{} at {v} m/s", slope(v));
        }
        let law = Other::TableDamper {
            digression: 0.5,
            asymmetry: 1.5,
        };
        let force = |v: f64| law.damper(1000.0, 0.0, v).expect("it is a damper");
        assert!((force(0.02) / -force(-0.02) - 1.5).abs() < 1e-9);
        assert!((force(0.02) - force(-0.02) - 2.0 * 1000.0 * 1.4 * 0.02).abs() < 1e-9);
    }

    /// At rest, the force of a Maxwell branch falls to 1/e in the time constant of its frequency.
    #[test]
    fn branches_relax_by_their_frequencies() {
        let law = Other::FractionalMount {
            k_middle: 100e3,
            frequency: 8.0,
        };
        let inner = [1.0; INNER];
        let mut rate = [0.0; INNER];
        assert_eq!(law.top_mount(0.0, &inner, &mut rate), 3.0);
        let expected = [1.6, 8.0, 40.0].map(|hertz| -TAU * hertz);
        assert!(
            rate.iter()
                .zip(expected)
                .all(|(rate, expected)| (rate - expected).abs() < 1e-9)
        );
    }
}
