//! Spectra of uniformly sampled signals: of a whole record, and averaged over its segments (Welch).

use std::f64::consts::TAU;
use std::sync::{LazyLock, Mutex, MutexGuard, PoisonError};

use nalgebra::{Complex, DMatrix};
use rayon::prelude::*;
use realfft::RealFftPlanner;
use rustfft::FftPlanner;

/// Weights of the samples of a segment.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Window {
    /// All one: for whole periods of a periodic signal.
    Rectangular,
    /// Hann window, which keeps strong lines from leaking into weak ones.
    Hann,
}

impl Window {
    /// The weights of `n` samples.
    pub fn weights(self, n: usize) -> Vec<f64> {
        let hann = |k: usize| 0.5 - 0.5 * (TAU * k as f64 / n as f64).cos();
        match self {
            Window::Rectangular => vec![1.0; n],
            Window::Hann => (0..n).map(hann).collect(),
        }
    }
}

/// Trend that is subtracted from each segment before it is weighted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Trend {
    /// Nothing.
    Kept,
    /// The mean: a sensor's offset.
    Constant,
    /// The straight line of least squares: a sensor's drift.
    Linear,
}

impl Trend {
    /// Subtracts the trend from `samples`.
    pub fn remove(self, samples: &mut [f64]) {
        let n = samples.len() as f64;
        let mean = samples.iter().sum::<f64>() / n;
        let middle = (n - 1.0) / 2.0;
        let slope = match self {
            Trend::Linear if samples.len() > 1 => {
                let moment: f64 = samples.iter().enumerate().map(|(k, y)| (k as f64 - middle) * y).sum();
                moment / (n * (n * n - 1.0) / 12.0)
            }
            _ => 0.0,
        };
        if self != Trend::Kept {
            samples
                .iter_mut()
                .enumerate()
                .for_each(|(k, y)| *y -= mean + slope * (k as f64 - middle));
        }
    }
}

/// Plans of all lengths so far, since making a plan takes as long as several transforms.
fn plans() -> MutexGuard<'static, RealFftPlanner<f64>> {
    static PLANS: LazyLock<Mutex<RealFftPlanner<f64>>> = LazyLock::new(|| Mutex::new(RealFftPlanner::new()));
    PLANS.lock().unwrap_or_else(PoisonError::into_inner)
}

/// The same for complex records.
fn complex_plans() -> MutexGuard<'static, FftPlanner<f64>> {
    static PLANS: LazyLock<Mutex<FftPlanner<f64>>> = LazyLock::new(|| Mutex::new(FftPlanner::new()));
    PLANS.lock().unwrap_or_else(PoisonError::into_inner)
}

/// The discrete Fourier transform of a whole record: lines 0 to n/2, `rate / n` apart, each `Σ x_k exp(-iωt_k)`.
pub fn transform(samples: &[f64]) -> Vec<Complex<f64>> {
    let plan = plans().plan_fft_forward(samples.len());
    let (mut input, mut lines) = (samples.to_vec(), plan.make_output_vec());
    plan.process(&mut input, &mut lines)
        .expect("the plan was made for these lengths");
    lines
}

/// [`transform`] of several records of one length.
///
/// A record of even length is transformed as a complex one of half its length. An odd length has no half, so two records
/// are transformed together.
pub fn transforms(records: &[Vec<f64>]) -> Vec<Vec<Complex<f64>>> {
    let odd = records.first().is_some_and(|record| !record.len().is_multiple_of(2));
    if !odd {
        return records.par_iter().map(|record| transform(record)).collect();
    }
    let of_two = |room: &mut [Vec<Complex<f64>>; 2], two: &[Vec<f64>]| match two {
        [first, second] => together([first, second], room).into(),
        _ => two.iter().map(|record| transform(record)).collect(),
    };
    let pairs = records.par_chunks(2).map_init(Default::default, of_two);
    pairs.collect::<Vec<Vec<_>>>().into_iter().flatten().collect()
}

/// The transforms of two records as the even and the odd part of that of one complex record.
///
/// It takes place in `room`, since fresh memory of this size takes a third as long as the transform.
fn together([first, second]: [&[f64]; 2], [lines, scratch]: &mut [Vec<Complex<f64>>; 2]) -> [Vec<Complex<f64>>; 2] {
    let size = |record: &[f64]| record.iter().map(|sample| sample.abs()).sum::<f64>();
    let ratio = size(first) / size(second);
    if !ratio.is_normal() {
        // The lines of a record of zeros are exactly zero, and what is not a number stays in its record.
        return [first, second].map(transform);
    }
    // Rounding errors are relative to the larger record, so both get the same size; a power of two rounds nothing.
    let scale = ratio.log2().round().exp2();
    let pair = |(first, second): (&f64, &f64)| Complex::new(*first, second * scale);
    lines.clear();
    lines.extend(first.iter().zip(second).map(pair));
    let plan = complex_plans().plan_fft_forward(lines.len());
    scratch.resize(plan.get_inplace_scratch_len(), Complex::ZERO);
    plan.process_with_scratch(lines, scratch);
    let mirrored = |line: usize| lines[(lines.len() - line) % lines.len()].conj();
    let count = lines.len() / 2 + 1;
    let even = (0..count).map(|line| (lines[line] + mirrored(line)) * 0.5);
    let odd = (0..count).map(|line| (lines[line] - mirrored(line)) * Complex::new(0.0, -0.5 / scale));
    [even.collect(), odd.collect()]
}

/// The real signal of `samples` samples with these lines of [`transform`], from 0 on, and zero above them.
pub fn synthesize(lines: &[Complex<f64>], samples: usize) -> Vec<f64> {
    let plan = plans().plan_fft_inverse(samples);
    let (mut input, mut output) = (plan.make_input_vec(), plan.make_output_vec());
    let scale = 1.0 / samples as f64;
    for (input, line) in input.iter_mut().zip(lines) {
        *input = line * scale;
    }
    // The lines at zero and at half the sample rate are real.
    input[0].im = 0.0;
    if samples.is_multiple_of(2) {
        input[samples / 2].im = 0.0;
    }
    plan.process(&mut input, &mut output)
        .expect("the plan was made for these lengths");
    output
}

/// Segmentation of a record.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Segments {
    /// Samples of a segment.
    pub length: usize,
    /// Samples that two segments share, fewer than their length.
    pub overlap: usize,
    /// Window.
    pub window: Window,
    /// Trend that is subtracted.
    pub trend: Trend,
}

/// Two-sided auto- and cross-spectral densities of several signals, averaged over segments.
#[derive(Clone, Debug, PartialEq)]
pub struct CrossSpectra {
    /// Frequencies, Hz.
    pub frequency: Vec<f64>,
    /// For each frequency the Hermitian matrix `E[X_i conj(X_j)]`, squared unit per Hz.
    pub density: Vec<DMatrix<Complex<f64>>>,
    /// Number of independent segments with the same variance as the overlapping ones that were averaged.
    pub averages: f64,
}

/// Averages the spectra of segments (P. D. Welch, IEEE Trans. Audio Electroacoust. 15, 1967).
///
/// `signals` are of one length, which must hold at least one segment; `rate` in Hz.
pub fn welch(signals: &[&[f64]], rate: f64, segments: &Segments) -> CrossSpectra {
    let Segments {
        length,
        overlap,
        window,
        trend,
    } = *segments;
    let (step, weights) = (length - overlap, window.weights(length));
    let starts: Vec<usize> = (0..)
        .map(|k| k * step)
        .take_while(|start| start + length <= signals[0].len())
        .collect();
    let scale = 1.0 / (rate * weights.iter().map(|w| w * w).sum::<f64>() * starts.len() as f64);
    let zero = DMatrix::zeros(signals.len(), signals.len());
    let mut density = vec![zero; length / 2 + 1];
    for start in &starts {
        let spectra: Vec<_> = signals
            .iter()
            .map(|signal| weighted(&signal[*start..start + length], &weights, trend))
            .collect();
        for (line, density) in density.iter_mut().enumerate() {
            let add = |i: usize, j: usize| spectra[i][line] * spectra[j][line].conj() * scale;
            *density += DMatrix::from_fn(signals.len(), signals.len(), add);
        }
    }
    let frequency = (0..density.len())
        .map(|line| line as f64 * rate / length as f64)
        .collect();
    CrossSpectra {
        frequency,
        density,
        averages: independent(starts.len(), step, &weights),
    }
}

fn weighted(segment: &[f64], weights: &[f64], trend: Trend) -> Vec<Complex<f64>> {
    let mut segment = segment.to_vec();
    trend.remove(&mut segment);
    segment
        .iter_mut()
        .zip(weights)
        .for_each(|(sample, weight)| *sample *= weight);
    transform(&segment)
}

/// Number of independent segments with the same variance as the overlapping ones: Welch's equation for white noise.
fn independent(count: usize, step: usize, weights: &[f64]) -> f64 {
    let correlation = |shift: usize| weights.iter().zip(&weights[shift..]).map(|(a, b)| a * b).sum::<f64>();
    let overlapping = |k: usize| {
        if k * step < weights.len() {
            (correlation(k * step) / correlation(0)).powi(2)
        } else {
            0.0
        }
    };
    let excess: f64 = (1..count)
        .map(|k| (1.0 - k as f64 / count as f64) * overlapping(k))
        .sum();
    count as f64 / (1.0 + 2.0 * excess)
}
