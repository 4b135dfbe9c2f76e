//! What a sine sweep does, from the signal of its pad.

use qcar_runtime::campaign::Quantity;

/// A sine whose frequency rises, at a velocity that stays.
#[derive(Clone, Copy, Debug)]
pub(super) struct Swept {
    /// m/s.
    pub peak_velocity: f64,
    /// Hz.
    pub start: f64,
    /// Hz.
    pub end: f64,
    pub logarithmic: bool,
}

/// Half periods that a sweep has at least.
const LEAST: usize = 20;
/// A sweep rises at least to so many times its first frequency.
const RISE: f64 = 2.0;
/// The largest relative deviation of its half periods from a line, or from one of logarithms, as a root mean square.
const STRAIGHT: f64 = 0.1;
/// A value is written with the fewest digits that change it by less than this share.
const ROUNDING: f64 = 0.03;

/// Part of the RMS value of the velocity that a swing has.
const SWING: f64 = 0.5;
/// What fades out of an integral, 1/s: a tenth of a hertz.
const SLOW: f64 = 0.6;

/// A half period: its middle (s), its frequency (Hz) and the peak of the velocity in it (m/s).
struct Half {
    time: f64,
    frequency: f64,
    velocity: f64,
}

/// What the samples of a pad sweep over, if they do.
pub(super) fn swept(samples: &[f64], rate: f64, quantity: Quantity) -> Option<Swept> {
    let halves = halves(samples, rate, quantity);
    if halves.len() < LEAST {
        return None;
    }
    let of = |scale: fn(f64) -> f64| {
        let points: Vec<(f64, f64)> = halves.iter().map(|half| (half.time, scale(half.frequency))).collect();
        line(&points)
    };
    let (first, last) = (&halves[0], &halves[halves.len() - 1]);
    let (start_time, end_time) = (first.time - 0.25 / first.frequency, last.time + 0.25 / last.frequency);
    let (logarithmic, linear) = (of(f64::ln), of(|frequency| frequency));
    let errors = [(logarithmic, true), (linear, false)].map(|(line, logarithmic)| {
        let at = |time: f64| {
            if logarithmic {
                line.0.mul_add(time, line.1).exp()
            } else {
                line.0.mul_add(time, line.1)
            }
        };
        let error: f64 = halves
            .iter()
            .map(|half| (half.frequency / at(half.time) - 1.0).powi(2))
            .sum();
        (
            (error / halves.len() as f64).sqrt(),
            at(start_time),
            at(end_time),
            logarithmic,
        )
    });
    let (error, start, end, logarithmic) = if errors[0].0 <= errors[1].0 {
        errors[0]
    } else {
        errors[1]
    };
    let mut velocities: Vec<f64> = halves.iter().map(|half| half.velocity).collect();
    velocities.sort_by(f64::total_cmp);
    (error < STRAIGHT && start > 0.0 && end > RISE * start).then(|| Swept {
        peak_velocity: rounded(velocities[velocities.len() / 2]),
        start: rounded(start),
        end: rounded(end),
        logarithmic,
    })
}

/// What lies between zeros of the velocity.
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

/// The velocity of the pad, m/s, whose amplitude stays in a sweep. What is slower than a tenth of a hertz is left out of it, so that
/// an offset of the sensor does not run away.
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

/// Places between samples where the signal goes through zero, from one swing to the next. What is small is noise and no swing.
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

/// Slope and offset of the line that least squares give.
fn line(points: &[(f64, f64)]) -> (f64, f64) {
    let count = points.len() as f64;
    let (x, y) = points
        .iter()
        .fold((0.0, 0.0), |(x, y), point| (x + point.0 / count, y + point.1 / count));
    let (above, below) = points.iter().fold((0.0, 0.0), |(above, below), point| {
        (above + (point.0 - x) * (point.1 - y), below + (point.0 - x).powi(2))
    });
    (above / below, y - above / below * x)
}

/// The nearest value of the fewest digits.
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

    use super::swept;

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
    fn a_sine_and_a_square_are_no_sweep() {
        let sine: Vec<f64> = (0..10_000).map(|k| (TAU * 5.0 * f64::from(k) / 1000.0).sin()).collect();
        assert!(swept(&sine, 1000.0, Quantity::Acceleration).is_none());
        assert!(swept(&[1.0; 1000], 1000.0, Quantity::Acceleration).is_none());
    }
}
