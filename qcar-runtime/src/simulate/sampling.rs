//! Signals as a recorder would take them: on a fine grid, through an anti-alias filter, at the sample rate.

use crate::solver::Step;

/// The anti-alias filter: linear phase, without delay, flat within 0.02 % up to 0.4 of the sample rate.
///
/// A signal is computed on a grid [`AntiAlias::OVERSAMPLING`] times finer than the sample rate and low-passed by a sinc
/// under a Kaiser window (J. F. Kaiser, "Nonrecursive digital filter design using the I0-sinh window function", 1974)
/// of 80 dB. What lies above 0.6 of the sample rate is stopped, so that aliases stay above 0.4 of it. Measuring
/// systems do the same in their converters; a model must be sampled alike where its peaks are compared with theirs.
#[derive(Clone, Debug, PartialEq)]
pub struct AntiAlias {
    taps: Vec<f64>,
}

impl Default for AntiAlias {
    fn default() -> Self {
        Self::new()
    }
}

impl AntiAlias {
    /// Points of the fine grid for each sample.
    pub const OVERSAMPLING: usize = 4;
    /// Points of the fine grid that the filter needs before and after a sample.
    pub const REACH: usize = 52;

    const ATTENUATION: f64 = 80.0;

    /// The filter; it is the same for every sample rate.
    pub fn new() -> Self {
        let beta = 0.1102 * (Self::ATTENUATION - 8.7);
        let reach = Self::REACH as f64;
        let tap = |i: i32| {
            let x = f64::from(i);
            // The edge of the ideal low-pass lies at half the sample rate.
            sinc(x / Self::OVERSAMPLING as f64) * bessel_i0(beta * (1.0 - (x / reach).powi(2)).max(0.0).sqrt())
        };
        let taps: Vec<f64> = (-(Self::REACH as i32)..=Self::REACH as i32).map(tap).collect();
        let sum: f64 = taps.iter().sum();
        Self {
            taps: taps.iter().map(|tap| tap / sum).collect(),
        }
    }

    /// Samples of a fine signal that begins [`AntiAlias::REACH`] points before the first sample and ends as many after
    /// the last.
    pub fn decimate(&self, fine: &[f64]) -> Vec<f64> {
        fine.windows(self.taps.len())
            .step_by(Self::OVERSAMPLING)
            .map(|window| dot(&self.taps, window))
            .collect()
    }
}

/// The fine grid of a recording, gone through step by step.
pub(super) struct Grid {
    spacing: f64,
    samples: usize,
    next: usize,
}

impl Grid {
    /// The grid for `samples` samples (at least one) at `rate` (Hz), the first at time 0.
    pub fn new(rate: f64, samples: usize) -> Self {
        Self {
            spacing: 1.0 / (rate * AntiAlias::OVERSAMPLING as f64),
            samples,
            next: 0,
        }
    }

    /// Number of samples.
    pub fn samples(&self) -> usize {
        self.samples
    }

    /// Number of points.
    pub fn points(&self) -> usize {
        (self.samples - 1) * AntiAlias::OVERSAMPLING + 1 + 2 * AntiAlias::REACH
    }

    /// Time of the first point, s.
    pub fn start(&self) -> f64 {
        self.time(0)
    }

    /// Time of the last point, s.
    pub fn end(&self) -> f64 {
        self.time(self.points() - 1)
    }

    /// Times of the points that `step` reaches, each given once, and whether each is a sample.
    pub fn on(&mut self, step: &Step<'_>) -> impl Iterator<Item = (f64, bool)> + use<'_> {
        let (end, points) = (step.end, self.points());
        std::iter::from_fn(move || {
            let (point, time) = (self.next, self.time(self.next));
            (point < points && time <= end).then(|| {
                self.next += 1;
                (time, self.is_sample(point))
            })
        })
    }

    fn time(&self, point: usize) -> f64 {
        self.spacing * (point as f64 - AntiAlias::REACH as f64)
    }

    fn is_sample(&self, point: usize) -> bool {
        let last = self.points() - 1;
        let inside = point >= AntiAlias::REACH && point + AntiAlias::REACH <= last;
        inside && (point - AntiAlias::REACH).is_multiple_of(AntiAlias::OVERSAMPLING)
    }
}

/// Four sums side by side, so that the processor can add them at once.
fn dot(a: &[f64], b: &[f64]) -> f64 {
    let (a4, a_rest) = a.as_chunks::<4>();
    let (b4, b_rest) = b.as_chunks::<4>();
    let mut sums = [0.0; 4];
    for (a, b) in a4.iter().zip(b4) {
        for i in 0..4 {
            sums[i] += a[i] * b[i];
        }
    }
    let rest: f64 = a_rest.iter().zip(b_rest).map(|(a, b)| a * b).sum();
    sums.iter().sum::<f64>() + rest
}

fn sinc(x: f64) -> f64 {
    let angle = std::f64::consts::PI * x;
    if angle == 0.0 { 1.0 } else { angle.sin() / angle }
}

/// The modified Bessel function of order zero, by its power series.
fn bessel_i0(x: f64) -> f64 {
    let quarter = 0.25 * x * x;
    let mut term = 1.0;
    let mut sum = 1.0;
    for k in 1..60 {
        term *= quarter / f64::from(k * k);
        sum += term;
    }
    sum
}
