//! Removes the noise of recorded inputs where it hides the excitation.
//!
//! A simulation treats the noise of a recorded input as excitation, although the machine never responded to it. At
//! frequencies where the input is mostly noise, the model then predicts a response that was not measured, and any
//! effect that filters the input seems to be missing. The Wiener filter weights each frequency by the share of its
//! power that is not noise (Wiener, N.: Extrapolation, interpolation, and smoothing of stationary time series, 1949).
//! It gives the estimate of the true input with the least mean square error.

use std::f64::consts::TAU;

use nalgebra::Complex;

use super::predict::predict;
use super::series::LEAST_NOISE;
use super::time_history::noise;
use super::{Evidence, PredictError, Stimulus};
use crate::campaign::Role;
use crate::mean::{deviation, rms};
use crate::model::Model;
use crate::random::SplitMix;
use crate::response::parameters::Values;
use crate::simulate::Accuracy;
use crate::spectrum::{synthesize, transform};
use crate::transmissibility::Point;

/// Spectral lines to each side over which the power is averaged: the mean of 33 lines of noise scatters by a quarter.
const AROUND: usize = 16;
/// Seed of the draw, so that each search gives the same answer.
const SEED: u64 = 1;

/// A data set whose recorded inputs are filtered.
pub struct Quieter {
    /// The data set.
    pub evidence: Evidence,
    /// The same with a random draw of the noise that the filter leaves, added to the inputs.
    drawn: Evidence,
}

impl Quieter {
    /// The same with records integrated with this accuracy.
    pub fn integrated_with(self, accuracy: Accuracy) -> Self {
        Self {
            evidence: self.evidence.integrated_with(accuracy),
            drawn: self.drawn.integrated_with(accuracy),
        }
    }

    /// The data with the noise of all recorded inputs removed; `None` if the removed part of every input is below the
    /// noise of a 12-bit converter. Only the responses can show whether that part is noise, since an excitation may be
    /// white too.
    pub fn of(evidence: &Evidence) -> Option<Self> {
        let (mut quieter, mut drawn) = (evidence.clone(), evidence.clone());
        let mut random = SplitMix::new(SEED);
        let false_alarm = evidence.numbers.error_probability;
        let mut notices = Vec::new();
        for (run, drawn) in quieter.runs.iter_mut().zip(&mut drawn.runs) {
            let (Stimulus::History { inputs, periodic, .. }, Stimulus::History { inputs: noisy, .. }) =
                (&mut run.stimulus, &mut drawn.stimulus)
            else {
                continue;
            };
            for ((sensor, samples), (_, noisy)) in inputs.signals.iter_mut().zip(&mut noisy.signals) {
                let [filtered, noise] = without_noise(samples, *periodic, false_alarm, &mut random);
                let removed = rms(samples.iter().zip(&filtered).map(|(a, b)| a - b)) / deviation(samples);
                if removed > LEAST_NOISE {
                    notices.push(notice(&run.name, sensor, removed));
                    *noisy = filtered
                        .iter()
                        .zip(&noise)
                        .map(|(signal, noise)| signal + noise)
                        .collect();
                    *samples = filtered;
                }
            }
        }
        if notices.is_empty() {
            return None;
        }
        quieter.notices.extend(notices);
        Some(Self {
            evidence: quieter,
            drawn,
        })
    }

    /// The filtered data. The uncertainty of each response includes that of its input: the RMS of the model's response
    /// to the noise that the filter leaves.
    ///
    /// # Errors
    /// Fails if the model lacks a measured quantity.
    pub fn seen_by(self, model: &dyn Model, values: &Values) -> Result<Evidence, PredictError> {
        let mut evidence = self.evidence;
        for role in [Role::Fit, Role::HeldOut] {
            let without = predict(model, values, &[], &evidence, role)?;
            let with = predict(model, values, &[], &self.drawn, role)?;
            for (without, with) in without.iter().zip(&with) {
                let differences = without.value.iter().zip(&with.value).map(|(a, b)| (a - b).norm());
                let added = rms(differences);
                let series = &mut evidence.series[without.series];
                let uncertain = series.sigma.iter_mut().chain(&mut series.noise);
                uncertain.for_each(|own| *own = own.hypot(added));
            }
        }
        Ok(evidence)
    }
}

fn notice(run: &str, sensor: &Point, removed: f64) -> String {
    let percent = 100.0 * removed;
    format!(
        "{run}: the responses show that {percent:.2} % of the recorded input {sensor} is noise; it is removed where it \
         hides the excitation"
    )
}

/// A signal through the Wiener filter for its noise, which is taken as white, and a draw of the noise that is left.
fn without_noise(samples: &[f64], periodic: bool, false_alarm: f64, random: &mut SplitMix) -> [Vec<f64>; 2] {
    let noise = noise(samples, &[samples], periodic);
    if periodic {
        return filtered(samples, noise, false_alarm, random);
    }
    // The filter treats its input as one period. The line through both ends is removed and the signal is continued as
    // an odd function, so that it has no jump and no kink there.
    let last = samples.len() - 1;
    let line = |k: usize| samples[0] + (samples[last] - samples[0]) * k as f64 / last as f64;
    let moving: Vec<f64> = (0..=last).map(|k| samples[k] - line(k)).collect();
    let mirrored = moving[1..last].iter().rev().map(|own| -own);
    let both: Vec<f64> = moving.iter().copied().chain(mirrored).collect();
    let [signal, mut left] = filtered(&both, noise, false_alarm, random);
    left.truncate(samples.len());
    [(0..=last).map(|k| signal[k] + line(k)).collect(), left]
}

/// One period of a signal through the Wiener filter for white noise of this standard deviation, and a draw of the noise
/// that the filter leaves. At each frequency, the filter leaves the share of the noise power that the signal has of the
/// whole power. It leaves nothing where all power could be noise: of a spectrum of noise alone, some line would seem to
/// contain a signal with the probability `false_alarm`. A law of the speed would amplify the noise there.
fn filtered(period: &[f64], noise: f64, false_alarm: f64, random: &mut SplitMix) -> [Vec<f64>; 2] {
    let mut lines = transform(period);
    let noise = noise.powi(2) * period.len() as f64;
    let power: Vec<f64> = lines.iter().map(|line| line.norm_sqr()).collect();
    let independent = power.len() as f64 / (2 * AROUND + 1) as f64;
    let certain = (independent / false_alarm).ln();
    let mut left = Vec::with_capacity(lines.len());
    for (k, line) in lines.iter_mut().enumerate() {
        let near = &power[k.saturating_sub(AROUND)..(k + AROUND + 1).min(power.len())];
        let share = share_of_signal(near, noise, certain);
        *line *= share;
        left.push(Complex::from_polar((share * noise).sqrt(), TAU * random.uniform()));
    }
    [synthesize(&lines, period.len()), synthesize(&left, period.len())]
}

/// Share of the power around a line that is not noise; zero if all of it could be noise.
///
/// The lines of a mirrored signal have one degree of freedom, so the sum of `n` of them is distributed as χ² with `n`
/// degrees. The probability that noise has `a` times its mean power there is at most `(a exp(1 - a))^(n/2)` (Chernoff,
/// H.: A measure of asymptotic efficiency for tests of a hypothesis based on the sum of observations, Annals of
/// Mathematical Statistics 23, 1952). `certain` is the negative logarithm of the accepted probability. The lines of a
/// periodic signal have two degrees, which makes the test stricter than it needs to be.
fn share_of_signal(power: &[f64], noise: f64, certain: f64) -> f64 {
    if noise == 0.0 {
        return 1.0;
    }
    let count = power.len() as f64;
    let ratio = power.iter().sum::<f64>() / count / noise;
    if ratio > 1.0 && 0.5 * count * (ratio - 1.0 - ratio.ln()) >= certain {
        1.0 - 1.0 / ratio
    } else {
        0.0
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use super::without_noise;
    use crate::mean::rms;
    use crate::random::SplitMix;

    const SAMPLES: usize = 8000;
    const FALSE_ALARM: f64 = 0.05;

    fn error(truth: &[f64], signal: &[f64]) -> f64 {
        rms(truth.iter().zip(signal).map(|(a, b)| a - b))
    }

    /// A drifting signal whose power ends at a tenth of the band keeps little more than a tenth of the noise power: its
    /// ends leak.
    #[test]
    fn little_more_than_the_noise_within_the_band_of_the_signal_is_left() {
        let tone = |f: f64, k: usize| (TAU * f * k as f64 / SAMPLES as f64 + f * f).sin();
        let truth: Vec<f64> = (0..SAMPLES)
            .map(|k| (1..40).map(|f| tone(10.0 * f as f64, k)).sum::<f64>() + 2e-3 * k as f64)
            .collect();
        let mut random = SplitMix::new(5);
        let noisy: Vec<f64> = truth.iter().map(|own| own + 0.1 * random.normal()).collect();
        let [filtered, left] = without_noise(&noisy, false, FALSE_ALARM, &mut random);
        let (before, after) = (error(&truth, &noisy), error(&truth, &filtered));
        assert!(after < 0.45 * before, "{before} to {after}");
        // The draw is as large as the error that is left.
        let drawn = rms(&left);
        assert!((drawn / after - 1.0).abs() < 0.15, "{drawn} for {after}");
        // Without noise, hardly anything is removed.
        let [filtered, _] = without_noise(&truth, false, FALSE_ALARM, &mut random);
        assert!(error(&truth, &filtered) < 1e-3 * before);
    }

    /// Of a slow sine, noise alone is left beyond its lines, where a law of the speed would amplify it.
    #[test]
    fn noise_far_above_a_slow_motion_is_removed_altogether() {
        let truth: Vec<f64> = (0..1600).map(|k| (TAU * 0.5 * k as f64 / 400.0).sin()).collect();
        let speed = |signal: &[f64]| -> Vec<f64> { signal.windows(2).map(|pair| pair[1] - pair[0]).collect() };
        let mut random = SplitMix::new(3);
        let left = |random: &mut SplitMix| {
            let noisy: Vec<f64> = truth.iter().map(|own| own + 1e-3 * random.normal()).collect();
            let [filtered, _] = without_noise(&noisy, false, FALSE_ALARM, random);
            error(&speed(&truth), &speed(&filtered)) / error(&speed(&truth), &speed(&noisy))
        };
        // One false alarm is expected in twenty draws; there are more than three in two of a hundred such sets.
        let alarms = (0..20).filter(|_| left(&mut random) > 0.05).count();
        assert!(alarms <= 3, "{alarms} of 20");
    }
}
