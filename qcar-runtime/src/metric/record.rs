//! The value of a metric for a record, and its derivative by the record.

use super::name::Measure;
use crate::compare::Windows;

/// Where the impact of a run begins and ends, in samples.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Impact {
    /// The first sample at which the wheel feels the obstacle.
    pub onset: usize,
    /// The first sample of the after-shake.
    pub end: usize,
    /// The sample after the after-shake.
    pub last: usize,
}

/// The onset is where the wheel's acceleration first exceeds this share of its upward peak, as in
/// [`Alignment`](crate::compare::Alignment).
const ONSET_SHARE: f64 = 0.1;

impl Impact {
    /// The impact in the vertical acceleration of the wheel at `rate` (Hz); `None` if the acceleration is never
    /// positive, or if the record ends with the impact.
    pub fn of(wheel: &[f64], rate: f64) -> Option<Self> {
        let windows = Windows::default();
        let height = wheel.iter().copied().fold(0.0, f64::max);
        let onset = wheel
            .iter()
            .position(|a| height > 0.0 && a.abs() > ONSET_SHARE * height)?;
        let end = onset + (windows.impact * rate).round() as usize;
        let last = (end + (windows.after_shake * rate).round() as usize).min(wheel.len());
        (end < last).then_some(Self { onset, end, last })
    }
}

impl Impact {
    /// The whole of a record of `samples` samples without an impact.
    pub fn none(samples: usize) -> Self {
        Self {
            onset: 0,
            end: samples,
            last: samples,
        }
    }
}

/// A record as a metric uses it: filtered and cut.
pub(super) struct FilteredRecord {
    measure: Measure,
    samples: Vec<f64>,
    rate: f64,
}

impl FilteredRecord {
    /// Filters and cuts a record at `rate` (Hz).
    pub fn new(measure: Measure, record: &[f64], rate: f64, impact: &Impact) -> Self {
        Self {
            measure,
            samples: seen(measure, record, rate, impact),
            rate,
        }
    }

    /// The measure.
    pub fn value(&self) -> f64 {
        let samples = &self.samples;
        match self.measure {
            Measure::Peak | Measure::Excursion => samples.iter().fold(0.0, |most, a| a.abs().max(most)),
            Measure::AfterShake | Measure::Variation | Measure::WeightedRms(_) => crate::compare::rms(samples),
            Measure::Dose(_) => crate::compare::vibration_dose(samples, self.rate),
        }
    }

    /// The derivative of the measure, given that of the record.
    pub fn slope(&self, slope: &[f64], impact: &Impact) -> f64 {
        let slope = seen(self.measure, slope, self.rate, impact);
        let pairs = || self.samples.iter().zip(&slope);
        let value = self.value();
        match self.measure {
            _ if value == 0.0 => 0.0,
            Measure::Peak | Measure::Excursion => {
                let largest = pairs().max_by(|a, b| a.0.abs().total_cmp(&b.0.abs()));
                largest.map_or(0.0, |(a, slope)| a.signum() * slope)
            }
            Measure::AfterShake | Measure::Variation | Measure::WeightedRms(_) => {
                pairs().map(|(a, slope)| a * slope).sum::<f64>() / (slope.len() as f64 * value)
            }
            Measure::Dose(_) => pairs().map(|(a, slope)| a.powi(3) * slope).sum::<f64>() / (self.rate * value.powi(3)),
        }
    }
}

/// Filters and cuts a record. Both are linear, so the derivative of a record is treated in the same way.
fn seen(measure: Measure, record: &[f64], rate: f64, impact: &Impact) -> Vec<f64> {
    match measure {
        Measure::Peak => record[impact.onset..impact.end].to_vec(),
        Measure::AfterShake => record[impact.end..impact.last].to_vec(),
        Measure::WeightedRms(weighting) | Measure::Dose(weighting) => weighting.apply(record, rate),
        Measure::Variation => less_first(record)[impact.onset..].to_vec(),
        Measure::Excursion => less_first(record),
    }
}

fn less_first(record: &[f64]) -> Vec<f64> {
    record.iter().map(|value| value - record[0]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::compare::Weighting;

    /// The derivative of each measure is the limit of its differences.
    #[test]
    fn slopes_are_limits_of_differences() {
        let record = |part: f64| -> Vec<f64> {
            let at = |i: usize| (0.05 * i as f64).sin() * (-0.002 * i as f64).exp() + part * (0.031 * i as f64).cos();
            (0..1400).map(at).collect()
        };
        let impact = Impact {
            onset: 20,
            end: 120,
            last: 1120,
        };
        let slope: Vec<f64> = record(1.0).iter().zip(record(0.0)).map(|(a, b)| a - b).collect();
        for measure in [
            Measure::Peak,
            Measure::AfterShake,
            Measure::WeightedRms(Weighting::Wk),
            Measure::Dose(Weighting::Wd),
            Measure::Variation,
            Measure::Excursion,
        ] {
            let value = |part| FilteredRecord::new(measure, &record(part), 1000.0, &impact).value();
            let difference = (value(1e-5) - value(-1e-5)) / 2e-5;
            let found = FilteredRecord::new(measure, &record(0.0), 1000.0, &impact).slope(&slope, &impact);
            assert!(
                (found - difference).abs() < 1e-7 * value(0.0).max(1.0),
                "{measure:?}: {found} {difference}"
            );
        }
    }
}
