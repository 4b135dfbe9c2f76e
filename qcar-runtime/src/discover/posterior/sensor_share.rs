//! The residual of each sensor as a share of its signal.

use super::misfit::Misfit;
use crate::campaign::Role;
use crate::discover::numbers::ONE_SIDED;
use crate::discover::observe::{Evidence, Kind, Series};
use crate::transmissibility::Point;

/// What a fitted model misses of the signal of one sensor, in the runs of one kind and role.
#[derive(Clone, Debug, PartialEq)]
pub struct SensorShare<'a> {
    /// The sensor.
    pub sensor: &'a Point,
    /// Kind of its values.
    pub kind: Kind,
    /// Sums of squares, in the unit of the sensor: of the residuals, of what noise alone leaves of them, and of the signal.
    squares: [f64; 3],
    /// Number of residuals.
    count: usize,
}

impl SensorShare<'_> {
    /// RMS of the residual over RMS of the signal, 1.
    pub fn missed(&self) -> f64 {
        let [residual, _, signal] = self.squares;
        (residual / signal).sqrt()
    }

    /// The part of [`missed`](Self::missed) that is certainly not noise; 0 if noise could be all of it, and NaN if the
    /// model cannot predict the runs. The mean square of `n` normal values has a relative standard deviation of
    /// `sqrt(2/n)`.
    pub fn certainly_missed(&self) -> f64 {
        let [residual, noise, signal] = self.squares;
        let above_noise = residual - noise * (1.0 + ONE_SIDED * (2.0 / self.count as f64).sqrt());
        if above_noise <= 0.0 {
            0.0
        } else {
            (above_noise / signal).sqrt()
        }
    }
}

impl Misfit {
    /// The share of every sensor in every kind of run of a role, in the order of the evidence. Higher harmonics are left
    /// out, because they are small.
    pub fn sensor_shares<'a>(&self, evidence: &'a Evidence, role: Role) -> Vec<SensorShare<'a>> {
        let mut shares: Vec<SensorShare> = Vec::new();
        let compared = evidence
            .of_role(role)
            .filter(|(_, series)| series.kind.order().is_none_or(|order| order == 1));
        for (place, series) in compared {
            let (sensor, kind) = (&series.sensor, series.kind);
            let squares = squares(series, &self.residuals[place]);
            let count = series.residuals();
            match shares.iter_mut().find(|own| (own.sensor, own.kind) == (sensor, kind)) {
                Some(own) => {
                    own.count += count;
                    own.squares.iter_mut().zip(squares).for_each(|(sum, more)| *sum += more);
                }
                None => shares.push(SensorShare {
                    sensor,
                    kind,
                    squares,
                    count,
                }),
            }
        }
        shares
    }
}

/// Sums of squares of one series: of its residuals, of the noise in them, and of its signal. The mean of a record is an
/// offset, not a signal.
fn squares(series: &Series, normalised: &[f64]) -> [f64; 3] {
    let parts = series.kind.parts();
    let variances = series.sigma.iter().map(|sigma| sigma * sigma / parts as f64);
    let residual = normalised.chunks(parts).zip(variances.clone());
    let mean = match series.kind {
        Kind::Time => series.value.iter().map(|value| value.re).sum::<f64>() / series.value.len() as f64,
        _ => 0.0,
    };
    [
        residual
            .map(|(own, variance)| variance * own.iter().map(|part| part * part).sum::<f64>())
            .sum(),
        variances.map(|variance| parts as f64 * variance).sum(),
        series.value.iter().map(|value| (value - mean).norm_sqr()).sum(),
    ]
}
