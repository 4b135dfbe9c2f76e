//! Sweeps of an axle with dry friction, integrated in fine steps, from levels at which it sticks to those at which it
//! slips, against what discovery predicts of them.

use std::collections::BTreeMap;
use std::f64::consts::{PI, TAU};
use std::fmt::Write;
use std::fs;
use std::path::Path;
use std::sync::LazyLock;

use nalgebra::Complex;
use qcar_runtime::campaign::{Campaign, Quantity, Role};
use qcar_runtime::discover::observe::{Kind, Prediction, Stimulus, TestConditions, predict, unsteady};
use qcar_runtime::discover::posterior::{add_unsteady, refit};
use qcar_runtime::discover::{Evidence, Free, Misfit, Refit};
use qcar_runtime::model::Model;
use qcar_runtime::response::parameters::Values;

use super::support::strut::{Parts, Strut};

const P: [f64; 11] = [400.0, 42.0, 6.0, 25e3, 1500.0, 600e3, 900.0, 240e3, 160.0, 95.0, 9e5];
const DRY: Parts = Parts {
    powertrain: false,
    friction: true,
};
const PLAIN: Parts = Parts {
    powertrain: false,
    friction: false,
};
const RATE: f64 = 500.0;
/// Steps of the integration for each sample.
const STEPS: usize = 8;
const SECONDS: f64 = 34.0;
const LEVELS: [(f64, &str); 3] = [(0.01, "fit"), (0.05, "fit"), (0.2, "held_out")];

/// Velocity of the pad: a sine of constant amplitude that sweeps from 0.45 to 32 Hz, faded in and out.
fn velocity(t: f64, level: f64) -> f64 {
    let (first, octaves, length) = (0.45, 70.0f64.ln(), SECONDS - 2.0);
    let phase = TAU * first * length / octaves * ((octaves * t / length).exp() - 1.0);
    let edge = (t / 4.0).min(length - t).clamp(0.0, 1.0);
    level * (PI / 2.0 * edge).sin().powi(2) * phase.sin()
}

/// The pad at every half step: position, velocity, acceleration.
fn pad(level: f64) -> Vec<[f64; 3]> {
    let half = 0.5 / (RATE * STEPS as f64);
    let count = (SECONDS / half) as usize + 2;
    let mut position = 0.0;
    let at = |k: usize| {
        let t = k as f64 * half;
        let now = velocity(t, level);
        let [before, after] = [-half, half].map(|by| velocity(t + by, level));
        position += half * (now + velocity(t - half, level)) / 2.0;
        [position, now, (after - before) / (2.0 * half)]
    };
    (0..count).map(at).collect()
}

/// Samples of pad, wheel and body by classical Runge-Kutta.
fn record(model: &Strut, level: f64) -> String {
    let (pad, h) = (pad(level), 1.0 / (RATE * STEPS as f64));
    let n = model.about().states.len();
    let f = |k: usize, x: &[f64]| {
        let mut dx = vec![0.0; n];
        model.derivative(&P, x, &[pad[k][0], pad[k][1], 0.0], &mut dx);
        dx
    };
    let add = |x: &[f64], k: &[f64], h: f64| -> Vec<f64> { x.iter().zip(k).map(|(x, k)| x + h * k).collect() };
    let mut x = vec![0.0; n];
    let mut text = "time,pad,wheel,body\n".to_string();
    for step in 0..(SECONDS * RATE) as usize * STEPS {
        let k = 2 * step;
        if step % STEPS == 0 {
            let mut y = vec![0.0; 3];
            model.outputs(&P, &x, &[pad[k][0], pad[k][1], 0.0], &mut y);
            let _ = writeln!(text, "{:.4},{:.7},{:.7},{:.7}", step as f64 * h, pad[k][2], y[1], y[0]);
        }
        let k1 = f(k, &x);
        let k2 = f(k + 1, &add(&x, &k1, 0.5 * h));
        let k3 = f(k + 1, &add(&x, &k2, 0.5 * h));
        let k4 = f(k + 2, &add(&x, &k3, h));
        let slope: Vec<f64> = (0..n)
            .map(|i| (k1[i] + 2.0 * k2[i] + 2.0 * k3[i] + k4[i]) / 6.0)
            .collect();
        x = add(&x, &slope, h);
    }
    text
}

/// A campaign of records whose first `cut` samples are lost, of sweeps from `first` Hz.
fn campaign(folder: &Path, model: &Strut, (cut, first): (usize, f64)) -> Campaign {
    let mut toml = "format = 1\nname = \"dry\"\nmodel = \"strut\"\n".to_string();
    for name in ["pad", "wheel", "body"] {
        let _ = writeln!(
            toml,
            "[[channel]]\nname = \"{name}\"\nlocation = \"{name}\"\nside = \"left\"\naxis = \"z\"\n\
             quantity = \"acceleration\"\nunit = \"m/s^2\""
        );
    }
    for (run, (level, role)) in LEVELS.into_iter().enumerate() {
        let record = record(model, level);
        let lines = record.lines().enumerate().filter(|(line, _)| !(1..=cut).contains(line));
        let lines: Vec<&str> = lines.map(|(_, text)| text).collect();
        fs::write(folder.join(format!("{run}.csv")), lines.join("\n")).expect("a new file");
        let _ = writeln!(
            toml,
            "[[run]]\nkind = \"sweep\"\nfile = \"{run}.csv\"\nrole = \"{role}\"\npeak_velocity = {level}\n\
             start_frequency = {first:?}\nend_frequency = 30.0\nspacing = \"logarithmic\"\nsample_rate = {RATE:?}"
        );
    }
    fs::write(folder.join("campaign.toml"), toml).expect("a new file");
    Campaign::open(folder).expect("it is a campaign")
}

/// What sweeps of a model show.
fn evidence(parts: Parts) -> (Strut, Evidence) {
    evidence_from(parts, (0, 0.5))
}

fn evidence_from(parts: Parts, begin: (usize, f64)) -> (Strut, Evidence) {
    let (folder, model) = (tempfile::tempdir().expect("a place for files"), Strut::new(parts));
    let campaign = campaign(folder.path(), &model, begin);
    let evidence = Evidence::from_campaign(&campaign, model.about()).expect("the runs can be read");
    (model, evidence)
}

/// Sweeps of the axle with friction and of that without, which all tests are about.
static WITH_FRICTION: LazyLock<(Strut, Evidence)> = LazyLock::new(|| evidence(DRY));
static LINEAR: LazyLock<(Strut, Evidence)> = LazyLock::new(|| evidence(PLAIN));

/// The friction found from sweeps that are taken as steady.
static FITTED: LazyLock<Refit> = LazyLock::new(|| {
    let (model, evidence) = &*WITH_FRICTION;
    let free = [9, 10].map(free);
    refit(model, &values(model, 1.2), &free, evidence).expect("the model has the sensors")
});

fn values(model: &Strut, off: f64) -> Values {
    with_friction(model, [off * P[9], off * P[10]])
}

/// With this level and stiffness of its friction, where it has any.
fn with_friction(model: &Strut, friction: [f64; 2]) -> Values {
    let values = P[..9].iter().chain(&friction);
    let given = model.about().parameters.iter().zip(values);
    let given: BTreeMap<String, f64> = given.map(|(own, value)| (own.name.to_string(), *value)).collect();
    Values::resolve(model.about(), &given, &BTreeMap::new()).expect("every parameter is given")
}

fn free(parameter: usize) -> Free {
    Free {
        parameter,
        lower: 0.3 * P[parameter],
        upper: 3.0 * P[parameter],
    }
}

/// The worst difference from the first harmonics, relative to these, with and without what is unsteady.
fn worst(model: &Strut, evidence: &Evidence, role: Role) -> [f64; 2] {
    let values = values(model, 1.0);
    let added =
        unsteady(model, &values, &TestConditions::default(), evidence, role).expect("the model has the sensors");
    let mut worst = [0.0; 2];
    for mut prediction in predict(model, &values, &[], evidence, role).expect("the model has the sensors") {
        let series = &evidence.series[prediction.series];
        for worst in &mut worst {
            let pairs = series.value.iter().zip(&prediction.value);
            let errors = pairs.map(|(seen, said)| (seen - said).norm() / seen.norm());
            if series.kind == Kind::Harmonic(1) {
                *worst = errors.fold(*worst, f64::max);
            }
            prediction.add(&added[prediction.series]);
        }
    }
    worst
}

#[test]
fn what_never_settles_is_predicted_as_it_is_measured() {
    let (model, evidence) = &*WITH_FRICTION;
    for role in [Role::Fit, Role::HeldOut] {
        let [steady, unsteady] = worst(model, evidence, role);
        assert!(steady > 0.01, "{steady}");
        assert!(unsteady < 0.003, "{unsteady}");
    }
    let refitted = add_unsteady(model, FITTED.clone(), evidence).expect("the model has the sensors");
    let misfit = Misfit::of(model, &refitted, evidence).expect("the model has the sensors");
    assert!(
        misfit.fit < 1.0 && misfit.held_out < 1.0,
        "{} {}",
        misfit.fit,
        misfit.held_out
    );
    for (free, estimate) in refitted.free.iter().zip(&refitted.estimate) {
        let error = estimate / P[free.parameter] - 1.0;
        assert!(error.abs() < 0.01, "parameter {}: {error}", free.parameter);
    }
}

#[test]
fn the_slopes_along_the_errors_of_sensors_are_those_of_differences() {
    let ((model, evidence), fitted) = (&*WITH_FRICTION, &*FITTED);
    let (residual, jacobian) = fitted.linearised(model, evidence);
    // One side is enough: what the slope changes over this step is far below the bound.
    const STEP: f64 = 1e-4;
    for k in 0..fitted.coefficients.len() {
        let mut moved = fitted.clone();
        moved.coefficients[k] += STEP;
        let expected = (moved.linearised(model, evidence).0 - &residual) / STEP;
        let found = jacobian.column(fitted.free.len() + k);
        // Where friction nearly sticks, a search ends elsewhere for the least change: of the others most are right.
        let mut errors: Vec<f64> = found
            .iter()
            .zip(&expected)
            .map(|(found, expected)| (found - expected).abs())
            .collect();
        errors.sort_by(f64::total_cmp);
        let (error, size) = (
            errors[errors.len() * 9 / 10],
            expected.norm() / (errors.len() as f64).sqrt(),
        );
        assert!(error < 0.15 * size, "{k}: {error} of {size}");
    }
}

/// Friction of next to no force, so that an axle is called one whose laws bend, and is balanced and replayed.
const NO_FRICTION: [f64; 2] = [1e-6, 1e-6];

/// What is unsteady in the sweeps that may be fitted.
fn unsteady_of(model: &Strut, evidence: &Evidence) -> Vec<Vec<Complex<f64>>> {
    let values = with_friction(model, NO_FRICTION);
    unsteady(model, &values, &TestConditions::default(), evidence, Role::Fit).expect("the model has the sensors")
}

/// What sweeps of a linear axle show, whose pad is seen by a sensor that may be of another quantity and read something
/// at rest.
fn of_linear_axle(quantity: Quantity, at_rest: f64) -> (&'static Strut, Evidence) {
    let (plain, mut evidence) = (&LINEAR.0, LINEAR.1.clone());
    for run in &mut evidence.runs {
        if let Stimulus::Sweep { reference, signal, .. } = &mut run.stimulus {
            reference.quantity = quantity;
            signal.iter_mut().for_each(|sample| *sample += at_rest);
        }
    }
    (plain, evidence)
}

fn largest(values: impl Iterator<Item = Complex<f64>>) -> f64 {
    values.map(|value| value.norm()).fold(0.0, f64::max)
}

/// A linear axle has no harmonics, but the estimator sees some near the ends of a sweep.
#[test]
fn what_the_estimator_takes_for_harmonics_of_a_linear_axle_is_predicted() {
    let (plain, evidence) = of_linear_axle(Quantity::Acceleration, 0.1);
    let added = unsteady_of(plain, &evidence);
    let steady = predict(plain, &values(plain, 1.0), &[], &evidence, Role::Fit).expect("it has the sensors");
    for mut prediction in steady {
        let series = &evidence.series[prediction.series];
        let left = |said: &[Complex<f64>]| largest(series.value.iter().zip(said).map(|(seen, said)| seen - said));
        let without = left(&prediction.value);
        prediction.add(&added[prediction.series]);
        let with = left(&prediction.value);
        let what = format!("{} {:?}", series.sensor, series.kind);
        assert!(series.kind == Kind::Harmonic(1) || without > 1e-3, "{what}: {without}");
        assert!(with < 5e-5, "{what}: {with}");
    }
}

/// Whatever quantity the pad's samples are of: that of acceleration alone is what the pad did.
#[test]
fn a_linear_axle_answers_a_sweep_as_it_does_when_it_is_replayed() {
    for quantity in [Quantity::Acceleration, Quantity::Velocity, Quantity::Displacement] {
        let (plain, evidence) = of_linear_axle(quantity, 0.0);
        let answered = unsteady_of(plain, &evidence).concat();
        let replayed = unsteady_of(&WITH_FRICTION.0, &evidence).concat();
        let off = largest(
            answered
                .iter()
                .zip(&replayed)
                .map(|(answered, replayed)| answered - replayed),
        );
        let most = largest(answered.into_iter());
        assert!(off < 0.2 * most, "{quantity:?}: {off} of {most}");
    }
}

/// The evidence of sensors with a noise of 0.1 % of the pad's motion.
fn noisy(mut evidence: Evidence) -> Evidence {
    for series in &mut evidence.series {
        series.sigma.iter_mut().for_each(|sigma| *sigma = sigma.hypot(1e-3));
    }
    evidence
}

/// Largest difference of the harmonics of a linear axle from their prediction, in standard deviations.
fn worst_in_sd(model: &Strut, evidence: &Evidence) -> f64 {
    let values = values(model, 1.0);
    let added = unsteady(model, &values, &TestConditions::default(), evidence, Role::Fit).expect("it has the sensors");
    let predicted = predict(model, &values, &[], evidence, Role::Fit).expect("it has the sensors");
    let of_series = |mut prediction: Prediction| {
        prediction.add(&added[prediction.series]);
        let series = &evidence.series[prediction.series];
        let errors = series.value.iter().zip(&prediction.value).zip(&series.sigma);
        errors.fold(0.0, |worst: f64, ((seen, said), sigma)| {
            worst.max((seen - said).norm() / sigma)
        })
    };
    predicted.into_iter().map(of_series).fold(0.0, f64::max)
}

/// The first seconds of a sweep are lost, so the axle rings where the record begins. Two octaves above its start the
/// harmonics are as certain as before. A record that begins at rest hides nothing.
#[test]
fn harmonics_are_as_uncertain_as_the_motion_before_the_record() {
    let (model, whole) = of_linear_axle(Quantity::Acceleration, 0.0);
    let mut whole = noisy(whole);
    assert!(
        !whole
            .allow_for_starts(model, &values(model, 1.0))
            .expect("it has the sensors")
    );
    let lost = (3.3 * RATE) as usize;
    let (model, cut) = evidence_from(PLAIN, (lost, 0.7));
    let before = noisy(cut);
    let mut cut = before.clone();
    assert!(
        cut.allow_for_starts(&model, &values(&model, 1.0))
            .expect("it has the sensors")
    );
    let [worst_before, worst_after] = [&before, &cut].map(|evidence| worst_in_sd(&model, evidence));
    assert!(worst_before > 5.0 && worst_after < 3.0, "{worst_before} {worst_after}");
    for (before, after) in before.series.iter().zip(&cut.series) {
        let sigmas = before.at.iter().zip(before.sigma.iter().zip(&after.sigma));
        for (at, (before, after)) in sigmas.filter(|(at, _)| **at > 2.8) {
            assert!(*after < 1.1 * before, "{at} Hz: {before} {after}");
        }
    }
}
