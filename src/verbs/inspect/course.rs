//! What is told of a channel when its samples are gone.

use qcar_signals::samples::Samples;
use qcar_signals::signal::Signal;

use super::doubt::{Does, doubt};

/// Columns of a sparkline.
const SPARKS: usize = 16;

/// The range and the course of a channel, in its unit.
pub(in crate::verbs) struct Course {
    /// How many there are, those without a value among them.
    pub samples: usize,
    /// How many have no value.
    pub missing: usize,
    /// Hz, where they come evenly.
    pub rate: Option<f64>,
    /// Time of the first sample, s, where the file says times.
    pub start: Option<f64>,
    pub min: Option<f64>,
    pub max: Option<f64>,
    pub mean: Option<f64>,
    pub rms: Option<f64>,
    /// A few characters, from the lowest to the highest.
    pub sparkline: String,
    /// What is odd about its unit, as a sentence.
    pub doubt: Option<String>,
}

impl Course {
    /// Of a channel whose samples are there.
    pub fn of(signal: &Signal) -> Self {
        let valid = || signal.samples.iter().filter(|value| value.is_finite());
        let count = valid().count();
        let mean = |sum: f64| (count > 0).then(|| sum / count as f64);
        let range = valid().reduce(f64::min).zip(valid().reduce(f64::max));
        let average = mean(valid().sum());
        let does = range.zip(average).map(|((min, max), mean)| Does { mean, min, max });
        Course {
            samples: signal.samples.len(),
            missing: signal.samples.len() - count,
            rate: signal.time.rate(),
            start: signal.time.start(),
            min: range.map(|(min, _)| min),
            max: range.map(|(_, max)| max),
            mean: average,
            rms: mean(valid().map(|value| value * value).sum()).map(f64::sqrt),
            sparkline: sparkline(&signal.samples),
            doubt: doubt(&signal.unit, does),
        }
    }

    /// The largest absolute value.
    pub fn peak(&self) -> Option<f64> {
        Some(self.min?.abs().max(self.max?.abs()))
    }
}

/// The course of a channel in a few characters: the means of as many parts, from the lowest to the highest.
fn sparkline(samples: &Samples) -> String {
    let part = samples.len().div_ceil(SPARKS).max(1);
    let means = (0..samples.len()).step_by(part).map(|from| {
        let valid = samples
            .range(from..samples.len().min(from + part))
            .filter(|value| value.is_finite());
        valid.clone().sum::<f64>() / valid.count() as f64
    });
    let means: Vec<f64> = means.collect();
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
