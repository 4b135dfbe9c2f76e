//! The harmonics of a swept sine: what answers at once, twice and three times the frequency of the excitation.
//!
//! The excitation is written as `Re a(t)` with `a = A exp(jφ)`, and its n-th multiple as `Re A exp(jnφ)`. Where a sweep
//! passes f, f/2 and f/3 at different times, the spectra of these multiples around f differ in their slope of phase, so
//! that one least squares over the lines around f tells the responses to them apart. They are the generalised frequency
//! responses of a sweep (A. Farina, AES Convention 108, 2000; A. Novák et al., IEEE Trans. Instrum. Meas. 59, 2010),
//! without the time window that separates them there and smears a lightly damped mode.

use nalgebra::{Complex, DMatrix, DVector};
use rayon::prelude::*;

use super::local::{neighbourhood, pseudo_inverse};
use crate::spectrum::{synthesize, transform};

/// How the neighbourhood of a frequency is chosen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Neighbourhood {
    /// Lines on each side, at least.
    pub lines: usize,
    /// Half width relative to the frequency, where that holds more lines.
    pub width: f64,
}

/// The response of one signal at one frequency to the multiples of the excitation.
#[derive(Clone, Debug, PartialEq)]
pub struct HarmonicLine {
    /// Hz, that of the response.
    pub frequency: f64,
    /// For each order asked for: response over the amplitude of the excitation at `frequency / order`, with the phase
    /// of the excitation taken `order` times. `None` where the sweep does not pass there.
    pub value: Vec<Option<Complex<f64>>>,
    /// Variances `E|value - truth|²`.
    pub variance: Vec<f64>,
}

/// The moment in which a sweep passes a frequency.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Passage {
    /// s from the first sample.
    pub time: f64,
    /// In the unit of the excitation.
    pub amplitude: f64,
}

/// A sweep as the sum of its multiples needs it.
#[derive(Clone, Debug, PartialEq)]
pub struct Swept {
    rate: f64,
    samples: usize,
    /// Hz, where the excitation goes.
    band: (f64, f64),
    /// Spectra of the multiples, order after order from 1.
    multiples: Vec<Vec<Complex<f64>>>,
    envelope: Vec<f64>,
    phase: Vec<f64>,
}

impl Swept {
    /// Takes a measured excitation at `rate` Hz that sweeps over `band` (Hz), for the orders 1 to `orders`.
    pub fn new(excitation: &[f64], rate: f64, band: (f64, f64), orders: usize) -> Self {
        let (re, im) = analytic(excitation, rate, band);
        let envelope: Vec<f64> = re.iter().zip(&im).map(|(re, im)| re.hypot(*im)).collect();
        let angle: Vec<f64> = re.iter().zip(&im).map(|(re, im)| im.atan2(*re)).collect();
        let multiple = |order: usize| -> Vec<Complex<f64>> {
            let signal: Vec<f64> = envelope
                .iter()
                .zip(&angle)
                .map(|(a, phi)| a * (order as f64 * phi).cos())
                .collect();
            transform(&signal)
        };
        // The first is the measurement itself: what the filter left out of it excites too.
        let first = std::iter::once(transform(excitation));
        Self {
            rate,
            samples: excitation.len(),
            band,
            multiples: first.chain((2..=orders).map(multiple)).collect(),
            envelope,
            phase: unwrap(&angle),
        }
    }

    /// When the excitation passes `frequency` (Hz), s from the first sample, and its amplitude there: the medians over the
    /// time that it is within a few percent of it; `None` where it never is.
    pub fn passage(&self, frequency: f64) -> Option<Passage> {
        const NEAR: f64 = 0.04;
        // Half a period to each side: a difference over that span is the mean frequency of one period.
        let half = (0.5 * self.rate / frequency).ceil() as usize;
        let near = (half..self.samples.saturating_sub(half)).filter(|&k| {
            let cycles = (self.phase[k + half] - self.phase[k - half]) / std::f64::consts::TAU;
            (cycles * self.rate / (2 * half) as f64 / frequency - 1.0).abs() < NEAR
        });
        let near: Vec<usize> = near.collect();
        let middle = near.len() / 2;
        let time = *near.get(middle)? as f64 / self.rate;
        let mut envelope: Vec<f64> = near.iter().map(|&k| self.envelope[k]).collect();
        let amplitude = *envelope.select_nth_unstable_by(middle, f64::total_cmp).1;
        Some(Passage { time, amplitude })
    }

    /// The responses of a signal of the same record at `frequencies` (Hz, increasing).
    pub fn responses(&self, signal: &[f64], frequencies: &[f64], around: Neighbourhood) -> Vec<HarmonicLine> {
        self.responses_in(&transform(signal), frequencies, around)
    }

    /// The same of the signal's spectrum.
    pub fn responses_in(
        &self,
        spectrum: &[Complex<f64>],
        frequencies: &[f64],
        around: Neighbourhood,
    ) -> Vec<HarmonicLine> {
        let spacing = self.rate / self.samples as f64;
        let line = |&frequency: &f64| {
            let half = around.lines.max((around.width * frequency / spacing) as usize);
            let lines = neighbourhood((frequency / spacing).round() as usize, half, spectrum.len());
            self.line(spectrum, frequency, spacing, lines)
        };
        frequencies.par_iter().map(line).collect()
    }

    fn line(
        &self,
        spectrum: &[Complex<f64>],
        frequency: f64,
        spacing: f64,
        lines: std::ops::Range<usize>,
    ) -> HarmonicLine {
        let scale = 2.0 / (lines.len() as f64 * spacing);
        let offsets: Vec<f64> = lines
            .clone()
            .map(|k| (k as f64 * spacing - frequency) * scale)
            .collect();
        let passed: Vec<usize> = (1..=self.multiples.len())
            .filter(|&order| self.passes(frequency / order as f64))
            .collect();
        let references: Vec<&[Complex<f64>]> = passed
            .iter()
            .map(|order| &self.multiples[order - 1][lines.clone()])
            .collect();
        let fits = fit(&references, &spectrum[lines], &offsets);
        let mut line = HarmonicLine {
            frequency,
            value: vec![None; self.multiples.len()],
            variance: vec![f64::INFINITY; self.multiples.len()],
        };
        for (order, (value, variance)) in passed.into_iter().zip(fits) {
            line.value[order - 1] = Some(value);
            line.variance[order - 1] = variance;
        }
        line
    }

    fn passes(&self, frequency: f64) -> bool {
        (self.band.0..=self.band.1).contains(&frequency)
    }
}

/// `Y (1 + a δ) = Σ_n (b_n0 + b_n1 δ) X_n + t`: value and variance of each `b_n0`.
fn fit(references: &[&[Complex<f64>]], response: &[Complex<f64>], offsets: &[f64]) -> Vec<(Complex<f64>, f64)> {
    let unknowns = 2 * references.len() + 2;
    let regressors = DMatrix::from_fn(offsets.len(), unknowns, |k, unknown| {
        match (unknown < 2 * references.len(), unknown % 2) {
            (true, 0) => references[unknown / 2][k],
            (true, _) => references[unknown / 2][k] * offsets[k],
            (false, 0) => Complex::ONE,
            (false, _) => -response[k] * offsets[k],
        }
    });
    let response = DVector::from_column_slice(response);
    let inverse = pseudo_inverse(&regressors);
    let solution = &inverse * &response;
    let freedom = offsets.len().saturating_sub(unknowns).max(1) as f64;
    let noise = (&response - &regressors * &solution).norm_squared() / freedom;
    (0..references.len())
        .map(|n| {
            let weight = inverse.row(2 * n).norm_squared();
            (solution[2 * n], noise * weight)
        })
        .collect()
}

/// Real and imaginary part of the signal whose spectrum is twice that of `signal` within the band and zero elsewhere.
fn analytic(signal: &[f64], rate: f64, band: (f64, f64)) -> (Vec<f64>, Vec<f64>) {
    /// The ends of a sweep reach beyond its band.
    const BEYOND: f64 = 1.4;
    let spacing = rate / signal.len() as f64;
    let inside = (band.0 / BEYOND)..=(band.1 * BEYOND);
    let spectrum: Vec<Complex<f64>> = transform(signal)
        .into_iter()
        .enumerate()
        .map(|(k, line)| {
            if inside.contains(&(k as f64 * spacing)) {
                line
            } else {
                Complex::ZERO
            }
        })
        .collect();
    let quarter: Vec<_> = spectrum.iter().map(|line| line * -Complex::I).collect();
    (synthesize(&spectrum, signal.len()), synthesize(&quarter, signal.len()))
}

fn unwrap(angle: &[f64]) -> Vec<f64> {
    let mut turns = 0.0;
    let mut last = angle.first().copied().unwrap_or(0.0);
    angle
        .iter()
        .map(|&angle| {
            let step: f64 = angle - last;
            turns -= (step / std::f64::consts::TAU).round() * std::f64::consts::TAU;
            last = angle;
            angle + turns
        })
        .collect()
}
