//! Sensors that agree with the model once their sign is changed.

use super::misfit::Misfit;
use crate::campaign::Role;
use crate::discover::numbers::LARGE;
use crate::discover::observe::{Evidence, Kind, Series};
use crate::transmissibility::Point;

/// A sensor whose sign is probably wrong.
#[derive(Clone, Debug, PartialEq)]
pub struct ReversedSensor<'a> {
    /// The sensor.
    pub sensor: &'a Point,
    /// RMS of its residuals on the fitted runs, in standard deviations.
    pub as_measured: f64,
    /// The same with the opposite sign of the measured values.
    pub reversed: f64,
}

/// Sums over the fitted runs of a sensor.
#[derive(Default)]
struct Sums {
    as_measured: f64,
    reversed: f64,
    count: usize,
}

impl Misfit {
    /// The sensors that noise nearly explains with the opposite sign, and not with the sign that they have: the fit of
    /// the parameters has not followed them.
    pub fn reversed_sensors<'a>(&self, evidence: &'a Evidence) -> Vec<ReversedSensor<'a>> {
        let mut all: Vec<(&Point, Sums)> = Vec::new();
        for (place, series) in evidence.of_role(Role::Fit) {
            let residuals = &self.residuals[place];
            let found = all.iter().position(|(sensor, _)| **sensor == series.sensor);
            let own = found.unwrap_or_else(|| {
                all.push((&series.sensor, Sums::default()));
                all.len() - 1
            });
            let sums = &mut all[own].1;
            sums.as_measured += sum_of_squares(residuals.iter().copied());
            sums.reversed += sum_of_squares(reversed(series, residuals));
            sums.count += residuals.len();
        }
        let summed = all.into_iter().map(|(sensor, sums)| {
            let rms = |sum: f64| (sum / sums.count as f64).sqrt();
            ReversedSensor {
                sensor,
                as_measured: rms(sums.as_measured),
                reversed: rms(sums.reversed),
            }
        });
        summed
            .filter(|own| own.as_measured > LARGE && own.reversed <= LARGE)
            .collect()
    }
}

fn sum_of_squares(values: impl Iterator<Item = f64>) -> f64 {
    values.map(|value| value * value).sum()
}

/// Residuals with the opposite sign of the measured values. The mean of a record is an offset, which has no sign to
/// change.
fn reversed<'a>(series: &'a Series, residuals: &'a [f64]) -> impl Iterator<Item = f64> + 'a {
    let parts = series.kind.parts();
    let mean = match series.kind {
        Kind::Time => series.value.iter().map(|value| value.re).sum::<f64>() / series.value.len() as f64,
        _ => 0.0,
    };
    let measured = series.value.iter().zip(&series.sigma).flat_map(move |(value, sigma)| {
        let scale = (parts as f64).sqrt() / sigma;
        [(value.re - mean) * scale, value.im * scale].into_iter().take(parts)
    });
    residuals
        .iter()
        .zip(measured)
        .map(|(residual, measured)| residual - 2.0 * measured)
}
