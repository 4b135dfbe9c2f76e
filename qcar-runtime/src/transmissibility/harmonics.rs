//! The harmonics of a swept sine: responses at the frequency of the excitation and at twice and three times that
//! frequency.
//!
//! The excitation is written as `Re a(t)` with `a = A exp(jφ)`, and its n-th multiple as `Re A exp(jnφ)`. A sweep
//! passes f, f/2 and f/3 at different times, so the spectra of these multiples around f have different slopes of the
//! phase, and one least squares over the lines around f separates the responses to them. They are the generalised
//! frequency responses of a sweep (A. Farina, AES Convention 108, 2000; A. Novák et al., IEEE Trans. Instrum. Meas. 59,
//! 2010), without the time window of these methods, which smears a lightly damped mode.

use nalgebra::{Complex, DVector};
use rayon::prelude::*;

use super::local::neighbourhood;
use super::regressors::Regressors;
use crate::spectrum::{synthesize, transform};

/// Neighbourhood of a frequency.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Neighbourhood {
    /// Fewest lines on each side.
    pub lines: usize,
    /// Half width relative to the frequency, if that contains more lines.
    pub width: f64,
}

/// The response of one signal at one frequency to the multiples of the excitation.
#[derive(Clone, Debug, PartialEq)]
pub struct HarmonicLine {
    /// Frequency of the response, Hz.
    pub frequency: f64,
    /// For each order: response over the amplitude of the excitation at `frequency / order`, relative to `order` times
    /// the phase of the excitation. `None` if the sweep does not pass that frequency.
    pub value: Vec<Option<Complex<f64>>>,
    /// Variances `E|value - truth|²`, for each order.
    pub variance: Vec<f64>,
}

/// The passage of a sweep through a frequency.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Passage {
    /// Time, s after the first sample.
    pub time: f64,
    /// Amplitude, in the unit of the excitation.
    pub amplitude: f64,
}

/// A sweep with the spectra of its multiples.
#[derive(Clone, Debug, PartialEq)]
pub struct Swept {
    rate: f64,
    samples: usize,
    /// Band of the excitation, Hz.
    band: (f64, f64),
    /// Spectra of the multiples, from order 1 on.
    multiples: Vec<Vec<Complex<f64>>>,
    envelope: Vec<f64>,
    phase: Vec<f64>,
}

impl Swept {
    /// Prepares a measured excitation at `rate` Hz that sweeps over `band` (Hz), for the orders 1 to `orders`.
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
        // The first order is the measurement itself, since the part outside the filter excites too.
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

    /// Time (s after the first sample) and amplitude at which the excitation passes `frequency` (Hz): medians over the
    /// time within a few percent of it. `None` if it never passes.
    pub fn passage(&self, frequency: f64) -> Option<Passage> {
        const NEAR: f64 = 0.04;
        // Half a period on each side: a difference over that span is the mean frequency of one period.
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

    /// Responses of a signal of the same record at `frequencies` (Hz, increasing).
    pub fn responses(&self, signal: &[f64], frequencies: &[f64], around: Neighbourhood) -> Vec<HarmonicLine> {
        self.responses_in(&transform(signal), frequencies, around)
    }

    /// The same from the spectrum of the signal.
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

/// Value and variance of each `b_n0` in `Y (1 + a δ) = Σ_n (b_n0 + b_n1 δ) X_n + t`.
fn fit(references: &[&[Complex<f64>]], response: &[Complex<f64>], offsets: &[f64]) -> Vec<(Complex<f64>, f64)> {
    let response = DVector::from_column_slice(response);
    let sloped = |lines: &DVector<Complex<f64>>| DVector::from_fn(lines.len(), |k, _| lines[k] * offsets[k]);
    let of_reference = |lines: &&[Complex<f64>]| {
        let lines = DVector::from_column_slice(lines);
        let sloped = sloped(&lines);
        [lines, sloped]
    };
    let own = [response.map(|_| Complex::ONE), -sloped(&response)];
    let regressors = Regressors::new(references.iter().flat_map(of_reference).chain(own));
    let weights = regressors.weights();
    let (solution, residual) = regressors.solve(&weights, &response);
    let freedom = offsets.len().saturating_sub(solution.len()).max(1) as f64;
    let noise = residual.norm_squared() / freedom;
    (0..references.len())
        .map(|n| (solution[2 * n], noise * weights[2 * n].norm_squared()))
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
