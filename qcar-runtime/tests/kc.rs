//! Gradients of synthetic loops, whose stiffness, damping and friction are known.

use qcar_runtime::kc::{Cycle, Estimate, KcError, Sine, SineSamples, cycle, sines};
use std::f64::consts::TAU;

/// Numbers that scatter like a normal distribution, as the sum of twelve uniform ones.
struct Scatter(u64);

impl Scatter {
    fn next(&mut self) -> f64 {
        let mut uniform = || {
            self.0 = self
                .0
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            (self.0 >> 11) as f64 / (1_u64 << 53) as f64
        };
        (0..12).map(|_| uniform()).sum::<f64>() - 6.0
    }
}

/// A cycle through ±80 mm of a spring with friction, noise and bump stops at ±60 mm.
fn bounce(stiffness: f64, friction: f64, noise: f64, seed: u64) -> (Vec<f64>, Vec<f64>) {
    let mut scatter = Scatter(seed);
    (0..1200)
        .map(|i| {
            let phase = TAU * f64::from(i) / 1200.0;
            let x = 0.08 * phase.cos();
            let stop = 4e5 * (x.abs() - 0.06).max(0.0) * x.signum();
            let force = 30.0 + stiffness * x - friction * phase.sin().signum() + stop + noise * scatter.next();
            (x + 1e-5 * scatter.next(), force)
        })
        .unzip()
}

fn within(estimate: Estimate, truth: f64, errors: f64) -> bool {
    (estimate.value - truth).abs() <= errors * estimate.standard_error
}

#[test]
fn a_bounce_gives_stiffness_and_half_the_loop() {
    let (displacement, force) = bounce(30e3, 120.0, 8.0, 1);
    let Cycle { stiffness, half_width } = cycle(&displacement, &force).unwrap();
    assert!(
        within(stiffness, 30e3, 3.0) && within(half_width, 120.0, 3.0),
        "{stiffness:?} {half_width:?}"
    );
    assert!(
        stiffness.standard_error < 30.0 && half_width.standard_error < 1.0,
        "{stiffness:?} {half_width:?}"
    );
}

#[test]
fn the_standard_error_is_the_scatter_of_repeated_measurements() {
    let repeats: Vec<Estimate> = (1..200)
        .map(|seed| bounce(30e3, 100.0, 10.0, seed))
        .map(|(displacement, force)| cycle(&displacement, &force).unwrap().stiffness)
        .collect();
    let count = repeats.len() as f64;
    let mean = repeats.iter().map(|e| e.value).sum::<f64>() / count;
    let scatter = (repeats.iter().map(|e| (e.value - mean).powi(2)).sum::<f64>() / count).sqrt();
    let stated = repeats.iter().map(|e| e.standard_error).sum::<f64>() / count;
    assert!((stated / scatter - 1.0).abs() < 0.2, "stated {stated}, found {scatter}");
}

#[test]
fn outliers_hardly_move_the_gradient() {
    let (displacement, mut force) = bounce(30e3, 50.0, 5.0, 2);
    force.iter_mut().step_by(29).for_each(|f| *f += 5e3);
    let stiffness = cycle(&displacement, &force).unwrap().stiffness;
    assert!((stiffness.value / 30e3 - 1.0).abs() < 0.005, "{stiffness:?}");
}

#[test]
fn the_uncertainty_holds_scatter_and_scale() {
    let estimate = Estimate {
        value: 30e3,
        standard_error: 200.0,
    };
    assert!((estimate.uncertainty() - 250.0).abs() < 1e-9);
}

/// Sines of ±20 mm at a peak velocity, sampled as K&C rigs do.
fn sine(peak: f64, seed: u64) -> [Vec<f64>; 3] {
    let mut scatter = Scatter(seed);
    let mut columns: [Vec<f64>; 3] = Default::default();
    for i in 0..800 {
        let phase = TAU * 2.0 * f64::from(i) / 800.0;
        let (x, v) = (0.02 * phase.cos(), -peak * phase.sin());
        let force = 4.0 + 30e3 * x + 1500.0 * v + 60.0 * v.signum() + 6.0 * scatter.next();
        let row = [x + 1e-5 * scatter.next(), v + 5e-4 * scatter.next(), force];
        columns
            .iter_mut()
            .zip(row)
            .for_each(|(column, value)| column.push(value));
    }
    columns
}

#[test]
fn sines_tell_damping_from_friction() {
    let runs = [sine(0.025, 3), sine(0.075, 4), sine(0.125, 5)];
    let samples: Vec<SineSamples> = runs
        .iter()
        .map(|[displacement, velocity, force]| SineSamples {
            displacement,
            velocity,
            force,
        })
        .collect();
    let Sine {
        stiffness,
        damping,
        friction,
    } = sines(&samples).unwrap();
    assert!(within(stiffness, 30e3, 3.0) && within(damping, 1500.0, 3.0) && within(friction, 60.0, 3.0));
    assert!(damping.standard_error < 15.0, "{damping:?}");
}

#[test]
fn curves_without_an_answer_are_refused() {
    let (displacement, force) = bounce(30e3, 0.0, 1.0, 1);
    assert_eq!(
        cycle(&displacement, &force[1..]),
        Err(KcError::Lengths {
            first: 1200,
            second: 1199
        })
    );
    let few: Vec<f64> = (0..9).map(f64::from).collect();
    assert_eq!(cycle(&few, &few), Err(KcError::TooFew { found: 5, expected: 20 }));
    assert_eq!(cycle(&displacement[..600], &force[..600]), Err(KcError::OneWay));
    assert_eq!(cycle(&[0.1; 100], &[5.0; 100]), Err(KcError::OneWay));
    assert_eq!(sines(&[]), Err(KcError::TooFew { found: 0, expected: 20 }));
}
