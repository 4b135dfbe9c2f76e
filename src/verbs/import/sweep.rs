//! Properties of a sine sweep from the signal of its pad.

use std::ops::Range;

use qcar_runtime::campaign::Quantity;
use qcar_runtime::mean::rms_or_nan;

/// A sine of rising frequency and constant peak velocity.
#[derive(Clone, Copy, Debug)]
pub(super) struct SweepParameters {
    /// Peak velocity, m/s.
    pub peak_velocity: f64,
    /// First frequency, Hz.
    pub start: f64,
    /// Last frequency, Hz.
    pub end: f64,
    pub logarithmic: bool,
}

/// Fewest half periods of a sweep.
const LEAST: usize = 20;
/// Smallest ratio of the last to the first frequency.
const RISE: f64 = 2.0;
/// Largest relative RMS deviation of the half periods from a linear or a logarithmic sweep.
const STRAIGHT: f64 = 0.1;
/// Values are rounded to the fewest digits that change them by less than this share.
const ROUNDING: f64 = 0.05;

/// Largest relative deviation of the velocity of a half period from the median.
const FULL: f64 = 0.2;
/// Share of the RMS velocity that a swing must have.
const SWING: f64 = 0.5;
/// Cut-off frequency of the integration, 1/s: a tenth of a hertz.
const SLOW: f64 = 0.6;

/// A half period: its middle (s), its frequency (Hz) and the peak of the velocity in it (m/s).
struct Half {
    time: f64,
    frequency: f64,
    velocity: f64,
}

/// Length of the blocks that are tested for rest, s.
const BLOCK: f64 = 0.5;
/// A pad is at rest if its velocity range is below this share of the largest. Its position is not used: an integrated
/// acceleration takes seconds to return to zero.
const REST: f64 = 0.1;
/// Fewest complete blocks of a rest between two parts of a record: a rest of 1.5 s always has as many, one of less than
/// 1 s never.
const REST_BLOCKS: usize = 2;

/// The parts of a record in which the pad moves, each with up to one block of the rest around it; the whole record
/// without a rest.
pub(super) fn parts(samples: &[f64], rate: f64, quantity: Quantity) -> Vec<Range<usize>> {
    let length = ((BLOCK * rate) as usize).min(samples.len()).max(1);
    let velocity = velocity(samples, rate, quantity);
    let swing = |block: &[f64]| {
        let [low, high] = [f64::min, f64::max].map(|of| block.iter().copied().reduce(of).unwrap_or(0.0));
        high - low
    };
    let least = REST * velocity.chunks(length).map(swing).fold(0.0, f64::max);
    let moving: Vec<usize> = (0..)
        .zip(velocity.chunks(length))
        .filter(|(_, own)| swing(own) > least)
        .map(|(at, _)| at)
        .collect();
    let parts = moving.chunk_by(|one, next| next - one <= REST_BLOCKS);
    let around = |part: &[usize]| {
        let (first, last) = (part[0], part[part.len() - 1]);
        first.saturating_sub(1) * length..((last + 2) * length).min(samples.len())
    };
    parts.map(around).collect()
}

/// The sweep of a pad; `None` if its motion is no sweep.
pub(super) fn swept(samples: &[f64], rate: f64, quantity: Quantity) -> Option<SweepParameters> {
    let mut halves = halves(samples, rate, quantity);
    let mut velocities: Vec<f64> = halves.iter().map(|half| half.velocity).collect();
    velocities.sort_by(f64::total_cmp);
    let usual = *velocities.get(velocities.len() / 2)?;
    // The ends of a sweep are faded.
    halves.retain(|half| (half.velocity / usual - 1.0).abs() < FULL);
    if halves.len() < LEAST {
        return None;
    }
    let laws = [Law::through(&halves, true), Law::through(&halves, false)];
    let law = laws
        .into_iter()
        .min_by(|a, b| a.error(&halves).total_cmp(&b.error(&halves)))?;
    let (first, last) = (&halves[0], &halves[halves.len() - 1]);
    let start = law.at(first.time - 0.25 / first.frequency);
    let end = law.at(last.time + 0.25 / last.frequency);
    (law.error(&halves) < STRAIGHT && start > 0.0 && end > RISE * start).then(|| SweepParameters {
        peak_velocity: rounded(usual),
        start: rounded(start),
        end: rounded(end),
        logarithmic: law.logarithmic,
    })
}

/// Growth of the frequency: linear or logarithmic in time.
struct Law {
    slope: f64,
    offset: f64,
    logarithmic: bool,
}

impl Law {
    /// Least-squares line; every second of the sweep has the same weight.
    fn through(halves: &[Half], logarithmic: bool) -> Law {
        let scaled = |half: &Half| {
            if logarithmic {
                half.frequency.ln()
            } else {
                half.frequency
            }
        };
        let mean = |of: &dyn Fn(&Half) -> f64| {
            let (sum, weights) = halves.iter().fold((0.0, 0.0), |(sum, weights), half| {
                (sum + of(half) / half.frequency, weights + 1.0 / half.frequency)
            });
            sum / weights
        };
        let (time, value) = (mean(&|half| half.time), mean(&scaled));
        let slope =
            mean(&|half| (half.time - time) * (scaled(half) - value)) / mean(&|half| (half.time - time).powi(2));
        Law {
            slope,
            offset: value - slope * time,
            logarithmic,
        }
    }

    fn at(&self, time: f64) -> f64 {
        let value = self.slope.mul_add(time, self.offset);
        if self.logarithmic { value.exp() } else { value }
    }

    /// RMS of the relative deviations.
    fn error(&self, halves: &[Half]) -> f64 {
        rms_or_nan(halves.iter().map(|half| half.frequency / self.at(half.time) - 1.0))
    }
}

/// The part between zeros of the velocity.
fn halves(samples: &[f64], rate: f64, quantity: Quantity) -> Vec<Half> {
    let velocity = velocity(samples, rate, quantity);
    let zeros = zeros(&velocity);
    let half = |two: &[f64]| {
        let inside = &velocity[two[0].ceil() as usize..=two[1].floor() as usize];
        Half {
            time: 0.5 * (two[0] + two[1]) / rate,
            frequency: 0.5 * rate / (two[1] - two[0]),
            velocity: inside.iter().fold(0.0, |most: f64, value| most.max(value.abs())),
        }
    };
    let whole = zeros.windows(2).filter(|two| two[0].ceil() <= two[1].floor());
    whole.map(half).collect()
}

/// Velocity of the pad, m/s; its amplitude is constant in a sweep. Frequencies below a tenth of a hertz are removed, so
/// that an offset of the sensor does not grow.
fn velocity(samples: &[f64], rate: f64, quantity: Quantity) -> Vec<f64> {
    let fading = 1.0 - SLOW / rate;
    let mut last = 0.0;
    let integrated = |sample: &f64| {
        last = last * fading + sample / rate;
        last
    };
    match quantity {
        Quantity::Acceleration => samples.iter().map(integrated).collect(),
        Quantity::Displacement => samples.windows(2).map(|two| (two[1] - two[0]) * rate).collect(),
        Quantity::Velocity | Quantity::Force => samples.to_vec(),
    }
}

/// Zero crossings between samples, from one swing to the next. Small swings are noise and are left out.
fn zeros(velocity: &[f64]) -> Vec<f64> {
    let square = velocity.iter().map(|value| value * value).sum::<f64>() / velocity.len().max(1) as f64;
    let swing = SWING * square.sqrt();
    let (mut zeros, mut zero, mut side) = (Vec::new(), 0.0, 0.0);
    for (at, two) in velocity.windows(2).enumerate() {
        if (two[0] < 0.0) != (two[1] < 0.0) {
            zero = at as f64 + two[0] / (two[0] - two[1]);
        }
        if two[1].abs() > swing && two[1].signum() != side {
            side = two[1].signum();
            zeros.push(zero);
        }
    }
    zeros
}

/// The nearest value with the fewest digits.
fn rounded(value: f64) -> f64 {
    let with = |digits: usize| format!("{value:.digits$e}").parse().unwrap_or(value);
    (0..3)
        .map(with)
        .find(|rounded: &f64| (rounded / value - 1.0).abs() < ROUNDING)
        .unwrap_or(value)
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use qcar_runtime::campaign::Quantity;

    use super::{parts, swept};

    /// Accelerations of a sweep of 25 mm/s from 0.5 to 30 Hz in 40 s.
    fn sweep(logarithmic: bool) -> Vec<f64> {
        let growth = 60f64.ln() / 40.0;
        let frequency = |t: f64| {
            if logarithmic {
                0.5 * (growth * t).exp()
            } else {
                0.5 + 29.5 * t / 40.0
            }
        };
        let cycles = |t: f64| {
            if logarithmic {
                0.5 * ((growth * t).exp() - 1.0) / growth
            } else {
                0.5 * t + 29.5 * t * t / 80.0
            }
        };
        let value = |t: f64| 0.025 * TAU * frequency(t) * (TAU * cycles(t)).cos();
        (0..40_000).map(|k| value(f64::from(k) / 1000.0)).collect()
    }

    #[test]
    fn what_a_sweep_does_is_found() {
        for logarithmic in [true, false] {
            let found = swept(&sweep(logarithmic), 1000.0, Quantity::Acceleration).unwrap();
            assert_eq!(found.logarithmic, logarithmic);
            assert_eq!(
                (found.start, found.end, found.peak_velocity),
                (0.5, 30.0, 0.025),
                "{found:?}"
            );
        }
    }

    #[test]
    fn sweeps_with_a_rest_between_are_parts() {
        let rest = |seconds: usize| (0..1000 * seconds).map(|k| 1e-3 * (k as f64).sin());
        let one = sweep(true);
        let loud: Vec<f64> = one.iter().map(|value| 4.0 * value).collect();
        let all: Vec<f64> = rest(3).chain(one).chain(rest(2)).chain(loud).chain(rest(1)).collect();
        let found = parts(&all, 1000.0, Quantity::Acceleration);
        let near = |at: usize, expected: usize| at.abs_diff(expected) <= 1000;
        assert_eq!(found.len(), 2, "{found:?}");
        assert!(near(found[0].start, 3000) && near(found[0].end, 43_000), "{found:?}");
        assert!(near(found[1].start, 45_000) && near(found[1].end, 85_000), "{found:?}");
        let levels: Vec<f64> = found
            .into_iter()
            .map(|part| swept(&all[part], 1000.0, Quantity::Acceleration).unwrap().peak_velocity)
            .collect();
        assert_eq!(levels, [0.025, 0.1]);
    }

    #[test]
    fn a_shorter_rest_is_no_end_of_a_sweep() {
        // Velocities of a sweep from 0.5 to 30 Hz in 40 s.
        let growth = 60f64.ln() / 40.0;
        let value = |t: f64| 0.025 * (TAU * 0.5 * ((growth * t).exp() - 1.0) / growth).sin();
        let one: Vec<f64> = (0..40_000).map(|k| value(f64::from(k) / 1000.0)).collect();
        let parts_with = |rest: usize, shift: usize| {
            let still = |samples: usize| std::iter::repeat_n(0.0, samples);
            let all: Vec<f64> = still(shift)
                .chain(one.clone())
                .chain(still(rest))
                .chain(one.clone())
                .collect();
            parts(&all, 1000.0, Quantity::Velocity).len()
        };
        for shift in [0, 100, 250, 499] {
            assert_eq!(
                (parts_with(900, shift), parts_with(1500, shift)),
                (1, 2),
                "{shift} samples before"
            );
        }
    }

    #[test]
    fn a_sine_and_a_square_are_no_sweep() {
        let sine: Vec<f64> = (0..10_000).map(|k| (TAU * 5.0 * f64::from(k) / 1000.0).sin()).collect();
        assert!(swept(&sine, 1000.0, Quantity::Acceleration).is_none());
        assert!(swept(&[1.0; 1000], 1000.0, Quantity::Acceleration).is_none());
    }
}
