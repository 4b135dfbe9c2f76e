//! Sweeps as evidence, without a record.

use qcar_runtime::campaign::{Axis, Quantity, Role};
use qcar_runtime::discover::Evidence;
use qcar_runtime::discover::observe::{Run, Series, Stimulus};
use qcar_runtime::transmissibility::Point;

/// The accelerometer of a place along z.
pub fn point(location: &str) -> Point {
    Point::new(location, Axis::Z, Quantity::Acceleration)
}

/// The run of a number, with this peak velocity of the pad (m/s) at each frequency (Hz).
pub fn run(number: usize, level: f64, role: Role, frequency: &[f64]) -> Run {
    Run {
        name: format!("sweep_{number}"),
        role,
        level,
        stimulus: Stimulus::Sweep {
            reference: point("pad"),
            signal: Vec::new(),
            swept: None,
            rate: 1000.0,
            amplitude: frequency.iter().map(|f| level * std::f64::consts::TAU * f).collect(),
            frequency: frequency.to_vec(),
            time: vec![0.0; frequency.len()],
            band: (0.5, 30.0),
        },
    }
}

/// The data set of these runs.
pub fn evidence(runs: Vec<Run>, series: Vec<Series>) -> Evidence {
    Evidence {
        runs,
        series,
        two_sided: false,
        notices: Vec::new(),
        numbers: Default::default(),
        held_out_judge: true,
    }
}
