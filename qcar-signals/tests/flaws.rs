//! Flaws that are put into signals are found where they are, and sound signals have none.

use std::f64::consts::TAU;

use qcar_signals::health::{Flaw, FlawKind, flaws};

const RATE: f64 = 1000.0;

/// A sine sweep of constant velocity from 0.5 to 30 Hz in 40 s, as an acceleration.
fn sweep() -> Vec<f64> {
    let growth = 60f64.ln() / 40.0;
    let phase = |t: f64| TAU * 0.5 * ((growth * t).exp() - 1.0) / growth;
    let value = |t: f64| 0.025 * TAU * 0.5 * (growth * t).exp() * phase(t).cos();
    (0..40_000).map(|k| value(f64::from(k) / RATE)).collect()
}

/// Even noise in ±1, by a linear congruence.
fn noise(count: usize) -> Vec<f64> {
    let mut state = 12345u64;
    let mut next = || {
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    };
    (0..count).map(|_| next()).collect()
}

fn rounded(samples: &[f64], step: f64) -> Vec<f64> {
    samples.iter().map(|value| (value / step).round() * step).collect()
}

fn only(found: &[Flaw]) -> &Flaw {
    assert_eq!(found.len(), 1, "{found:?}");
    &found[0]
}

#[test]
fn signals_without_flaws_are_not_reported() {
    let slow: Vec<f64> = (0..20_000).map(|k| (TAU * 0.2 * f64::from(k) / RATE).sin()).collect();
    let impact: Vec<f64> = (0..4000)
        .map(|k| f64::from(k - 1000) / RATE)
        .map(|t| {
            if t < 0.0 {
                0.0
            } else {
                (-8.0 * t).exp() * (TAU * 14.0 * t).sin()
            }
        })
        .collect();
    let valve: Vec<f64> = (0..4000).map(|k| if k / 500 % 2 == 0 { 0.0 } else { 1.0 }).collect();
    // The wheel on a cleat, from its first to its second impact.
    let rough = [
        0.4, 1.1, 3.0, 8.2, 23.6, 22.3, 20.3, 18.8, 13.1, 20.0, 10.0, 14.8, 8.1, 4.6, 2.0, -5.3, -11.4, -6.0, -2.0,
        -0.7,
    ];
    let rest = |count: usize| (0..count).map(|k| 0.2 * (0.05 * k as f64).sin());
    let cleat: Vec<f64> = rest(400).chain(rough).chain(rest(800)).collect();
    for signal in [sweep(), slow, impact, valve, cleat, noise(20_000)] {
        for step in [0.0, 1e-4, 1e-3, 1e-2] {
            let given = if step > 0.0 {
                rounded(&signal, step)
            } else {
                signal.clone()
            };
            assert_eq!(flaws(&given, true), [], "rounded to {step}");
        }
    }
}

#[test]
fn a_constant_channel_is_dead() {
    assert_eq!(only(&flaws(&[0.25; 500], false)).kind, FlawKind::Dead(0.25));
}

#[test]
fn a_signal_that_was_cut_off_is_clipped() {
    let whole = sweep();
    for step in [0.0, 1e-4, 1e-3] {
        let cut: Vec<f64> = whole.iter().map(|value| value.min(3.0)).collect();
        let given = if step > 0.0 { rounded(&cut, step) } else { cut };
        let found = flaws(&given, true);
        let flaw = only(&found);
        assert!(
            matches!(flaw.kind, FlawKind::Clipped(at) if (at - 3.0).abs() < 1e-9),
            "{flaw:?}"
        );
        let first = whole
            .windows(4)
            .position(|four| four.iter().all(|value| *value > 3.0))
            .unwrap();
        assert!(flaw.samples.0.abs_diff(first) < 50, "{flaw:?}, first at {first}");
    }
}

#[test]
fn a_single_outlier_is_a_spike() {
    let mut signal = sweep();
    signal[15_000] += 4.0;
    signal[30_000] -= 6.0;
    let found = flaws(&signal, true);
    let flaw = only(&found);
    assert!(
        matches!(flaw.kind, FlawKind::Spike(_)) && flaw.samples == (30_000, 30_000) && flaw.count == 2,
        "{flaw:?}"
    );
}

#[test]
fn a_moving_mean_is_a_drift() {
    let mut signal: Vec<f64> = noise(20_000);
    let count = signal.len() as f64;
    signal
        .iter_mut()
        .enumerate()
        .for_each(|(k, value)| *value += k as f64 / count);
    let found = flaws(&signal, true);
    assert!(
        matches!(only(&found).kind, FlawKind::Drift(drift) if (drift - 1.0).abs() < 0.1),
        "{found:?}"
    );
    assert_eq!(flaws(&signal, false), []);
}
