//! The noise of a sensor in a record, from what is surely nothing else.
//!
//! The best witness is what differs between the periods of a record that repeats; next, what a sensor shows while nothing
//! moves; else the highest frequencies, at which little does. A drift or a step from one end to the other would leak into
//! these: so the straight line goes first, and a window keeps the rest where it is (Bendat and Piersol, Random data, 4th
//! edition, section 11.5; for periods Pintelon and Schoukens, System identification, 2nd edition, section 2.6).

use std::f64::consts::LN_2;

use crate::mean::rms;
use crate::spectrum::{Trend, Window, transform};

/// Share of the spectrum, its highest part, that is taken for noise.
const HIGHEST: f64 = 0.1;
/// Parts in which a record is looked at for rest,
const PARTS: usize = 20;
/// and the fewest samples of one.
const FEWEST: usize = 20;
/// What a signal scatters by while it rests, over what it does in the whole record.
const REST: f64 = 0.005;
/// Share of the inputs' power that does not repeat where a record has several periods.
const REPEATS: f64 = 1e-4;
/// The most periods in which a record is taken apart.
const MOST_PERIODS: usize = 64;

/// Standard deviation of a response's noise, by the samples of it and of the inputs; `periodic` where the record is made
/// of whole periods.
pub fn noise(samples: &[f64], inputs: &[&[f64]], periodic: bool) -> f64 {
    let of_periods = periodic.then(|| periods(inputs)).filter(|&count| count > 1);
    of_periods
        .map(|count| between_periods(samples, count))
        .or_else(|| at_rest(samples, inputs))
        .unwrap_or_else(|| highest(samples))
}

/// What differs between so many periods: the lines of the spectrum that none of them alone has.
fn between_periods(samples: &[f64], count: usize) -> f64 {
    let lines = transform(samples);
    let others = lines.iter().enumerate().filter(|(k, _)| !k.is_multiple_of(count));
    let (power, number) = others.fold((0.0, 0), |(power, number), (_, line)| {
        (power + line.norm_sqr(), number + 1)
    });
    (power / f64::from(number) / samples.len() as f64).sqrt()
}

/// How many periods the inputs have in their record: the most that leave nothing of them.
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

/// What a sensor scatters by about straight lines in those parts of a record in which neither it nor an input moves;
/// `None` without such a part.
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
    // A line takes two of the samples' freedoms.
    let free = (length as f64 / (length as f64 - 2.0)).sqrt();
    let own: Vec<f64> = resting
        .map(|first| free * scatter(&samples[first..][..length], Trend::Linear))
        .collect();
    let power: f64 = own.iter().map(|own| own * own).sum();
    (!own.is_empty()).then(|| (power / own.len() as f64).sqrt())
}

/// Root of the mean square about the trend.
fn scatter(samples: &[f64], trend: Trend) -> f64 {
    let mut about = samples.to_vec();
    trend.remove(&mut about);
    rms(&about)
}

/// The standard deviation of white noise with the power of the highest part of the spectrum.
fn highest(samples: &[f64]) -> f64 {
    let mut weighted = samples.to_vec();
    Trend::Linear.remove(&mut weighted);
    let weights = Window::Hann.weights(samples.len());
    weighted.iter_mut().zip(&weights).for_each(|(y, weight)| *y *= weight);
    let lines = transform(&weighted);
    let first = ((1.0 - HIGHEST) * lines.len() as f64) as usize;
    let mut power: Vec<f64> = lines[first..].iter().map(|line| line.norm_sqr()).collect();
    let middle = power.len() / 2;
    // Powers of lines of noise are distributed exponentially: their median is ln 2 of their mean.
    let mean = *power.select_nth_unstable_by(middle, f64::total_cmp).1 / LN_2;
    (mean / weights.iter().map(|w| w * w).sum::<f64>()).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    const SAMPLES: usize = 20_000;
    const NOISE: f64 = 0.01;

    /// Uniform numbers of this standard deviation by a linear congruence.
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
        assert!((found / NOISE - 1.0).abs() < 0.1, "{found}, made with {NOISE}");
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

    /// Hum of the mains is not at the highest frequencies, but stays while nothing moves.
    #[test]
    fn what_a_sensor_shows_at_rest_is_its_noise() {
        let drive = |t: f64| if t < 0.3 { 0.0 } else { (9.7 * TAU * t).sin() };
        let hum = |t: f64| 2f64.sqrt() * NOISE * (333.0 * TAU * t).sin();
        let measured = record(|t| 20.0 * drive(t) + hum(t));
        is_found(noise(&measured, &[&record(drive)], false));
        // Where the input never rests, a crest of the response is no rest either.
        let sine = record(|t| (TAU * t).sin());
        assert!(at_rest(&sine, &[&sine]).is_none());
    }

    /// Noise that falls with frequency is ten times smaller at the highest.
    #[test]
    fn what_differs_between_periods_is_noise_at_all_frequencies() {
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
