//! Elasticities: the percentage by which a metric grows if a parameter grows by one percent.

use crate::metric::{Ground, MetricError};
use crate::response::parameters::Values;

/// The readings of a ground with their elasticities.
#[derive(Clone, Debug, PartialEq)]
pub struct Elasticities {
    /// The value of each reading.
    pub values: Vec<f64>,
    /// For each reading and each parameter `dy/dp · p/y`; NaN if the reading is zero.
    pub elasticities: Vec<Vec<f64>>,
    /// For each reading and each parameter `dy/dp`, SI.
    pub slopes: Vec<Vec<f64>>,
}

/// The direction along which a parameter and those tied to it grow by their own value, or by one if that is zero.
pub fn direction(values: &Values, parameter: usize) -> Vec<f64> {
    let size = size(values, parameter);
    let all = 0..values.as_slice().len();
    all.map(|k| if values.leader(k) == parameter { size } else { 0.0 })
        .collect()
}

/// The unit of changes of a parameter: its own value, or one if that is zero.
pub fn size(values: &Values, parameter: usize) -> f64 {
    match values.as_slice()[parameter] {
        0.0 => 1.0,
        value => value,
    }
}

/// Elasticities of the readings of a ground by leading parameters, given by their positions.
///
/// # Errors
/// Fails if a metric has no value.
pub fn elasticities(ground: &Ground<'_>, values: &Values, parameters: &[usize]) -> Result<Elasticities, MetricError> {
    let directions: Vec<Vec<f64>> = parameters
        .iter()
        .map(|&parameter| direction(values, parameter))
        .collect();
    let found = ground.measure_with(values, &directions)?;
    let own = |parameter: usize| values.as_slice()[parameter];
    let elastic = |(value, slopes): (&f64, &Vec<f64>)| {
        let pairs = slopes.iter().zip(parameters);
        pairs
            .map(|(slope, &k)| if own(k) == 0.0 { 0.0 } else { slope / value })
            .collect()
    };
    let plain = |slopes: &Vec<f64>| {
        slopes
            .iter()
            .zip(parameters)
            .map(|(slope, &k)| slope / size(values, k))
            .collect()
    };
    Ok(Elasticities {
        elasticities: found.values.iter().zip(&found.slopes).map(elastic).collect(),
        slopes: found.slopes.iter().map(plain).collect(),
        values: found.values,
    })
}
