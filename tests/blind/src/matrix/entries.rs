//! The effects that the matrix hides, each with weak, usual and strong parameters.

use crate::hidden::Hidden;
use crate::random::Random;

/// An effect with its parameters at three strengths.
pub struct Entry {
    /// A name from the catalogue, or another.
    pub name: &'static str,
    /// Link, mass or sensor location.
    pub at: &'static str,
    /// Form of the effect; empty for the usual one.
    pub form: &'static str,
    /// The axle that hides it.
    pub axle: &'static str,
    parameters: &'static [(&'static str, [f64; 3])],
}

/// An entry for an effect in its usual form.
pub const fn entry(
    name: &'static str,
    at: &'static str,
    axle: &'static str,
    parameters: &'static [(&'static str, [f64; 3])],
) -> Entry {
    Entry {
        name,
        at,
        form: "",
        axle,
        parameters,
    }
}

impl Entry {
    const fn form(mut self, form: &'static str) -> Self {
        self.form = form;
        self
    }

    /// The effect at one of its three strengths.
    pub fn hidden(&self, strength: usize) -> Hidden {
        let parameters: Vec<(&str, f64)> = self
            .parameters
            .iter()
            .map(|(name, values)| (*name, values[strength]))
            .collect();
        Hidden::new(self.name, self.at, &parameters).form(self.form)
    }

    /// The effect with a random strength between the two `strengths`, where 0 is the weakest and 1 the strongest. Each
    /// parameter lies log-uniformly between its weakest and strongest value, within a quarter of that range of the
    /// strength.
    pub fn drawn(&self, strengths: (f64, f64), random: &mut Random) -> Hidden {
        let strength = random.uniform(strengths.0, strengths.1);
        let parameters: Vec<(&str, f64)> = self
            .parameters
            .iter()
            .map(|&(name, values)| {
                let along = (strength + random.uniform(-0.25, 0.25)).clamp(0.0, 1.0);
                (name, between(name, values, along, random))
            })
            .collect();
        Hidden::new(self.name, self.at, &parameters).form(self.form)
    }

    /// Name and place as text.
    pub fn title(&self) -> String {
        let form = if self.form.is_empty() { "" } else { "/" };
        format!("{}@{}{form}{}", self.name, self.at, self.form)
    }
}

/// A gain deviates from 1, to either side. Each other parameter grows or falls from its weakest value to its strongest.
fn between(name: &str, values: [f64; 3], along: f64, random: &mut Random) -> f64 {
    let power = |from: f64, to: f64| from * (to / from).powf(along);
    if name == "gain" {
        let departure = power((values[0] - 1.0).abs(), (values[2] - 1.0).abs());
        return 1.0 + departure * random.uniform(-1.0, 1.0).signum();
    }
    power(values[0], values[2])
}

/// The effects of the catalogue.
pub const SINGLES: [Entry; 32] = [
    entry(
        "top_mount",
        "damper",
        "c",
        &[
            ("m_tm", [3.0, 5.0, 8.0]),
            ("k_tm", [800e3, 450e3, 250e3]),
            ("c_tm", [900.0, 700.0, 500.0]),
        ],
    ),
    entry(
        "suspended_mass",
        "body",
        "a",
        &[
            ("m_pwt", [25.0, 60.0, 110.0]),
            ("k_pwt_z", [90e3, 240e3, 380e3]),
            ("c_pwt_z", [300.0, 500.0, 700.0]),
            ("k_pwt_x", [100e3, 260e3, 450e3]),
            ("c_pwt_x", [300.0, 500.0, 900.0]),
        ],
    ),
    entry(
        "suspended_mass",
        "subframe",
        "d",
        &[
            ("m_pwt", [20.0, 40.0, 60.0]),
            ("k_pwt_z", [120e3, 300e3, 500e3]),
            ("c_pwt_z", [250.0, 420.0, 600.0]),
            ("k_pwt_x", [120e3, 260e3, 450e3]),
            ("c_pwt_x", [300.0, 400.0, 600.0]),
        ],
    ),
    entry(
        "coulomb_friction",
        "damper",
        "c",
        &[
            ("f_coulomb", [20.0, 60.0, 150.0]),
            ("k_presliding", [300e3, 600e3, 1.2e6]),
        ],
    ),
    entry(
        "coulomb_friction",
        "damper",
        "a",
        &[
            ("f_coulomb", [20.0, 60.0, 150.0]),
            ("k_presliding", [300e3, 600e3, 1.2e6]),
        ],
    )
    .form("strut"),
    entry(
        "asymmetric_damper",
        "damper",
        "c",
        &[("rebound_over_compression", [1.15, 1.5, 2.5])],
    ),
    entry(
        "digressive_damper",
        "damper",
        "a",
        &[("c0", [1800.0, 2200.0, 3000.0]), ("v0", [1.5, 0.6, 0.25])],
    ),
    entry(
        "progressive_spring",
        "spring",
        "c",
        &[("rate_increase_at_40mm", [0.15, 0.5, 1.5])],
    ),
    entry(
        "bump_stop",
        "spring",
        "c",
        &[("gap", [0.03, 0.02, 0.012]), ("k_stop", [40e3, 80e3, 120e3])],
    ),
    entry(
        "bushing_relaxation",
        "top_mount",
        "c",
        &[
            ("k_maxwell", [100e3, 250e3, 600e3]),
            ("relaxation_frequency", [15.0, 10.0, 8.0]),
        ],
    ),
    entry(
        "bushing_relaxation",
        "powertrain_mount",
        "a",
        &[
            ("k_maxwell", [30e3, 90e3, 200e3]),
            ("relaxation_frequency", [8.0, 6.0, 10.0]),
        ],
    ),
    entry(
        "hydraulic_mount",
        "powertrain_mount",
        "a",
        &[
            ("k_volume", [60e3, 150e3, 300e3]),
            ("inertance", [30.0, 45.0, 60.0]),
            ("c_track", [300.0, 500.0, 700.0]),
        ],
    ),
    entry(
        "subframe_pitch",
        "subframe",
        "d",
        &[
            ("inertia", [0.8, 1.5, 2.5]),
            ("half_length", [0.25, 0.3, 0.35]),
            ("front_share", [0.52, 0.6, 0.68]),
            ("arm_offset", [0.03, 0.08, 0.15]),
        ],
    ),
    entry(
        "apparent_mass",
        "body",
        "c",
        &[
            ("dynamic_index", [0.93, 0.8, 0.6]),
            ("k_wheel_z_other", [22e3, 25e3, 28e3]),
            ("c_wheel_z_other", [1300.0, 1500.0, 1700.0]),
        ],
    ),
    entry("sensor_delay", "body", "c", &[("delay", [0.001, 0.003, 0.008])]),
    entry("sensor_delay", "wheel", "a", &[("delay", [0.001, 0.003, 0.008])]),
    entry("sensor_gain", "body", "a", &[("gain", [1.04, 1.08, 0.85])]),
    entry("sensor_gain", "wheel", "c", &[("gain", [1.04, 1.08, 0.85])]),
    entry(
        "tire_progressive_stiffness",
        "tire",
        "c",
        &[("tangent_increase_at_twice_static", [0.15, 0.4, 0.9])],
    ),
    entry(
        "tire_progressive_stiffness",
        "tire",
        "a",
        &[("tangent_increase_at_twice_static", [0.15, 0.4, 0.9])],
    )
    .form("rolling"),
    entry(
        "tire_dynamic_stiffness",
        "tire",
        "c",
        &[
            ("stiffness_ratio", [1.15, 1.4, 2.0]),
            ("relaxation_frequency", [6.0, 8.0, 12.0]),
        ],
    ),
    entry(
        "tire_dynamic_stiffness",
        "tire",
        "a",
        &[
            ("stiffness_ratio", [1.3, 1.7, 2.3]),
            ("relaxation_frequency", [10.0, 14.0, 18.0]),
        ],
    )
    .form("rolling"),
    entry(
        "tire_belt",
        "tire",
        "c",
        &[
            ("m_belt", [5.0, 7.0, 9.0]),
            ("k_sidewall", [1.8e6, 1.1e6, 700e3]),
            ("c_sidewall", [200.0, 250.0, 300.0]),
        ],
    ),
    entry(
        "bushing_saturation",
        "wheel_bushing_x",
        "c",
        &[
            ("linear_travel", [0.003, 0.002, 0.001]),
            ("rate_increase_at_twice_travel", [0.5, 1.0, 2.0]),
        ],
    ),
    entry("free_play", "damper", "c", &[("gap", [0.0005, 0.0015, 0.004])]),
    entry("inerter", "damper", "c", &[("inertance", [4.0, 10.0, 25.0])]),
    entry(
        "secondary_resonator",
        "wheel",
        "c",
        &[
            ("m_resonator", [2.0, 4.0, 7.0]),
            ("k_resonator", [20e3, 50e3, 80e3]),
            ("zeta_resonator", [0.05, 0.045, 0.04]),
        ],
    ),
    entry(
        "series_compliance",
        "damper",
        "a",
        &[("k_series", [900e3, 400e3, 200e3])],
    ),
    entry("drag_to_ground", "body", "c", &[("c_drag", [100.0, 250.0, 600.0])]),
    entry("drag_to_ground", "wheel", "a", &[("c_drag", [100.0, 250.0, 600.0])]),
    entry(
        "segmented_polynomial_damper",
        "damper",
        "c",
        &[
            ("c_rebound", [1500.0, 1700.0, 2000.0]),
            ("q_rebound", [300.0, 700.0, 1500.0]),
            ("c_compression", [1200.0, 1100.0, 900.0]),
            ("q_compression", [400.0, 900.0, 2000.0]),
        ],
    ),
    entry(
        "bouc_wen_hysteresis",
        "damper",
        "c",
        &[
            ("f_hysteresis", [30.0, 80.0, 200.0]),
            ("k_hysteresis", [60e3, 100e3, 200e3]),
            ("loop_shape", [0.6, 0.7, 0.8]),
        ],
    ),
];

/// Effects that are not in the catalogue.
pub const OUTSIDE: [Entry; 2] = [
    entry("damper_fade", "damper", "c", &[("share", [0.1, 0.2, 0.4])]),
    entry("sensor_saturation", "body", "c", &[("soft_limit", [20.0, 10.0, 5.0])]),
];

/// Effects that the catalogue has in no form. The first seeds do not draw them.
pub const OUTSIDE_LATER: [Entry; 2] = [
    entry("position_damper", "damper", "c", &[("travel", [0.04, 0.02, 0.01])]),
    entry(
        "hydraulic_stop",
        "damper",
        "a",
        &[("gap", [0.01, 0.007, 0.005]), ("c_per_metre", [200e3, 400e3, 800e3])],
    ),
];
