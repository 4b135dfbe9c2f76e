//! Effects whose laws differ from the catalogue's, and the catalogue's names that belong to the same family.

use super::entries::{Entry, entry};

/// The laws, each with the names that count as right at the same place.
pub const OTHER_LAWS: [(Entry, &str); 16] = [
    (
        entry(
            "lugre_friction",
            "damper",
            "c",
            &[
                ("f_coulomb", [30.0, 60.0, 150.0]),
                ("static_ratio", [1.2, 1.35, 1.6]),
                ("v_stribeck", [0.01, 0.006, 0.004]),
                ("sigma0", [300e3, 600e3, 1.2e6]),
                ("sigma1", [200.0, 300.0, 400.0]),
            ],
        ),
        "coulomb_friction|bouc_wen_hysteresis|elasto_slip_friction",
    ),
    (
        entry(
            "arctan_friction",
            "damper",
            "a",
            &[("f_coulomb", [30.0, 60.0, 150.0]), ("v_slip", [0.002, 0.002, 0.004])],
        ),
        "coulomb_friction|bouc_wen_hysteresis|elasto_slip_friction",
    ),
    (
        entry(
            "slip_stack",
            "damper",
            "c",
            &[("f_slip", [30.0, 80.0, 200.0]), ("k_stick", [100e3, 200e3, 400e3])],
        ),
        "coulomb_friction|bouc_wen_hysteresis|elasto_slip_friction",
    ),
    (
        entry(
            "foam_stop",
            "spring",
            "c",
            &[
                ("gap", [0.02, 0.012, 0.008]),
                ("k_stop", [60e3, 100e3, 150e3]),
                ("power", [1.8, 2.2, 2.6]),
            ],
        ),
        "bump_stop|progressive_spring",
    ),
    (
        entry("sinh_spring", "spring", "c", &[("length", [0.04, 0.025, 0.015])]),
        "progressive_spring",
    ),
    (
        entry(
            "power_damper",
            "damper",
            "c",
            &[("exponent", [0.9, 0.75, 0.6]), ("v_same", [0.15, 0.15, 0.15])],
        ),
        "digressive_damper|segmented_polynomial_damper|compliant_digressive_damper",
    ),
    (
        entry(
            "table_damper",
            "damper",
            "a",
            &[("digression", [0.3, 0.6, 0.9]), ("asymmetry", [1.1, 1.4, 1.8])],
        ),
        "digressive_damper|segmented_polynomial_damper|asymmetric_damper|compliant_digressive_damper",
    ),
    (
        entry("soft_play", "damper", "c", &[("gap", [0.001, 0.002, 0.004])]),
        "free_play",
    ),
    (
        entry("exponential_tire", "tire", "c", &[("length", [0.12, 0.06, 0.03])]),
        "tire_progressive_stiffness",
    ),
    (
        entry(
            "two_branch_tire",
            "tire",
            "a",
            &[("stiffness_ratio", [1.2, 1.4, 1.8]), ("frequency", [4.0, 4.0, 4.0])],
        ),
        "tire_dynamic_stiffness",
    ),
    (
        entry(
            "fractional_mount",
            "top_mount",
            "c",
            &[("k_middle", [60e3, 120e3, 250e3]), ("frequency", [8.0, 8.0, 8.0])],
        ),
        "bushing_relaxation",
    ),
    (
        entry(
            "cubic_bushing",
            "wheel_bushing_x",
            "c",
            &[("travel", [0.006, 0.004, 0.0025])],
        ),
        "bushing_saturation",
    ),
    (
        entry("quadratic_drag", "body", "c", &[("c2", [400.0, 1000.0, 2500.0])]),
        "drag_to_ground",
    ),
    (
        entry(
            "rubber_slip",
            "powertrain_mount",
            "a",
            &[("f_slip", [20.0, 50.0, 120.0]), ("k_stick", [60e3, 150e3, 300e3])],
        ),
        "bushing_friction",
    ),
    (
        entry("cubic_top_mount", "top_mount", "a", &[("k3", [3e11, 1e12, 4e12])]),
        "bushing_saturation",
    ),
    (
        entry(
            "cubic_resonator",
            "wheel",
            "c",
            &[
                ("m_resonator", [3.0, 4.0, 6.0]),
                ("k_resonator", [20e3, 30e3, 50e3]),
                ("zeta_resonator", [0.051, 0.0505, 0.0457]),
                ("k3", [2e9, 1e10, 3e10]),
            ],
        ),
        "secondary_resonator",
    ),
];

/// The one place where the simulator has a law of another form; `None` for all other effects.
pub fn only_place(name: &str) -> Option<&'static str> {
    let own = OTHER_LAWS.iter().find(|(entry, _)| entry.name == name);
    own.map(|(entry, _)| entry.at)
}

/// The names, separated by `|`, that count as right for a law; a law of the catalogue counts as itself.
pub fn family(name: &str) -> &str {
    let own = OTHER_LAWS.iter().find(|(entry, _)| entry.name == name);
    own.map_or(name, |(_, names)| names)
}
