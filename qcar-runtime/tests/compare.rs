//! The comparison's metrics on records whose answers are known, and the weightings against the standard's tables.

use qcar_runtime::compare::{
    Alignment, CompareError, Errors, Histogram, Summary, Weighting, Windows, rms, vibration_dose,
};
use std::f64::consts::TAU;

const RATE: f64 = 1000.0;

/// A decaying oscillation from `onset` (s) on.
fn shake(onset: f64, size: f64, frequency: f64, decay: f64) -> Vec<f64> {
    let after = |t: f64| {
        if t < 0.0 {
            0.0
        } else {
            size * (TAU * frequency * t).sin() * (-t / decay).exp()
        }
    };
    (0..1500).map(|i| after(f64::from(i) / RATE - onset)).collect()
}

#[test]
fn a_delayed_copy_has_no_error() {
    let (wheel, late_wheel) = (shake(0.2, 50.0, 15.0, 0.05), shake(0.237, 55.0, 15.0, 0.05));
    let alignment = Alignment::at_peak(&wheel, &late_wheel).unwrap();
    assert_eq!(alignment.delay, 37);
    assert!((200..=203).contains(&alignment.onset));
    let (body, late_body) = (shake(0.21, 5.0, 1.5, 0.4), shake(0.247, 5.0, 1.5, 0.4));
    let errors = Errors::between(&body, &late_body, &alignment, RATE, &Windows::default()).unwrap();
    assert!(
        errors.peak().abs() < 1e-12 && errors.after_shake().abs() < 1e-12,
        "{errors:?}"
    );
}

/// An obstacle throws the wheel up at either end: a simulation whose second peak is the higher one is not taken to be
/// late.
#[test]
fn of_two_peaks_those_that_are_the_same_are_aligned() {
    let two = |heights: [f64; 2], onset: f64| -> Vec<f64> {
        let early = shake(onset, heights[0], 20.0, 0.02);
        let late = shake(onset + 0.06, heights[1], 20.0, 0.02);
        early.iter().zip(late).map(|(early, late)| early + late).collect()
    };
    for heights in [[50.0, 40.0], [40.0, 50.0]] {
        let alignment = Alignment::at_peak(&two([50.0, 40.0], 0.2), &two(heights, 0.21)).unwrap();
        assert_eq!(alignment.delay, 10, "{heights:?}");
    }
}

#[test]
fn errors_have_their_size_sign_and_window() {
    let wheel = shake(0.2, 50.0, 15.0, 0.05);
    let alignment = Alignment::at_peak(&wheel, &wheel).unwrap();
    let body = shake(0.2, 4.0, 5.0, 0.3);
    let mut simulated: Vec<f64> = body.iter().map(|a| 1.1 * a).collect();
    simulated[alignment.onset + 100..]
        .iter_mut()
        .for_each(|a| *a *= 0.8 / 1.1);
    let errors = Errors::between(&body, &simulated, &alignment, RATE, &Windows::default()).unwrap();
    assert!(
        (errors.peak() - 0.1).abs() < 1e-12 && (errors.after_shake() + 0.2).abs() < 1e-12,
        "{errors:?}"
    );
}

#[test]
fn noise_before_the_onset_is_not_taken_for_after_shake() {
    let wheel = shake(0.3, 50.0, 15.0, 0.05);
    let alignment = Alignment::at_peak(&wheel, &wheel).unwrap();
    let body = shake(0.3, 1.0, 3.0, 0.3);
    let noise = |i: usize| 0.2 * if (i * i / 7).is_multiple_of(2) { 1.0 } else { -1.0 };
    let measured: Vec<f64> = body.iter().enumerate().map(|(i, a)| a + noise(i)).collect();
    let errors = Errors::between(&measured, &body, &alignment, RATE, &Windows::default()).unwrap();
    assert!(errors.after_shake().abs() < 0.05, "{errors:?}");
}

#[test]
fn records_without_an_impact_are_refused() {
    let wheel = shake(0.2, 50.0, 15.0, 0.05);
    assert_eq!(
        Alignment::at_peak(&[0.0; 9], &wheel),
        Err(CompareError::NoPeak { record: "measurement" })
    );
    assert_eq!(
        Alignment::at_peak(&wheel, &[]),
        Err(CompareError::NoPeak { record: "simulation" })
    );
    let alignment = Alignment::at_peak(&wheel, &wheel).unwrap();
    let short = Errors::between(&wheel, &wheel[..250], &alignment, RATE, &Windows::default());
    assert!(
        matches!(
            short,
            Err(CompareError::TooShort {
                record: "simulation",
                samples: 250,
                ..
            })
        ),
        "{short:?}"
    );
}

#[test]
fn histograms_and_summaries_count_every_run() {
    let errors = [-0.07, -0.02, 0.01, 0.03, 0.12, f64::NAN];
    let histogram = Histogram::new(&errors, 0.05);
    assert_eq!(
        (histogram.start, histogram.counts.as_slice()),
        (-0.1, [1, 1, 2, 0, 1].as_slice())
    );
    let summary = Summary::of(&errors).unwrap();
    assert_eq!((summary.median, summary.worst), (0.03, 0.12));
    assert_eq!(Summary::of(&[f64::NAN]), None);
    assert_eq!(Histogram::new(&[], 0.05).counts, Vec::<usize>::new());
}

/// Weighting of a long sine, without its start.
fn gain(weighting: Weighting, frequency: f64, rate: f64) -> f64 {
    let samples = (rate * (20.0 + 20.0 / frequency)) as usize;
    let sine: Vec<f64> = (0..samples)
        .map(|i| (TAU * frequency * i as f64 / rate).sin())
        .collect();
    let weighted = weighting.apply(&sine, rate);
    let whole_periods = ((10.0 * frequency).floor() / frequency * rate) as usize;
    rms(&weighted[samples - whole_periods..]) * 2.0_f64.sqrt()
}

#[test]
fn the_weightings_meet_the_tables_of_the_standard() {
    // ISO 2631-1, table 3: weighting factors in thousandths at nominal one-third-octave frequencies.
    let vertical = [
        (0.5, 418.0),
        (1.0, 482.0),
        (1.6, 494.0),
        (2.0, 531.0),
        (2.5, 631.0),
        (3.15, 804.0),
        (4.0, 967.0),
        (5.0, 1039.0),
        (6.3, 1054.0),
        (8.0, 1036.0),
        (10.0, 988.0),
        (16.0, 768.0),
        (25.0, 513.0),
        (40.0, 314.0),
        (63.0, 186.0),
        (80.0, 132.0),
    ];
    let horizontal = [
        (0.5, 853.0),
        (1.0, 1011.0),
        (1.6, 968.0),
        (2.5, 776.0),
        (4.0, 512.0),
        (8.0, 253.0),
        (16.0, 125.0),
        (31.5, 63.2),
        (63.0, 29.5),
        (80.0, 21.1),
    ];
    for (weighting, table) in [(Weighting::Wk, &vertical[..]), (Weighting::Wd, &horizontal[..])] {
        for &(frequency, thousandths) in table {
            // The standard allows 1 dB; only near half the sample rate do digital filters need it.
            for (rate, tolerance) in [(1000.0, 0.35), (500.0, 1.0)] {
                let decibels = 20.0 * (1000.0 * gain(weighting, frequency, rate) / thousandths).log10();
                assert!(
                    decibels.abs() < tolerance,
                    "{weighting:?} at {frequency} Hz, sampled at {rate} Hz: {decibels} dB"
                );
            }
        }
    }
}

#[test]
fn the_dose_of_a_constant_grows_with_the_fourth_root_of_time() {
    assert!((vibration_dose(&[2.0; 1000], 1000.0) - 2.0).abs() < 1e-12);
    assert!((vibration_dose(&[2.0; 16000], 1000.0) - 4.0).abs() < 1e-12);
}

/// More records than are weighted in step; each has the dose that it has alone, but for rounding.
#[test]
fn doses_of_several_records_are_those_of_each() {
    let record = |phase: f64| -> Vec<f64> {
        let sample = |k: usize| (0.05 * k as f64 + phase).sin() * (1.0 + phase) + f64::from(u8::from(k == 700));
        (0..1500).map(sample).collect()
    };
    let records: Vec<Vec<f64>> = (0..11).map(|k| record(f64::from(k))).collect();
    let slices: Vec<&[f64]> = records.iter().map(Vec::as_slice).collect();
    for weighting in [Weighting::Wk, Weighting::Wd] {
        let together = weighting.doses(&slices, 1000.0);
        assert_eq!(together.len(), records.len());
        for (record, dose) in records.iter().zip(together) {
            let alone = vibration_dose(&weighting.apply(record, 1000.0), 1000.0);
            assert!((dose / alone - 1.0).abs() < 1e-12, "{dose}, {alone}");
        }
    }
}
