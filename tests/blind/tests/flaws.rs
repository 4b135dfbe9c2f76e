//! Each flaw of the hardware shows in the records by the amount that was asked for.

use std::f64::consts::TAU;

use qcar_blind::Order;
use qcar_blind::hardware::{Flaw, Hardware};
use qcar_blind::programme::Programme;

use super::support::{Record, records, rms};

const SEED: u64 = 77;
const RATE: f64 = 1000.0;
/// Silence before a sweep, s.
const RUN_IN: f64 = 0.5;
const NOISE: f64 = 0.02;

fn hardware(flaw: Flaw) -> Hardware {
    Hardware::new(SEED, vec![flaw])
}

/// A campaign with one flaw, and the same without.
fn with_and_without(flaw: Flaw, programme: &Programme, file: &str) -> (Record, Record) {
    let order = |flaws| Order {
        noise: NOISE,
        programme: programme.clone(),
        flaws,
        ..Order::clean("c", SEED)
    };
    let [with] = records(&order(vec![flaw]), [file]);
    let [without] = records(&order(Vec::new()), [file]);
    (with, without)
}

const SECONDS: f64 = 12.0;
const SWEEP: &str = "rig/sweep_100.csv.gz";

/// A short sweep.
fn swept(flaw: Flaw) -> (Record, Record) {
    let mut programme = Programme::one_sweep(100);
    programme.sweeps[0].seconds = SECONDS;
    with_and_without(flaw, &programme, SWEEP)
}

/// Two drives, of which one is read.
fn driven(flaw: Flaw, file: &str) -> (Record, Record) {
    let mut programme = Programme::cleats_alone();
    programme.cleats.truncate(2);
    with_and_without(flaw, &programme, file)
}

fn difference(with: &[f64], without: &[f64]) -> Vec<f64> {
    with.iter().zip(without).map(|(a, b)| a - b).collect()
}

/// When a sweep is at a frequency, in samples.
fn sample(hertz: f64) -> usize {
    let growth = (30.0_f64 / 0.5).ln() / SECONDS;
    ((RUN_IN + (hertz / 0.5).ln() / growth) * RATE) as usize
}

/// RMS of a record where the sweep passes a band.
fn in_band(record: &[f64], from: f64, to: f64) -> f64 {
    rms(&record[sample(from)..sample(to)])
}

/// Amplitude of a harmonic of a sweep about a frequency: projection on its own phase over ten periods of the first.
fn harmonic(record: &[f64], hertz: f64, n: f64) -> f64 {
    let growth = (30.0_f64 / 0.5).ln() / SECONDS;
    let phase = |i: usize| TAU * 0.5 * ((growth * (i as f64 / RATE - RUN_IN)).exp() - 1.0) / growth;
    let middle = phase(sample(hertz));
    let (mut c, mut s, mut weight) = (0.0, 0.0, 0.0);
    for (i, value) in record.iter().enumerate() {
        let along = (phase(i) - middle) / (5.0 * TAU);
        if along.abs() < 1.0 {
            let window = (phase(i + 1) - phase(i)) * (0.5 + 0.5 * (std::f64::consts::PI * along).cos());
            c += window * value * (n * phase(i)).cos();
            s += window * value * (n * phase(i)).sin();
            weight += window / 2.0;
        }
    }
    c.hypot(s) / weight
}

#[test]
fn the_body_bends_at_its_own_frequency() {
    let mode = hardware(Flaw::FlexibleBody).flexible().expect("it was asked for");
    let hertz = mode.omega / TAU;
    assert!((20.0..=28.0).contains(&hertz) && (0.015..=0.035).contains(&mode.mass_share));
    let (with, without) = swept(Flaw::FlexibleBody);
    let change = |from: f64, to: f64| {
        let change = difference(&with["body_left_z"], &without["body_left_z"]);
        in_band(&change, from, to) / in_band(&without["body_left_z"], from, to)
    };
    assert!(change(1.0, 4.0) < 0.01, "{}", change(1.0, 4.0));
    let near = change(0.95 * hertz, 1.05 * hertz);
    assert!((0.1..1.0).contains(&near), "{near}");
    assert!(near > 3.0 * change(8.0, 12.0), "{near} beside {}", change(8.0, 12.0));
}

#[test]
fn the_pad_resonates_and_distorts() {
    let pad = hardware(Flaw::Pad).pad().expect("it was asked for");
    let (with, without) = swept(Flaw::Pad);
    let (with, without) = (&with["pad_left_z"], &without["pad_left_z"]);
    for hertz in [4.0, 12.0, 25.0] {
        let (gain, _) = pad.response(TAU * hertz);
        let first = harmonic(with, hertz, 1.0);
        let found = first / harmonic(without, hertz, 1.0);
        assert!(
            (found / gain - 1.0).abs() < 0.01,
            "{found} at {hertz} Hz, {gain} expected"
        );
        for (n, (share, _)) in [2.0, 3.0].into_iter().zip(pad.harmonics) {
            let found = harmonic(with, hertz, n) / first;
            assert!(
                (found / share - 1.0).abs() < 0.25,
                "{found} of harmonic {n}, {share} expected"
            );
        }
    }
    assert!(pad.response(TAU * 25.0).0 > 1.05);
}

#[test]
fn an_accelerometer_sees_the_other_axis() {
    let (with, without) = driven(Flaw::CrossAxis, "cleat/v30_h10.csv");
    for (name, other) in [("wheel_left_z", "wheel_left_x"), ("wheel_left_x", "wheel_left_z")] {
        let change = difference(&with[name], &without[name]);
        let across = &without[other];
        let product: f64 = change.iter().zip(across).map(|(a, b)| a * b).sum();
        let found = product / across.iter().map(|b| b * b).sum::<f64>();
        let asked = hardware(Flaw::CrossAxis).cross_axis(name);
        assert!((0.02..=0.03).contains(&asked.abs()));
        assert!((found / asked - 1.0).abs() < 0.1, "{name}: {found}, {asked} expected");
    }
}

#[test]
fn a_gain_is_a_curve_of_two_percent() {
    let (with, without) = swept(Flaw::Calibration);
    let ratio = |hertz: f64| harmonic(&with["pad_left_z"], hertz, 1.0) / harmonic(&without["pad_left_z"], hertz, 1.0);
    let ratios: Vec<f64> = (0..30).map(|k| ratio(0.8 * 1.125_f64.powi(k))).collect();
    let (low, high) = ratios
        .iter()
        .fold((2.0_f64, 0.0_f64), |(l, h), &r| (l.min(r), h.max(r)));
    assert!(
        (0.978..1.0).contains(&low) && (1.0..1.022).contains(&high),
        "{low} to {high}"
    );
    assert!(high - low > 0.025, "{low} to {high}");
}

#[test]
fn damping_falls_over_a_run() {
    let heat = hardware(Flaw::Heat).heat().expect("it was asked for");
    assert!((0.02..=0.04).contains(&heat.loss));
    assert!((heat.left(0.0) - 1.0).abs() < 1e-12 && (heat.left(1.0) - 1.0 + heat.loss).abs() < 1e-12);
    let (with, without) = swept(Flaw::Heat);
    let change = |from: f64, to: f64| {
        let change = difference(&with["body_left_z"], &without["body_left_z"]);
        in_band(&change, from, to) / in_band(&without["body_left_z"], from, to)
    };
    assert!(change(0.6, 0.8) < 0.01, "{}", change(0.6, 0.8));
    // Above the wheel's resonance the damper carries most of what reaches the body.
    assert!(
        (0.5 * heat.loss..2.0 * heat.loss).contains(&change(15.0, 20.0)),
        "{}",
        change(15.0, 20.0)
    );
}

#[test]
fn a_zero_wanders() {
    let (with, without) = swept(Flaw::Drift);
    let mut sum = 0.0;
    for name in [
        "pad_left_z",
        "pad_right_z",
        "wheel_left_z",
        "wheel_right_z",
        "body_left_z",
    ] {
        let zero = difference(&with[name], &without[name]);
        let asked = NOISE * hardware(Flaw::Drift).drift(name);
        sum += (zero[0] / asked).powi(2);
        let steps = difference(&zero[1000..], &zero[..zero.len() - 1000]);
        let wandered = rms(&steps) / (asked * (1.0_f64 / 30.0).sqrt());
        assert!(
            (0.3..3.0).contains(&wandered),
            "{name}: {wandered} of what was asked for in a second"
        );
    }
    assert!((0.2..3.0).contains(&(sum / 5.0)), "{sum}");
}

#[test]
fn the_mains_are_heard() {
    let (with, without) = swept(Flaw::Hum);
    let hum = difference(&with["body_left_z"], &without["body_left_z"]);
    let asked = NOISE * hardware(Flaw::Hum).hum("body_left_z");
    for (hertz, share) in [(50.0, 1.0), (150.0, 1.0 / 3.0)] {
        let part = |wave: fn(f64) -> f64| {
            let wave = |i: usize| wave(TAU * hertz * i as f64 / RATE);
            hum[..12000].iter().enumerate().map(|(i, a)| a * wave(i)).sum::<f64>() / 6000.0
        };
        let found = part(f64::sin).hypot(part(f64::cos)) / asked;
        assert!((found / share - 1.0).abs() < 0.1, "{found} of the hum at {hertz} Hz");
    }
}

#[test]
fn triggers_come_late_or_early() {
    let mut all = Vec::new();
    for (file, run) in [("cleat/v30_h10.csv", 10_001), ("cleat/v20_h20.csv", 20_000)] {
        let (with, without) = driven(Flaw::Jitter, file);
        let late = 1e3 * hardware(Flaw::Jitter).jitter(run);
        let (with, without) = (&with["wheel_left_z"], &without["wheel_left_z"]);
        let apart = |ms: f64| {
            let at = |place: f64| {
                let (i, part) = (place as usize, place.fract());
                without[i] + (without[i + 1] - without[i]) * part
            };
            let change: Vec<f64> = (10..1400).map(|i| with[i] - at(i as f64 + ms)).collect();
            rms(&change)
        };
        let best = (-50..=50)
            .map(|k| f64::from(k) / 10.0)
            .min_by(|a, b| apart(*a).total_cmp(&apart(*b)));
        let best = best.expect("a shift");
        assert!((best - late).abs() < 0.3, "{best} ms, {late} expected");
        all.push(late);
    }
    assert!(
        all.iter().all(|late| late.abs() <= 3.0) && (all[0] - all[1]).abs() > 0.1,
        "{all:?}"
    );
}

#[test]
fn the_sides_differ_by_four_percent() {
    let mut sides = hardware(Flaw::Sides).sides().expect("it was asked for");
    assert!((0..7).all(|_| (0.03..=0.04).contains(&sides().abs())));
    let (with, without) = swept(Flaw::Sides);
    assert_eq!(with["wheel_left_z"], without["wheel_left_z"]);
    let change = difference(&with["wheel_right_z"], &without["wheel_right_z"]);
    let share = rms(&change) / rms(&without["wheel_right_z"]);
    assert!((0.01..0.15).contains(&share), "{share}");
}

/// Before the cleat the tyres stand alike, and over it they differ: springs by a little, cams by more.
#[test]
fn the_tyre_obeys_another_law_over_the_cleat() {
    for (flaw, least, most) in [(Flaw::Tyre, 0.02, 0.3), (Flaw::Cams, 0.3, 1.5)] {
        let (with, without) = driven(flaw, "cleat/v20_h20.csv");
        let (with, without) = (&with["wheel_left_z"], &without["wheel_left_z"]);
        let change = difference(with, without);
        assert!(rms(&change[..100]) < 0.02, "{flaw:?}: {}", rms(&change[..100]));
        let share = rms(&change) / rms(without);
        assert!((least..most).contains(&share), "{flaw:?}: {share}");
    }
}
