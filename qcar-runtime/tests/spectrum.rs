//! Spectra against closed forms.

use std::f64::consts::TAU;

use qcar_runtime::spectrum::{Segments, Trend, Window, transform, transforms, welch};

fn sine(n: usize, cycles: f64) -> Vec<f64> {
    (0..n).map(|k| (TAU * cycles * k as f64 / n as f64).sin()).collect()
}

/// White noise of unit variance: uniform deviates from a multiplicative generator.
fn white(n: usize) -> Vec<f64> {
    let mut state = 12_345_678_901_u64;
    let mut next = || {
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        ((state >> 11) as f64 / (1u64 << 53) as f64 - 0.5) * 12f64.sqrt()
    };
    (0..n).map(|_| next()).collect()
}

const HALF: Segments = Segments {
    length: 200,
    overlap: 100,
    window: Window::Hann,
    trend: Trend::Constant,
};

#[test]
fn a_whole_number_of_cycles_is_one_line() {
    for n in [100, 101, 97] {
        let lines = transform(&sine(n, 7.0));
        assert_eq!(lines.len(), n / 2 + 1);
        for (k, line) in lines.iter().enumerate() {
            let expected = if k == 7 { n as f64 / 2.0 } else { 0.0 };
            assert!((line.norm() - expected).abs() < 1e-9, "{n}: line {k}");
        }
    }
}

#[test]
fn the_density_of_white_noise_is_its_variance_over_the_rate() {
    let spectra = welch(&[&white(200_000)], 50.0, &HALF);
    let inside = &spectra.density[3..97];
    let mean = inside.iter().map(|density| density[(0, 0)].re).sum::<f64>() / inside.len() as f64;
    assert!((mean * 50.0 - 1.0).abs() < 0.01, "{mean}");
    assert_eq!(spectra.frequency[10], 2.5);
}

#[test]
fn cross_spectra_carry_gain_and_sign() {
    let x = white(20_000);
    let y: Vec<f64> = x.iter().map(|x| -3.0 * x).collect();
    let spectra = welch(&[&x, &y], 50.0, &HALF);
    for density in &spectra.density[1..] {
        assert!((density[(1, 0)] / density[(0, 0)] + 3.0).norm() < 1e-12);
        assert!((density[(0, 1)] - density[(1, 0)].conj()).norm() < 1e-18);
    }
}

#[test]
fn overlapping_hann_segments_count_by_the_closed_form() {
    let spectra = welch(&[&white(100_100)], 50.0, &HALF);
    let count = 1000.0;
    let expected = count / (1.0 + 2.0 * (1.0 - 1.0 / count) / 36.0);
    assert!(
        (spectra.averages - expected).abs() < 1e-6 * expected,
        "neighbours correlate by 1/6: {}",
        spectra.averages
    );
    let apart = welch(&[&white(1000)], 50.0, &Segments { overlap: 0, ..HALF });
    assert_eq!(apart.averages, 5.0);
}

#[test]
fn trends_are_taken_off() {
    let line: Vec<f64> = (0..11).map(|k| 4.0 + 0.5 * f64::from(k)).collect();
    let mut flat = line.clone();
    Trend::Linear.remove(&mut flat);
    assert!(flat.iter().all(|y| y.abs() < 1e-12));
    let mut centred = line.clone();
    Trend::Constant.remove(&mut centred);
    assert_eq!((centred[0], centred[10]), (-2.5, 2.5));
    let mut kept = line.clone();
    Trend::Kept.remove(&mut kept);
    assert_eq!(kept, line);
}

#[test]
fn records_that_are_transformed_together_have_the_lines_that_they_have_alone() {
    for n in [96, 97, 1001] {
        let noise = white(n);
        // Of different sizes, and one that is zero.
        let records =
            [1.0, 1e-9, 0.0, 1e6, -3.0].map(|scale| noise.iter().map(|x| scale * (x + x * x)).collect::<Vec<_>>());
        let together = transforms(&records);
        assert_eq!(together.len(), records.len());
        for (lines, record) in together.iter().zip(&records) {
            let alone = transform(record);
            let largest = alone.iter().map(|line| line.norm()).fold(0.0, f64::max);
            assert_eq!(lines.len(), alone.len());
            for (own, expected) in lines.iter().zip(alone) {
                assert!((own - expected).norm() <= 1e-14 * largest, "{n}: {own} {expected}");
            }
        }
    }
}
