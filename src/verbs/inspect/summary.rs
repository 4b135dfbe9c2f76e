//! Summary of a channel without its samples.

use qcar_signals::signal::Signal;
use qcar_signals::summary::Summary;

use crate::suspect_unit::{Statistics, suspicion};

/// Range, mean and RMS of a channel, in its unit.
pub(in crate::verbs) struct ChannelSummary {
    /// Number of samples, including those without a value.
    pub samples: usize,
    /// Number of samples without a value.
    pub missing: usize,
    /// Sample rate, Hz; `None` if the samples are not evenly spaced.
    pub rate: Option<f64>,
    /// Samples per second on average, Hz; `None` without times.
    pub mean_rate: Option<f64>,
    /// Time of the first sample, s; `None` without times.
    pub start: Option<f64>,
    pub min: Option<f64>,
    pub max: Option<f64>,
    pub mean: Option<f64>,
    pub rms: Option<f64>,
    /// Sparkline of a few characters, from the lowest to the highest value.
    pub sparkline: String,
    /// Why its unit is probably wrong, as a sentence.
    pub unit_warning: Option<String>,
}

impl ChannelSummary {
    /// Summary of a channel with samples.
    pub fn of(signal: &Signal) -> Self {
        let summary = signal.samples.summary();
        let mean = summary.mean();
        let Summary { min, max, .. } = summary;
        ChannelSummary {
            samples: summary.samples,
            missing: summary.samples - summary.valid,
            rate: signal.time.rate(),
            mean_rate: signal.time.mean_rate(),
            start: signal.time.start(),
            min: mean.map(|_| min),
            max: mean.map(|_| max),
            mean,
            rms: summary.rms(),
            sparkline: sparkline(&summary),
            unit_warning: suspicion(&signal.unit, mean.map(|mean| Statistics { mean, min, max })),
        }
    }

    /// The largest absolute value.
    pub fn peak(&self) -> Option<f64> {
        Some(self.min?.abs().max(self.max?.abs()))
    }
}

/// A channel in a few characters: the means of its parts, from the lowest to the highest.
fn sparkline(summary: &Summary) -> String {
    let means: Vec<f64> = summary.part_means().collect();
    let low = means.iter().copied().fold(f64::INFINITY, f64::min);
    let high = means.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let level = |mean: &f64| match mean.is_nan() {
        true => ' ',
        false if high > low => {
            ['▁', '▂', '▃', '▄', '▅', '▆', '▇', '█'][((mean - low) / (high - low) * 7.0).round() as usize % 8]
        }
        false => '▄',
    };
    means.iter().map(level).collect()
}
