//! The residual of each sensor as a share of its signal.

use super::misfit::Misfit;
use crate::campaign::Role;
use crate::discover::numbers::{LARGE, Numbers};
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
}

impl SensorShare<'_> {
    /// RMS of the residual over RMS of the signal, 1.
    pub fn missed(&self) -> f64 {
        let [residual, _, signal] = self.squares;
        (residual / signal).sqrt()
    }

    /// RMS of the residual over that of noise alone, 1.
    pub fn deviations(&self) -> f64 {
        let [residual, noise, _] = self.squares;
        (residual / noise).sqrt()
    }

    /// True if neither the signal nor the residual is more than noise, so that their ratio means nothing.
    pub fn is_noise(&self) -> bool {
        let [_, noise, signal] = self.squares;
        (signal / noise).sqrt() <= LARGE && self.deviations() <= LARGE
    }

    /// True if the model misses more of the signal than any model is expected to, and noise does not explain it, or if
    /// it cannot predict the runs.
    pub fn is_large(&self, numbers: &Numbers) -> bool {
        let is_small = self.missed() <= numbers.expected_discrepancy || self.deviations() <= LARGE;
        !is_small
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
            match shares.iter_mut().find(|own| (own.sensor, own.kind) == (sensor, kind)) {
                Some(own) => own.squares.iter_mut().zip(squares).for_each(|(sum, more)| *sum += more),
                None => shares.push(SensorShare { sensor, kind, squares }),
            }
        }
        shares
    }

    /// The shares on the judging runs, followed by those of kinds of runs that are fitted and not among the judging runs,
    /// such as K&C curves.
    pub fn judged_sensor_shares<'a>(&self, evidence: &'a Evidence) -> Vec<SensorShare<'a>> {
        let mut shares = self.sensor_shares(evidence, evidence.judging());
        for own in self.sensor_shares(evidence, Role::Fit) {
            if !shares
                .iter()
                .any(|other| (other.sensor, other.kind) == (own.sensor, own.kind))
            {
                shares.push(own);
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::campaign::{Axis, Quantity};

    #[test]
    fn a_sensor_that_shows_neither_a_signal_nor_a_residual_is_noise() {
        let sensor = Point::new("spring", Axis::Z, Quantity::Force);
        let is_noise = |residual: f64, signal: f64| {
            let squares = [residual * residual, 1.0, signal * signal];
            let kind = Kind::Width;
            SensorShare {
                sensor: &sensor,
                kind,
                squares,
            }
            .is_noise()
        };
        assert!(is_noise(0.98, 1.0));
        assert!(!is_noise(0.98, 30.0), "a signal that the model explains");
        assert!(!is_noise(3.0, 1.0), "a motion of the model that nobody measured");
    }
}
