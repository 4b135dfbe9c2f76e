//! The motion of a place relative to the excitation, measured or predicted, and ratios of two places.

use super::observation::{Difference, Observation, Pair};
use crate::model::{Channel, Signal};
use nalgebra::Complex;

/// Ratio of the motion of a place to the excitation, measured or predicted.
#[derive(Clone)]
pub(super) struct Record {
    pub signal: Signal,
    pub value: Vec<Complex<f64>>,
    /// Relative variance of the noise.
    pub variance: Vec<f64>,
    pub differences: Vec<Difference>,
    pub sensors: usize,
}

/// The ratio of two records; `None` stands for the excitation itself.
pub(super) fn between(channel: &Channel, [far, near]: [Option<&Record>; 2], frequency: &[f64]) -> Observation {
    let value = |of: Option<&Record>, line: usize| of.map_or(Complex::from(1.0), |own| own.value[line]);
    let variance = |of: Option<&Record>, line: usize| of.map_or(0.0, |own| own.variance[line]);
    let sensors = |of: Option<&Record>| of.map_or(1, |own| own.sensors);
    let lines = || 0..frequency.len();
    let relative_variance: Vec<f64> = lines().map(|line| variance(far, line) + variance(near, line)).collect();
    Observation {
        channel: channel.clone(),
        fitted: true,
        frequency: frequency.to_vec(),
        value: lines().map(|line| value(far, line) / value(near, line)).collect(),
        coherence: relative_variance
            .iter()
            .map(|variance| 1.0 / (1.0 + variance))
            .collect(),
        relative_variance,
        band: (frequency[0], frequency[frequency.len() - 1]),
        sensors: (sensors(far), sensors(near)),
        differences: [Pair::LeftRight, Pair::FrontRear]
            .into_iter()
            .filter_map(|pair| apart(pair, far, near))
            .collect(),
    }
}

/// Half the difference of a ratio between two symmetric sensors.
fn apart(pair: Pair, far: Option<&Record>, near: Option<&Record>) -> Option<Difference> {
    let half = |of: Option<&Record>| {
        let own = of?.differences.iter().find(|own| own.pair == pair);
        own.map(|own| own.half.clone())
    };
    let half = match (half(far), half(near)) {
        (Some(far), Some(near)) => far.iter().zip(near).map(|(far, near)| far - near).collect(),
        (Some(far), None) => far,
        (None, Some(near)) => near.iter().map(|near| -near).collect(),
        (None, None) => return None,
    };
    Some(Difference { pair, half })
}
