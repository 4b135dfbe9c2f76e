//! Harmonic balance against closed forms, time integration and differences.

use qcar_runtime::model::Model;
use qcar_runtime::response::periodic::{Course, Drive, Periodic};
use qcar_runtime::simulate::{Accuracy, Between, Reading, Recorded, replay};
use std::collections::BTreeSet;
use std::f64::consts::TAU;

use super::support::strut::{Parts, Strut};

const P: [f64; 11] = [400.0, 42.0, 6.0, 25e3, 1500.0, 600e3, 900.0, 240e3, 160.0, 95.0, 9e5];
const DRY: Parts = Parts {
    powertrain: false,
    friction: true,
};

fn drive(frequency: f64, velocity: f64) -> Drive {
    Drive {
        frequency,
        amplitude: velocity * TAU * frequency,
        power: 2,
    }
}

/// Fourier coefficients of the accelerations over the last of many periods of classical Runge-Kutta from rest, relative
/// in phase to the pad's acceleration `A cos θ`.
fn integrated(model: &Strut, p: &[f64], drive: &Drive, periods: usize) -> Vec<[(f64, f64); 3]> {
    let mut x = vec![0.0; model.about().states.len()];
    continued(model, p, drive, periods, &mut x)
}

/// The same from the states `x`, which are those at the end after it.
fn continued(model: &Strut, p: &[f64], drive: &Drive, periods: usize, x: &mut Vec<f64>) -> Vec<[(f64, f64); 3]> {
    let omega = TAU * drive.frequency;
    let steps = (1.0 / (drive.frequency * 2e-4)).ceil() as usize;
    let h = 1.0 / (drive.frequency * steps as f64);
    let pad = |t: f64| {
        let a = drive.amplitude / (omega * omega);
        [-a * (omega * t).cos(), a * omega * (omega * t).sin(), 0.0]
    };
    let n = model.about().states.len();
    let f = |t: f64, x: &[f64]| {
        let mut dx = vec![0.0; n];
        model.derivative(p, x, &pad(t), &mut dx);
        dx
    };
    let add = |x: &[f64], k: &[f64], h: f64| -> Vec<f64> { x.iter().zip(k).map(|(x, k)| x + h * k).collect() };
    let outputs = model.about().outputs.len();
    let mut sums = vec![[(0.0, 0.0); 3]; outputs];
    for step in 0..periods * steps {
        let t = step as f64 * h;
        if step >= (periods - 1) * steps {
            let mut y = vec![0.0; outputs];
            model.outputs(p, x, &pad(t), &mut y);
            for (sums, y) in sums.iter_mut().zip(y) {
                for (order, sum) in sums.iter_mut().enumerate() {
                    let angle = omega * t * (order + 1) as f64;
                    sum.0 += 2.0 / steps as f64 * y * angle.cos();
                    sum.1 -= 2.0 / steps as f64 * y * angle.sin();
                }
            }
        }
        let k1 = f(t, x);
        let k2 = f(t + 0.5 * h, &add(x, &k1, 0.5 * h));
        let k3 = f(t + 0.5 * h, &add(x, &k2, 0.5 * h));
        let k4 = f(t + h, &add(x, &k3, h));
        let slope: Vec<f64> = (0..n)
            .map(|i| (k1[i] + 2.0 * k2[i] + 2.0 * k3[i] + k4[i]) / 6.0)
            .collect();
        *x = add(x, &slope, h);
    }
    sums
}

#[test]
fn dry_friction_shows_the_harmonics_that_integration_finds() {
    let model = Strut::new(DRY);
    let periodic = Periodic::new(&model, 0, 15);
    let drives: Vec<Drive> = (0..60).map(|k| drive(1.4 * 1.05f64.powi(k), 0.1)).collect();
    let all = BTreeSet::from_iter(0..drives.len());
    for (drive, cycle) in drives
        .iter()
        .zip(periodic.walk(&P, &drives, Course::Rising, &all, &[0, 1], &[]))
        .step_by(20)
    {
        assert!(cycle.converged);
        let expected = integrated(&model, &P, drive, 30);
        for (found, expected) in (0..2).map(|output| cycle.output(output)).zip(expected) {
            let scale = expected[0].0.hypot(expected[0].1);
            for (order, (re, im)) in expected.into_iter().enumerate() {
                let error = (found[order + 1].re - re).hypot(found[order + 1].im - im) / scale;
                assert!(error < 4e-3, "{} Hz, harmonic {}: {error}", drive.frequency, order + 1);
            }
        }
    }
}

/// A mass on mounts that stiffen with travel has two stable responses over some band. Those of integration start from the
/// motion at the frequency before. Every third line, as in coarse data, has the same ones.
#[test]
fn a_rising_and_a_falling_sweep_follow_their_own_branch() {
    let mut model = Strut::new(Parts {
        powertrain: true,
        friction: false,
    });
    (model.hardening, model.about.linear) = (9e9, false);
    let p: Vec<f64> = P[..9].iter().copied().chain([5.0, 20e3, 19.0]).collect();
    let drives: Vec<Drive> = (0..24).map(|k| drive(9.0 * 1.025f64.powi(k), 0.1)).collect();
    let all = BTreeSet::from_iter(0..drives.len());
    let (pwt, mut amplitudes) = (3, Vec::new());
    for course in [Course::Rising, Course::Falling] {
        let periodic = Periodic::new(&model, 0, 5);
        let cycles = periodic.walk(&p, &drives, course, &all, &[pwt], &[]);
        let third = BTreeSet::from_iter((2..drives.len()).step_by(3));
        let some = periodic.walk(&p, &drives, course, &third, &[pwt], &[]);
        for (one, &place) in some.iter().zip(&third) {
            let (one, same) = (one.output(pwt)[1], cycles[place].output(pwt)[1]);
            assert!(
                (one - same).norm() < 1e-5 * same.norm(),
                "{course:?}: {one}, not {same}"
            );
        }
        let mut places: Vec<usize> = all.iter().copied().collect();
        if course == Course::Falling {
            places.reverse();
        }
        let mut x = vec![0.0; model.about().states.len()];
        let mut off = Vec::new();
        for place in places {
            let (re, im) = continued(&model, &p, &drives[place], 80, &mut x)[pwt][0];
            let found = cycles[place].output(pwt)[1];
            off.push((found.re - re).hypot(found.im - im) / re.hypot(im));
        }
        // At the end of a branch, both methods leave it within a line of each other.
        off.sort_by(f64::total_cmp);
        assert!(off[off.len() - 2] < 5e-3, "{course:?}: {off:?}");
        amplitudes.push(
            cycles
                .iter()
                .map(|cycle| cycle.output(pwt)[1].norm())
                .collect::<Vec<_>>(),
        );
    }
    let times = amplitudes[0]
        .iter()
        .zip(&amplitudes[1])
        .map(|(rising, falling)| rising / falling);
    assert!(times.fold(0.0, f64::max) > 3.0, "{amplitudes:?}");
}

/// The steps of the search are longer, and its results the same.
#[test]
fn the_responses_of_some_lines_are_those_of_all() {
    let model = Strut::new(DRY);
    let periodic = Periodic::new(&model, 0, 5);
    let drives: Vec<Drive> = (0..60).map(|k| drive(1.4 * 1.05f64.powi(k), 0.1)).collect();
    let walk = |of: BTreeSet<usize>| periodic.walk(&P, &drives, Course::Rising, &of, &[0, 1], &[vec![0]]);
    let (all, some) = (
        walk(BTreeSet::from_iter(0..60)),
        walk(BTreeSet::from_iter((0..60).step_by(6))),
    );
    assert_eq!(some.len(), 10);
    for (one, same) in some.iter().zip(all.iter().step_by(6)) {
        assert!(one.converged && same.converged);
        for output in 0..2 {
            let pairs = [
                (one.output(output), same.output(output)),
                (one.slope(0, output), same.slope(0, output)),
            ];
            for (one, same) in pairs {
                let scale = same.iter().fold(0.0_f64, |scale, value| scale.max(value.norm()));
                assert!(
                    one.iter().zip(same).all(|(a, b)| (a - b).norm() < 1e-5 * scale),
                    "{one:?} {same:?}"
                );
            }
        }
    }
}

#[test]
fn a_replayed_sine_settles_to_the_cycle_of_harmonic_balance() {
    let (model, per_period, periods) = (Strut::new(DRY), 270, 40);
    // The balance is walked to: each frequency begins with the cycle of the one before.
    let walk: Vec<Drive> = (0..21).map(|k| drive(1.4 * 1.05f64.powi(k), 0.1)).collect();
    let all = BTreeSet::from_iter(0..walk.len());
    let cycles = Periodic::new(&model, 0, 15).walk(&P, &walk, Course::Rising, &all, &[0, 1], &[]);
    let (drive, cycle) = (walk[20], &cycles[20]);
    assert!(cycle.converged);
    let rate = drive.frequency * f64::from(per_period);
    let angle = |k: i32| TAU * f64::from(k) / f64::from(per_period);
    let pad: Vec<f64> = (0..periods * per_period)
        .map(|k| drive.amplitude * angle(k).cos())
        .collect();
    let recorded = Recorded {
        excitation: 0,
        power: 2,
        samples: &pad,
    };
    let how = Between {
        rate,
        band_limited: true,
        band: (0.0, rate),
        periodic: false,
        samples: pad.len(),
        accuracy: Accuracy::USUAL,
    };
    let outputs = (0..2).map(Reading::Output).collect();
    let replayed = replay(&model, &P, vec![recorded], how, outputs).unwrap();
    for (found, samples) in (0..2).map(|output| cycle.output(output)).zip(&replayed) {
        let last = &samples[samples.len() - per_period as usize..];
        for (order, expected) in found.iter().enumerate().skip(1).take(3) {
            let sum = |part: fn(f64) -> f64| {
                let terms = last.iter().zip(0..).map(|(y, k)| y * part(order as f64 * angle(k)));
                2.0 / f64::from(per_period) * terms.sum::<f64>()
            };
            let (re, im) = (sum(f64::cos), -sum(f64::sin));
            let error = (expected.re - re).hypot(expected.im - im) / found[1].norm();
            assert!(error < 4e-3, "harmonic {order}: {error}");
        }
    }
}

#[test]
fn the_slopes_are_those_of_differences() {
    let model = Strut::new(DRY);
    let periodic = Periodic::new(&model, 0, 5);
    let drive = drive(3.0, 0.1);
    let groups: Vec<Vec<usize>> = (0..P.len()).map(|k| vec![k]).collect();
    let cycle = periodic.cycle(&P, &drive, &[0, 1], &groups, None);
    for k in 0..P.len() {
        let at = |by: f64| {
            let mut p = P;
            p[k] *= 1.0 + by;
            periodic.cycle(&p, &drive, &[0, 1], &[], Some(&cycle.coefficients))
        };
        let (up, down) = (at(1e-4), at(-1e-4));
        for output in 0..2 {
            let expected = (up.output(output)[1] - down.output(output)[1]) / (2e-4 * P[k]);
            let found = cycle.slope(k, output)[1];
            let scale = expected.norm().max(1e-4 * cycle.output(output)[1].norm() / P[k]);
            assert!(
                (found - expected).norm() < 0.02 * scale,
                "parameter {k}: {found}, not {expected}"
            );
        }
    }
}

#[test]
fn outputs_may_be_asked_for_in_any_order_and_twice() {
    let model = Strut::new(DRY);
    let groups: Vec<Vec<usize>> = (0..P.len()).map(|k| vec![k]).collect();
    let periodic = Periodic::new(&model, 0, 5);
    let asked = |outputs: &[usize]| periodic.cycle(&P, &drive(3.0, 0.1), outputs, &groups, None);
    let (once, alone) = (asked(&[1, 0, 1]), [asked(&[0]), asked(&[1])]);
    for (output, alone) in alone.iter().enumerate() {
        assert_eq!(once.output(output), alone.output(output));
        assert_eq!(once.louder(output), alone.louder(output));
        for k in 0..P.len() {
            assert_eq!(once.slope(k, output), alone.slope(k, output));
        }
    }
}

#[test]
fn the_slopes_by_amplitude_are_those_of_differences() {
    let model = Strut::new(DRY);
    let periodic = Periodic::new(&model, 0, 5);
    let drive = drive(3.0, 0.1);
    let cycle = periodic.cycle(&P, &drive, &[0, 1], &[vec![0]], None);
    let at = |louder: f64| {
        let drive = Drive {
            amplitude: drive.amplitude * louder,
            ..drive
        };
        periodic.cycle(&P, &drive, &[0, 1], &[], Some(&cycle.coefficients))
    };
    let (up, down) = (at(1.0 + 1e-4), at(1.0 - 1e-4));
    for output in 0..2 {
        for order in [1, 3] {
            let expected = (up.output(output)[order] - down.output(output)[order]) / 2e-4;
            let found = cycle.louder(output)[order];
            assert!(
                (found - expected).norm() < 0.02 * expected.norm(),
                "{found}, not {expected}"
            );
        }
    }
}

#[test]
fn a_linear_model_answers_in_its_first_harmonic_alone() {
    let model = Strut::new(Parts { friction: false, ..DRY });
    let cycle = Periodic::new(&model, 0, 3).cycle(&P[..9], &drive(5.0, 0.1), &[0], &[], None);
    let expected = integrated(&model, &P[..9], &drive(5.0, 0.1), 60)[0][0];
    let found = cycle.output(0)[1];
    assert!((found.re - expected.0).hypot(found.im - expected.1) < 1e-6 * found.norm());
    assert!(cycle.output(0)[2].norm() < 1e-9 * found.norm());
}
