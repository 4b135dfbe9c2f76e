//! What is told of a channel when its samples are gone.

use qcar_signals::samples::Samples;
use qcar_signals::signal::Signal;

use crate::doubt::{Does, doubt};

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
        let mut sums = Sums::default();
        let valid = signal.samples.iter().filter(|value| value.is_finite());
        valid.for_each(|value| sums.add(value));
        let mean = |sum: f64| (sums.count > 0).then(|| sum / sums.count as f64);
        let average = mean(sums.values);
        let does = average.map(|mean| Does {
            mean,
            min: sums.min,
            max: sums.max,
        });
        Course {
            samples: signal.samples.len(),
            missing: signal.samples.len() - sums.count,
            rate: signal.time.rate(),
            start: signal.time.start(),
            min: average.map(|_| sums.min),
            max: average.map(|_| sums.max),
            mean: average,
            rms: mean(sums.squares).map(f64::sqrt),
            sparkline: sparkline(&signal.samples),
            doubt: doubt(&signal.unit, does),
        }
    }

    /// The largest absolute value.
    pub fn peak(&self) -> Option<f64> {
        Some(self.min?.abs().max(self.max?.abs()))
    }
}

/// What one pass over the samples gives; a long recording has a billion of them.
struct Sums {
    count: usize,
    min: f64,
    max: f64,
    values: f64,
    squares: f64,
}

impl Default for Sums {
    fn default() -> Self {
        Sums {
            count: 0,
            min: f64::INFINITY,
            max: f64::NEG_INFINITY,
            values: 0.0,
            squares: 0.0,
        }
    }
}

impl Sums {
    fn add(&mut self, value: f64) {
        self.count += 1;
        self.min = self.min.min(value);
        self.max = self.max.max(value);
        self.values += value;
        self.squares += value * value;
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
