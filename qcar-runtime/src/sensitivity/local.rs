//! Elasticities: by how many percent a metric grows where a parameter grows by one.

use crate::metric::{Ground, MetricError};
use crate::response::parameters::Values;

/// The readings of a ground, and how they follow parameters.
#[derive(Clone, Debug, PartialEq)]
pub struct Elasticities {
    /// Of each reading.
    pub values: Vec<f64>,
    /// For each reading, for each parameter `dy/dp · p/y`; not a number where the reading is zero.
    pub elasticities: Vec<Vec<f64>>,
    /// For each reading, for each parameter `dy/dp`.
    pub slopes: Vec<Vec<f64>>,
}

/// The direction along which a parameter and all that are tied to it grow by their own value; by one where that is zero.
pub fn direction(values: &Values, parameter: usize) -> Vec<f64> {
    let size = size(values, parameter);
    let all = 0..values.as_slice().len();
    all.map(|k| if values.leader(k) == parameter { size } else { 0.0 })
        .collect()
}

/// What a parameter's changes are counted in: its own value, or one where that is zero.
pub fn size(values: &Values, parameter: usize) -> f64 {
    match values.as_slice()[parameter] {
        0.0 => 1.0,
        value => value,
    }
}

/// Elasticities of the readings of a ground by parameters that lead their ties, by their places.
///
/// # Errors
/// What cannot be measured.
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
