use std::mem::discriminant;
use std::sync::Arc;

use nalgebra::{DMatrix, DVector};

use super::super::factors::Factors;
use super::*;

fn sensor() -> Point {
    Point::new(
        "body",
        crate::campaign::Axis::Z,
        crate::campaign::Quantity::Acceleration,
    )
}

/// A value of unit noise and signal.
fn value(k: usize, place: f64, scale: f64) -> Value {
    Value {
        run: 0,
        place,
        rows: [k, k],
        parts: 1,
        scale,
    }
}

/// Values of one run at these positions.
fn group(places: &[f64], scale: f64) -> Group {
    let key = Key {
        sensor: sensor(),
        kind: Kind::Time,
        run: discriminant(&Stimulus::Sweep {
            reference: sensor(),
            signal: Vec::new(),
            swept: None,
            rate: 1.0,
            frequency: Vec::new(),
            amplitude: Vec::new(),
            time: Vec::new(),
            band: (1.0, 2.0),
        }),
    };
    Group::new(
        key,
        1,
        0.0,
        places
            .iter()
            .enumerate()
            .map(|(k, &place)| value(k, place, scale))
            .collect(),
        &Numbers::default(),
    )
}

/// The reference is the dense covariance.
#[test]
fn whitening_is_the_inverse_root_of_the_covariance() {
    let places: Vec<f64> = (0..30)
        .map(|k| 0.13 * f64::from(k) + 0.02 * f64::from(k * k % 7))
        .collect();
    let mut group = group(&places, 3.0);
    group.set(0.4);
    let covariance = DMatrix::from_fn(30, 30, |i, j| {
        let r: f64 = (places[i] - places[j]).abs();
        let k = if r < 1.0 { (1.0 - r).powi(2) } else { 0.0 };
        0.16 * 9.0 * k + if i == j { 1.0 } else { 0.0 }
    });
    let residual = DVector::from_fn(30, |k, _| (1.7 * k as f64).sin());
    let mut white = residual.as_slice().to_vec();
    group.whiten(&mut white);
    let square: f64 = white.iter().map(|value| value * value).sum();
    let expected = residual.dot(&covariance.clone().cholesky().unwrap().solve(&residual));
    assert!((square - expected).abs() < 1e-10 * expected, "{square}, not {expected}");
    let determinant = covariance.determinant().ln() / 2.0;
    assert!((group.log_determinant() - determinant).abs() < 1e-9, "{determinant}");
}

/// Data drawn from the Gaussian process give back the discrepancy of the draw, and zero if the draw has none.
#[test]
fn discrepancy_is_estimated_from_its_own_draws() {
    let places: Vec<f64> = (0..400).map(|k| 0.1 * f64::from(k)).collect();
    let mut group = group(&places, 20.0);
    // Reproducible normal numbers: the Box-Muller method on a golden-ratio sequence.
    let uniform = |k: usize, base: f64| (0.5 + base * (k + 1) as f64).fract();
    let normal = |k: usize| {
        let (a, b) = (uniform(k, 0.618_033_988_75), uniform(k, 0.754_877_666_25));
        (-2.0 * a.max(1e-12).ln()).sqrt() * (std::f64::consts::TAU * b).cos()
    };
    let white: Vec<f64> = (0..400).map(normal).collect();
    group.estimate(&white, |group, tau| Arc::new(group.factor(tau)));
    assert!(group.tau < 0.01, "{} of noise alone", group.tau);
    let truth: f64 = 0.1;
    let factor = group.factor(truth);
    let drawn = factor.times(&white);
    group.estimate(&drawn, |group, tau| Arc::new(group.factor(tau)));
    assert!((group.tau / truth - 1.0).abs() < 0.25, "{}, not {truth}", group.tau);
}

/// Estimates that share their factors have the same bits as single ones, whichever of two groups they are of.
#[test]
fn factors_that_are_kept_change_no_estimate() {
    let places: Vec<f64> = (0..60).map(|k| 0.17 * f64::from(k)).collect();
    let groups = [group(&places, 5.0), group(&places, 9.0)];
    let known = Factors::default();
    for draw in 0..4 {
        let residual: Vec<f64> = (0..60)
            .map(|k| 3.0 * ((0.3 + 0.1 * f64::from(draw)) * f64::from(k)).sin())
            .collect();
        for (place, group) in groups.iter().enumerate() {
            let estimated = |factor: &dyn Fn(&Group, f64) -> Arc<Banded>| {
                let mut group = group.clone();
                group.estimate(&residual, factor);
                (group.tau.to_bits(), group.log_determinant().to_bits())
            };
            let shared = estimated(&|group, tau| known.of(place, tau, || group.factor(tau)));
            let single = estimated(&|group, tau| Arc::new(group.factor(tau)));
            assert_eq!(shared, single, "draw {draw}, group {place}");
        }
    }
}

/// Three sensors that one force moves carry the evidence of one sensor.
#[test]
fn sensors_of_one_force_count_as_one() {
    let places: Vec<f64> = (0..20).map(|k| 0.3 * f64::from(k)).collect();
    let of = |kind, sensors| {
        let key = Key {
            kind,
            ..group(&places, 1.0).key
        };
        let values = places.iter().enumerate().map(|(k, &place)| value(k, place, 3.0));
        let mut group = Group::new(key, sensors, 0.0, values.collect(), &Numbers::default());
        group.set(0.4);
        group.log_determinant()
    };
    let alone = of(Kind::Passage, 1);
    assert!(alone > 0.0 && (of(Kind::Passage, 3) - alone / 3.0).abs() < 1e-12);
    assert_eq!(of(Kind::Time, 3), of(Kind::Time, 1));
}
