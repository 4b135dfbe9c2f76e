//! The resampling filter against sines, whose values at any instant are known.

use std::f64::consts::TAU;

use qcar_signals::resample::{Grid, PASS, RIPPLE, STOP, reach, resample};

const SECONDS: f64 = 4.0;

fn grid(start: f64, rate: f64) -> Grid {
    Grid {
        start,
        rate,
        count: ((SECONDS - start) * rate) as usize,
    }
}

/// Largest deviation from `expected` of a sine that was resampled, away from the ends of the record.
fn worst(frequency: f64, from: Grid, to: Grid, expected: impl Fn(f64) -> f64) -> f64 {
    let sine = |t: f64| (TAU * frequency * t + 0.3).sin();
    let samples: Vec<f64> = (0..from.count).map(|k| sine(from.time(k))).collect();
    let inner = reach(from.rate, to.rate);
    let resampled = resample(&samples, from, to).into_iter().enumerate();
    let deviations = resampled.filter_map(|(k, value)| {
        let t = to.time(k);
        (from.start + inner < t && t < from.end() - inner).then(|| (value - expected(t)).abs())
    });
    deviations.fold(0.0, f64::max)
}

/// Down by a whole number, down by a fraction, up, and to instants between samples at the same rate.
const PAIRS: [(f64, f64); 5] = [
    (5000.0, 1000.0),
    (2048.0, 1000.0),
    (1000.0, 400.0),
    (250.0, 1000.0),
    (1000.0, 1000.0),
];

/// The table of the kernel and the sum of its weights, which a constant needs, cost as much again as the ripple.
const ALLOWED: f64 = 2.0 * RIPPLE;

#[test]
fn sines_in_the_pass_band_are_reproduced_without_delay() {
    for (from, to) in PAIRS {
        let (from, to) = (grid(0.0, from), grid(0.1003, to));
        for share in [0.0001, 0.01, 0.1, 0.25, 0.39, PASS] {
            let frequency = share * from.rate.min(to.rate);
            let worst = worst(frequency, from, to, |t| (TAU * frequency * t + 0.3).sin());
            assert!(
                worst < ALLOWED,
                "{frequency} Hz from {} to {} Hz: {worst}",
                from.rate,
                to.rate
            );
        }
    }
}

#[test]
fn sines_in_the_stop_band_vanish() {
    for (from, to) in PAIRS.into_iter().filter(|(from, to)| to < from) {
        let (from, to) = (grid(0.0, from), grid(0.1, to));
        for share in [STOP, 0.6, 0.9, 1.0, 1.1] {
            let frequency = share * to.rate;
            // Above half its own rate a sine is another one.
            if frequency < 0.5 * from.rate {
                let worst = worst(frequency, from, to, |_| 0.0);
                assert!(
                    worst < ALLOWED,
                    "{frequency} Hz from {} to {} Hz: {worst}",
                    from.rate,
                    to.rate
                );
            }
        }
    }
}

#[test]
fn a_constant_is_preserved_up_to_the_ends() {
    for (from, to) in PAIRS {
        let (from, to) = (grid(0.0, from), grid(0.0003, to));
        let resampled = resample(&vec![9.81; from.count], from, to);
        assert!(resampled.iter().all(|value| (value - 9.81).abs() < 1e-12));
    }
}

#[test]
fn a_line_is_preserved_up_to_the_ends() {
    let (from, to) = (grid(0.0, 1000.0), grid(0.0, 200.0));
    let samples: Vec<f64> = (0..from.count).map(|k| 3.0 * from.time(k) - 1.0).collect();
    let resampled = resample(&samples, from, to);
    let worst = (0..to.count).map(|k| (resampled[k] - (3.0 * to.time(k) - 1.0)).abs());
    assert!(worst.fold(0.0, f64::max) < 1e-6);
}

#[test]
fn records_shorter_than_the_filter_are_resampled() {
    let short = Grid {
        start: 0.0,
        rate: 1000.0,
        count: 3,
    };
    let to = Grid {
        start: 0.0,
        rate: 100.0,
        count: 1,
    };
    let resampled = resample(&[1.0, 1.0, 1.0], short, to);
    assert!((resampled[0] - 1.0).abs() < 1e-12, "{resampled:?}");
}
