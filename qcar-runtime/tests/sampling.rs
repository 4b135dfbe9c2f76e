//! The anti-alias filter by what it lets through and what it stops.

use std::f64::consts::TAU;

use qcar_runtime::simulate::AntiAlias;

/// The largest difference between the samples of a sine, `cycles` a sample on a fine grid, and `gain` times the sine.
fn worst(oversampling: usize, cycles: f64, gain: f64) -> f64 {
    let samples = 203;
    let sine = |sample: f64| (TAU * cycles * sample + 0.3).sin();
    let points = (samples - 1 + 2 * AntiAlias::REACH) * oversampling + 1;
    let fine: Vec<f64> = (0..points)
        .map(|point| sine(point as f64 / oversampling as f64 - AntiAlias::REACH as f64))
        .collect();
    let found = AntiAlias::new(oversampling).decimate(&fine);
    assert_eq!(found.len(), samples);
    let errors = found.iter().enumerate().map(|(k, y)| (y - gain * sine(k as f64)).abs());
    errors.fold(0.0, f64::max)
}

#[test]
fn what_is_slow_passes_without_delay_and_what_would_alias_is_stopped() {
    for oversampling in [AntiAlias::CONTINUOUS, 5, AntiAlias::JUMPING] {
        for cycles in [0.0, 0.01, 0.1, 0.25, 0.4] {
            let error = worst(oversampling, cycles, 1.0);
            assert!(error < 2e-4, "{oversampling} points: {cycles} is off by {error}");
        }
        for cycles in [0.6, 0.75, 0.9] {
            let rest = worst(oversampling, cycles, 0.0);
            assert!(rest < 2e-4, "{oversampling} points: {rest} of {cycles} is left");
        }
    }
}
