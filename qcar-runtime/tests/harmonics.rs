//! A swept sine through a curved characteristic and through a resonator, whose harmonics are known in closed form.

use nalgebra::Complex;
use qcar_runtime::transmissibility::harmonics::{Neighbourhood, Swept};
use std::f64::consts::TAU;

const RATE: f64 = 400.0;
const BAND: (f64, f64) = (0.5, 30.0);
const SECONDS: f64 = 42.0;
const AROUND: Neighbourhood = Neighbourhood {
    lines: 10,
    width: 0.035,
};

/// A logarithmic sweep of amplitude 1, faded in and out.
fn sweep() -> Vec<f64> {
    let growth = (BAND.1 / BAND.0).ln() / SECONDS;
    let fade = |t: f64| (t.min(SECONDS - t) / 0.5).clamp(0.0, 1.0);
    let sample = |k: usize| {
        let t = k as f64 / RATE - 0.5;
        if (0.0..SECONDS).contains(&t) {
            fade(t) * (TAU * BAND.0 * ((growth * t).exp() - 1.0) / growth).cos()
        } else {
            0.0
        }
    };
    (0..((SECONDS + 1.0) * RATE) as usize).map(sample).collect()
}

/// `cos² φ = (1 + cos 2φ)/2` and `cos³ φ = (3 cos φ + cos 3φ)/4`.
#[test]
fn a_polynomial_shows_the_harmonics_of_its_powers() {
    let excitation = sweep();
    let response: Vec<f64> = excitation
        .iter()
        .map(|x| 2.0 * x + 0.1 * x * x - 0.2 * x.powi(3))
        .collect();
    let swept = Swept::new(&excitation, RATE, BAND, 3);
    for line in swept.responses(&response, &[4.0, 9.0, 16.0, 25.0], AROUND) {
        let expected = [2.0 - 0.75 * 0.2, 0.5 * 0.1, -0.25 * 0.2];
        for (value, expected) in line.value.iter().zip(expected) {
            let error = (value.expect("the sweep passes there") - Complex::from(expected)).norm();
            // 0.2 % of the first harmonic: what is allowed to the estimator everywhere.
            assert!(error < 2e-3 * 1.85, "{} Hz: {value:?}, not {expected}", line.frequency);
        }
    }
}

/// The first harmonic of a linear system is its frequency response, though the sweep passes its mode in a second.
#[test]
fn a_resonator_shows_its_response_and_no_harmonics() {
    let (omega, damping) = (TAU * 1.3, 0.1);
    let excitation = sweep();
    let (mut x, mut v, mut response) = (0.0, 0.0, Vec::new());
    let h = 0.1 / RATE;
    for pair in excitation.windows(2) {
        response.push(x);
        for k in 0..10 {
            // Midpoint rule in small steps.
            let u = pair[0] + (pair[1] - pair[0]) * (k as f64 + 0.5) / 10.0;
            let a = |x: f64, v: f64| omega * omega * (u - x) - 2.0 * damping * omega * v;
            let (xm, vm) = (x + 0.5 * h * v, v + 0.5 * h * a(x, v));
            (x, v) = (x + h * vm, v + h * a(xm, vm));
        }
    }
    response.push(x);
    let swept = Swept::new(&excitation, RATE, BAND, 3);
    for line in swept.responses(&response, &[0.9, 1.2, 1.3, 1.4, 2.0, 4.0], AROUND) {
        let s = Complex::new(0.0, TAU * line.frequency);
        let expected = omega * omega / (s * s + 2.0 * damping * omega * s + omega * omega);
        let first = line.value[0].expect("the sweep passes there");
        assert!(
            (first / expected - 1.0).norm() < 6e-3,
            "{} Hz: {first}, not {expected}",
            line.frequency
        );
        for higher in line.value[1..].iter().flatten() {
            assert!(
                higher.norm() < 5e-3 * expected.norm(),
                "{} Hz: {higher}",
                line.frequency
            );
        }
    }
}

#[test]
fn the_amplitude_is_that_of_the_sweep_and_there_is_none_beyond() {
    let swept = Swept::new(&sweep(), RATE, BAND, 1);
    for f in [0.8, 3.0, 20.0] {
        let passage = swept.passage(f).expect("the sweep passes there");
        assert!((passage.amplitude - 1.0).abs() < 0.02);
        // Half a second of silence comes before the sweep.
        let time = 0.5 + SECONDS * (f / BAND.0).ln() / (BAND.1 / BAND.0).ln();
        assert!(
            (passage.time - time).abs() < 0.1,
            "{f} Hz at {} s, not {time}",
            passage.time
        );
    }
    assert_eq!(swept.passage(60.0), None);
}
