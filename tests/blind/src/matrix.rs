//! The cases of the blind matrix: every effect at three strengths, clean axles, effects outside the catalogue, pairs.

use crate::Order;
use crate::hidden::Hidden;

/// What a case is about.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Kind {
    /// One effect of the catalogue.
    Single,
    /// Nothing is hidden.
    Clean,
    /// An effect that the catalogue does not have.
    Outside,
    /// Two effects at once.
    Pair,
}

/// A campaign of the matrix.
#[derive(Clone, Debug)]
pub struct Case {
    /// What it is about.
    pub kind: Kind,
    /// Unique.
    pub name: String,
    /// The campaign.
    pub order: Order,
}

/// An effect with its parameters at three strengths.
struct Entry {
    name: &'static str,
    at: &'static str,
    form: &'static str,
    axle: &'static str,
    parameters: &'static [(&'static str, [f64; 3])],
}

const fn entry(
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

    fn hidden(&self, strength: usize) -> Hidden {
        let parameters: Vec<(&str, f64)> = self
            .parameters
            .iter()
            .map(|(name, values)| (*name, values[strength]))
            .collect();
        Hidden::new(self.name, self.at, &parameters).form(self.form)
    }
}

const SINGLES: [Entry; 32] = [
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
            ("c_resonator", [20.0, 40.0, 60.0]),
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

const OUTSIDE: [Entry; 3] = [
    entry("damper_fade", "damper", "c", &[("share", [0.1, 0.2, 0.4])]),
    entry("cubic_top_mount", "top_mount", "a", &[("k3", [3e11, 1e12, 4e12])]),
    entry("sensor_saturation", "body", "c", &[("soft_limit", [20.0, 10.0, 5.0])]),
];

/// Places of two entries of [`SINGLES`] that are hidden together.
const PAIRS: [(usize, usize); 8] = [(3, 1), (5, 7), (3, 19), (1, 20), (0, 5), (16, 3), (11, 5), (21, 6)];

/// Levels of the noise of the rig's accelerometers, m/s², taken in turn.
const NOISE: [f64; 3] = [0.02, 0.01, 0.04];

/// Cases of one seed.
pub fn cases(seed: u64) -> Vec<Case> {
    let order = |k: usize, axle: &str, effects: Vec<Hidden>| Order {
        noise: NOISE[k % NOISE.len()],
        systematic: if k.is_multiple_of(2) { 0.005 } else { 0.01 },
        effects,
        ..Order::clean(axle, seed * 1000 + k as u64)
    };
    let mut cases = Vec::new();
    let mut of_entries = |kind, entries: &[Entry]| {
        for (k, entry) in entries.iter().enumerate() {
            for strength in 0..3 {
                let form = if entry.form.is_empty() {
                    String::new()
                } else {
                    format!("/{}", entry.form)
                };
                cases.push(Case {
                    kind,
                    name: format!("{}@{}{form} {strength} seed {seed}", entry.name, entry.at),
                    order: order(3 * k + strength + k % 2, entry.axle, vec![entry.hidden(strength)]),
                });
            }
        }
    };
    of_entries(Kind::Single, &SINGLES);
    of_entries(Kind::Outside, &OUTSIDE);
    for (k, axle) in ["a", "c", "d", "a", "c", "d", "c", "a", "d", "c"]
        .into_iter()
        .enumerate()
    {
        cases.push(Case {
            kind: Kind::Clean,
            name: format!("clean {axle}{k} seed {seed}"),
            order: order(200 + k, axle, Vec::new()),
        });
    }
    for (k, (one, other)) in PAIRS.into_iter().enumerate() {
        let (one, other) = (&SINGLES[one], &SINGLES[other]);
        let axle = if one.name == "suspended_mass" || other.at == "powertrain_mount" || one.at == "powertrain_mount" {
            "a"
        } else {
            "c"
        };
        cases.push(Case {
            kind: Kind::Pair,
            name: format!("{}@{} and {}@{} seed {seed}", one.name, one.at, other.name, other.at),
            order: order(300 + k, axle, vec![one.hidden(1), other.hidden(1)]),
        });
    }
    cases
}
