//! Estimates the noise of a sensor from the part of a record that contains noise alone.
//!
//! The best source is the difference between the periods of a periodic record. The next is the signal while nothing
//! moves. Otherwise the highest frequencies are used, where the signal is small. A drift or a step between the ends
//! would leak into these frequencies, so a straight line is removed and a window is applied (Bendat and Piersol, Random
//! data, 4th edition, section 11.5; for periods Pintelon and Schoukens, System identification, 2nd edition, section
//! 2.6).

use std::f64::consts::LN_2;

use crate::mean::rms;
use crate::spectrum::{Trend, Window, transform};

/// Share of the spectrum, at its upper end, that counts as noise.
const HIGHEST: f64 = 0.1;
/// Number of parts of a record that are tested for rest. A choice, like the limits below.
const PARTS: usize = 20;
/// Fewest samples of a part.
const FEWEST: usize = 20;
/// Largest scatter of a signal at rest, relative to its scatter over the whole record.
const REST: f64 = 0.005;
/// Largest share of the inputs' power that does not repeat in a record with several periods.
const REPEATS: f64 = 1e-4;
/// Largest number of periods in a record.
const MOST_PERIODS: usize = 64;

/// Standard deviation of the noise of a response. `periodic` states that the record consists of whole periods.
pub fn noise(samples: &[f64], inputs: &[&[f64]], periodic: bool) -> f64 {
    let of_periods = periodic.then(|| periods(inputs)).filter(|&count| count > 1);
    of_periods
        .map(|count| between_periods(samples, count))
        .or_else(|| at_rest(samples, inputs))
        .unwrap_or_else(|| highest(samples))
}

/// Noise from the difference between `count` periods: the spectral lines that are no harmonics of a period.
fn between_periods(samples: &[f64], count: usize) -> f64 {
    let lines = transform(samples);
    let others = lines.iter().enumerate().filter(|(k, _)| !k.is_multiple_of(count));
    let (power, number) = others.fold((0.0, 0), |(power, number), (_, line)| {
        (power + line.norm_sqr(), number + 1)
    });
    (power / f64::from(number) / samples.len() as f64).sqrt()
}

/// Number of periods in the record: the largest number for which the inputs repeat.
fn periods(inputs: &[&[f64]]) -> usize {
    let spectra: Vec<Vec<f64>> = inputs
        .iter()
        .map(|samples| transform(samples).iter().map(|line| line.norm_sqr()).collect())
        .collect();
    let repeat = |&count: &usize| {
        spectra.iter().all(|power| {
            let of_period: f64 = power.iter().step_by(count).skip(1).sum();
            let all: f64 = power.iter().skip(1).sum();
            all > 0.0 && all - of_period < REPEATS * all
        })
    };
    (2..=MOST_PERIODS).rev().find(repeat).unwrap_or(1)
}

/// Noise about straight lines in the parts of a record in which neither the sensor nor an input moves; `None` without
/// such a part.
fn at_rest(samples: &[f64], inputs: &[&[f64]]) -> Option<f64> {
    let length = samples.len() / PARTS;
    if length < FEWEST {
        return None;
    }
    let rests = |signal: &[f64], first: usize| {
        scatter(&signal[first..][..length], Trend::Constant) <= REST * scatter(signal, Trend::Constant)
    };
    let resting = (0..PARTS)
        .map(|part| part * length)
        .filter(|&first| rests(samples, first) && inputs.iter().all(|input| rests(input, first)));
    // A straight line uses two degrees of freedom.
    let free = (length as f64 / (length as f64 - 2.0)).sqrt();
    let own: Vec<f64> = resting
        .map(|first| free * scatter(&samples[first..][..length], Trend::Linear))
        .collect();
    let power: f64 = own.iter().map(|own| own * own).sum();
    (!own.is_empty()).then(|| (power / own.len() as f64).sqrt())
}

/// Root mean square about the trend.
fn scatter(samples: &[f64], trend: Trend) -> f64 {
    let mut about = samples.to_vec();
    trend.remove(&mut about);
    rms(&about)
}

/// Standard deviation of white noise with the power of the highest part of the spectrum.
fn highest(samples: &[f64]) -> f64 {
    let mut weighted = samples.to_vec();
    Trend::Linear.remove(&mut weighted);
    let weights = Window::Hann.weights(samples.len());
    weighted.iter_mut().zip(&weights).for_each(|(y, weight)| *y *= weight);
    let lines = transform(&weighted);
    let first = ((1.0 - HIGHEST) * lines.len() as f64) as usize;
    let mut power: Vec<f64> = lines[first..].iter().map(|line| line.norm_sqr()).collect();
    let middle = power.len() / 2;
    // The power of noise lines has an exponential distribution: its median is ln 2 times its mean.
    let mean = *power.select_nth_unstable_by(middle, f64::total_cmp).1 / LN_2;
    (mean / weights.iter().map(|w| w * w).sum::<f64>()).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    const SAMPLES: usize = 20_000;
    const NOISE: f64 = 0.01;

    /// Uniform random numbers with this standard deviation from a linear congruential generator.
    fn random(sigma: f64) -> impl FnMut() -> f64 {
        let mut state = 7_u64;
        move || {
            state = state
                .wrapping_mul(6364136223846793005)
                .wrapping_add(1442695040888963407);
            ((state >> 11) as f64 / (1u64 << 53) as f64 - 0.5) * 12f64.sqrt() * sigma
        }
    }

    fn record(signal: impl Fn(f64) -> f64) -> Vec<f64> {
        (0..SAMPLES).map(|k| signal(k as f64 / SAMPLES as f64)).collect()
    }

    fn noisy(signal: impl Fn(f64) -> f64) -> Vec<f64> {
        let mut random = random(NOISE);
        record(signal).into_iter().map(|y| y + random()).collect()
    }

    fn is_found(found: f64) {
        assert!((found / NOISE - 1.0).abs() < 0.1, "{found}, not {NOISE}");
    }

    #[test]
    fn a_drift_and_a_step_from_end_to_end_are_no_noise() {
        let busy = record(|t| (40.3 * TAU * t).sin());
        for signal in [
            |_| 0.0,
            |t: f64| 30.0 * t,
            |t: f64| (7.25 * TAU * t).sin() + 40.0 * t * t,
        ] {
            is_found(noise(&noisy(signal), &[&busy], false));
        }
    }

    /// Mains hum has no power at the highest frequencies, but remains at rest.
    #[test]
    fn the_reading_at_rest_is_noise() {
        let drive = |t: f64| if t < 0.3 { 0.0 } else { (9.7 * TAU * t).sin() };
        let hum = |t: f64| 2f64.sqrt() * NOISE * (333.0 * TAU * t).sin();
        let measured = record(|t| 20.0 * drive(t) + hum(t));
        is_found(noise(&measured, &[&record(drive)], false));
        // If the input never rests, a peak of the response is not at rest either.
        let sine = record(|t| (TAU * t).sin());
        assert!(at_rest(&sine, &[&sine]).is_none());
    }

    /// Noise that falls with frequency is ten times smaller at the highest frequencies.
    #[test]
    fn differences_between_periods_are_noise_at_all_frequencies() {
        let drive = record(|t| (24.0 * TAU * t).sin() + (56.0 * TAU * t).cos());
        assert_eq!(periods(&[&drive]), 8);
        let mut random = random(NOISE * (1.0 - 0.9f64.powi(2)).sqrt());
        let mut slow = 0.0;
        let measured: Vec<f64> = drive
            .iter()
            .map(|y| {
                slow = 0.9 * slow + random();
                3.0 * y + slow
            })
            .collect();
        assert!((noise(&measured, &[&drive], true) / NOISE - 1.0).abs() < 0.15);
        assert!(noise(&measured, &[&drive], false) < 0.5 * NOISE);
    }
}
