//! Cleat runs as evidence: a small campaign, written by a ride of a hand-written model, read back and fitted.

use std::collections::BTreeMap;
use std::f64::consts::{PI, TAU};
use std::fmt::Write;
use std::fs;
use std::path::Path;

use qcar_runtime::campaign::{Campaign, Role};
use qcar_runtime::discover::noise::{Form, Nuisance};
use qcar_runtime::discover::observe::{Kind, Means, predict};
use qcar_runtime::discover::posterior::refit_with;
use qcar_runtime::discover::{Evidence, Free, Misfit, Refit, refit};
use qcar_runtime::model::{About, Model};
use qcar_runtime::response::parameters::Values;
use qcar_runtime::road::Road;
use qcar_runtime::simulate::{Drive, Settings, Variant, ride};

use super::roller::{K_STOP, LOAD, OUTPUTS, RADIUS, Roller, STATIC_DEFLECTION, car, parameters};
use super::support::random::Random;

const RATE: f64 = 1000.0;
const NOISE: f64 = 0.05;
/// Where the plank begins, m.
const PLANK: f64 = 1.3;
/// Name, role, speed (m/s) and height of the plank (m) of each run.
const RUNS: [(&str, &str, f64, f64); 3] = [
    ("fast", "fit", 9.0, 0.04),
    ("slow", "fit", 5.0, 0.06),
    ("judge", "held_out", 7.0, 0.06),
];
/// Parameters of the suspension that a fit looks for.
const FREE: [&str; 6] = ["k_tire", "c_tire", "k_z", "c_z", "k_x", "c_x"];

/// What is wrong with the recorder: its clock is late by so many samples, the wheel's sensor reads so much too high,
/// and its sensors of both axes are late by so many samples more.
#[derive(Clone, Copy)]
struct Recorder {
    late: usize,
    gain: f64,
    wheel: usize,
}

const RIGHT: Recorder = Recorder {
    late: 0,
    gain: 0.0,
    wheel: 0,
};

/// A campaign of cleat runs of the car with parameters `p`, its records `seconds` long.
fn campaign(folder: &Path, p: &[f64], recorder: Recorder, seconds: f64) -> Campaign {
    let mut toml = format!(
        "format = 1\nname = \"tiny\"\nmodel = \"roller\"\n[vehicle]\nr_tire = {RADIUS}\n\
         static_tire_load = {LOAD}\nstatic_tire_def = {STATIC_DEFLECTION}\n"
    );
    for name in &OUTPUTS[..4] {
        let (axis, location) = (&name[..1], name[2..].trim_end_matches("_acceleration"));
        let _ = writeln!(
            toml,
            "[[channel]]\nname = \"{name}\"\nlocation = \"{location}\"\nside = \"left\"\naxis = \"{axis}\"\n\
             quantity = \"acceleration\"\nunit = \"m/s^2\""
        );
    }
    for (seed, (name, role, speed, height)) in RUNS.into_iter().enumerate() {
        let points = plank(height);
        fs::write(folder.join(format!("{name}_road.csv")), samples(&points)).expect("a new file");
        let road = Road::from_points(&points).expect("it is a road");
        let record = record(p, &road, speed, recorder, seconds, &mut Random(seed as u64));
        fs::write(folder.join(format!("{name}.csv")), record).expect("a new file");
        let _ = writeln!(
            toml,
            "[[road]]\nname = \"{name}\"\nfile = \"{name}_road.csv\"\n[[run]]\nkind = \"cleat\"\nfile = \"{name}.csv\"\n\
             role = \"{role}\"\nspeed = {speed:?}\nsample_rate = {RATE:?}\ncleat = \"{name}\""
        );
    }
    fs::write(folder.join("campaign.toml"), toml).expect("a new file");
    Campaign::open(folder).expect("it is a campaign")
}

/// A plank with ramps.
fn plank(height: f64) -> [[f64; 2]; 6] {
    let at = |x: f64, z: f64| [PLANK + x, z];
    [
        [0.0, 0.0],
        at(0.0, 0.0),
        at(0.02, height),
        at(0.1, height),
        at(0.12, 0.0),
        [20.0, 0.0],
    ]
}

/// The same every centimetre.
fn samples(points: &[[f64; 2]]) -> String {
    let road = Road::from_points(points).expect("it is a road");
    let rows = (0..2000).map(|i| f64::from(i) * 0.01);
    rows.fold("x,z,slope\n".into(), |mut text, x| {
        let slope = (road.height(x + 0.01) - road.height(x)) / 0.01;
        let _ = writeln!(text, "{x:.3},{:.6},{slope:.6}", road.height(x));
        text
    })
}

fn record(p: &[f64], road: &Road, speed: f64, recorder: Recorder, seconds: f64, random: &mut Random) -> String {
    let model = Roller::new();
    let drive = Drive {
        road,
        speed,
        sample_rate: RATE,
        samples: (seconds * RATE) as usize,
    };
    let ride = ride(&car(&model, p, Variant::Complete), &drive, &Settings::default()).expect("it rolls");
    let mut text = format!("time,{}\n", OUTPUTS[..4].join(","));
    for i in 0..drive.samples {
        let _ = write!(text, "{:.3}", i as f64 / RATE);
        for (name, output) in OUTPUTS.iter().zip(&ride.outputs).take(4) {
            let gain = if *name == "z_wheel_acceleration" {
                1.0 + recorder.gain
            } else {
                1.0
            };
            let own = if name.contains("wheel") { recorder.wheel } else { 0 };
            let value = gain * output[i.saturating_sub(recorder.late + own)] + NOISE * random.normal();
            let _ = write!(text, ",{value:.4}");
        }
        text.push('\n');
    }
    text
}

fn place(about: &About, name: &str) -> usize {
    about
        .parameters
        .iter()
        .position(|p| p.name == name)
        .expect("the model has it")
}

/// All parameters, those that are free `off` times what they are.
fn values(about: &About, off: f64) -> Values {
    let start = about.parameters.iter().zip(parameters()).map(|(parameter, value)| {
        let off = if FREE.contains(&&*parameter.name) { off } else { 1.0 };
        (parameter.name.to_string(), off * value)
    });
    Values::resolve(about, &start.collect(), &BTreeMap::new()).expect("every parameter is given")
}

fn free(about: &About) -> Vec<Free> {
    let of = |name: &&str| {
        let parameter = place(about, name);
        let value = parameters()[parameter];
        Free {
            parameter,
            lower: 0.3 * value,
            upper: 3.0 * value,
        }
    };
    FREE.iter().map(of).collect()
}

fn fitted(campaign: &Campaign) -> (Evidence, Refit, Misfit) {
    let model = Roller::new();
    let evidence = Evidence::from_campaign(campaign, model.about()).expect("the runs can be read");
    let refit = refit(&model, &values(model.about(), 1.2), &free(model.about()), &evidence).expect("it rolls");
    let misfit = Misfit::of(&model, &refit, &evidence).expect("it rolls");
    (evidence, refit, misfit)
}

#[test]
fn a_late_clock_and_a_sensor_that_reads_high_leave_noise_alone() {
    let folder = tempfile::tempdir().expect("a place for files");
    let recorder = Recorder {
        late: 3,
        gain: 0.01,
        ..RIGHT
    };
    let campaign = campaign(folder.path(), &parameters(), recorder, 1.4);
    let (evidence, refit, misfit) = fitted(&campaign);
    assert_eq!(evidence.series.len(), 12);
    assert!(
        evidence
            .series
            .iter()
            .all(|series| series.kind == Kind::Passage && series.at.len() > 150)
    );
    assert!(refit.stop.converged(), "{:?}", refit.stop);
    assert!((0.2..1.1).contains(&misfit.fit), "{}", misfit.fit);
    assert!((0.2..1.1).contains(&misfit.held_out), "{}", misfit.held_out);
    for (free, estimate) in refit.free.iter().zip(&refit.estimate) {
        let true_value = parameters()[free.parameter];
        assert!(
            (estimate / true_value - 1.0).abs() < 0.02,
            "{estimate}, made with {true_value}"
        );
    }
}

/// Each run is shifted to where it agrees best, and yet what is late against the others is seen.
#[test]
fn a_location_that_is_late_against_the_others_is_told_from_a_late_clock() {
    let folder = tempfile::tempdir().expect("a place for files");
    let recorder = Recorder {
        late: 2,
        wheel: 4,
        ..RIGHT
    };
    let campaign = campaign(folder.path(), &parameters(), recorder, 1.4);
    let (evidence, _, misfit) = fitted(&campaign);
    assert!(
        misfit.fit > 1.5 && misfit.held_out > 1.5,
        "{} {}",
        misfit.fit,
        misfit.held_out
    );

    let model = Roller::new();
    let (values, free) = (values(model.about(), 1.05), free(model.about()));
    let with_suspect = |location, axis| Nuisance::of(&evidence).with_suspect(location, axis, Form::Delay, 0.02);
    let late = with_suspect("wheel", None).expect("both axes are there");
    let refit = refit_with(&model, &values, &free, &evidence, late, 60).expect("it rolls");
    let misfit = Misfit::of(&model, &refit, &evidence).expect("it rolls");
    assert!(
        misfit.fit < 1.1 && misfit.held_out < 1.1,
        "{} {}",
        misfit.fit,
        misfit.held_out
    );
    let delay = refit.coefficients[refit.nuisance.count() - 1];
    assert!((delay - 0.004).abs() < 1e-4, "{delay} s");
    assert_eq!(with_suspect("pad", None), None);
}

#[test]
fn a_missing_bump_stop_leaves_a_gap_that_no_calibration_closes() {
    let folder = tempfile::tempdir().expect("a place for files");
    let mut p = parameters();
    p[K_STOP] = 600e3;
    let (_, refit, misfit) = fitted(&campaign(folder.path(), &p, RIGHT, 1.4));
    assert!(
        misfit.fit > 2.0 && misfit.held_out > 2.0,
        "{} {}",
        misfit.fit,
        misfit.held_out
    );
    let side = refit.side.as_slice().iter().zip(refit.values.as_slice());
    side.filter(|(_, value)| **value != 0.0).for_each(|(side, value)| {
        assert!((side / value).ln().abs() < 0.046, "{side} beside {value}");
    });
}

/// Against differences of whole predictions, central ones.
#[test]
fn slopes_are_derivatives_of_what_is_predicted() {
    let folder = tempfile::tempdir().expect("a place for files");
    let (model, campaign) = (Roller::new(), campaign(folder.path(), &parameters(), RIGHT, 1.4));
    let evidence = Evidence::from_campaign(&campaign, model.about()).expect("the runs can be read");
    let (free, values) = (free(model.about()), values(model.about(), 1.1));
    let base = predict(&model, &values, &free, &evidence, Role::HeldOut).expect("it rolls");
    for (k, free) in free.iter().enumerate() {
        let value = values.as_slice()[free.parameter];
        let moved = |factor: f64| {
            let mut values = values.clone();
            values.set(free.parameter, factor * value);
            predict(&model, &values, &[], &evidence, Role::HeldOut).expect("it rolls")
        };
        let (more, less) = (moved(1.005), moved(0.995));
        let (mut error, mut size) = (0.0, 0.0);
        for ((base, more), less) in base.iter().zip(&more).zip(&less) {
            for i in 0..base.value.len() {
                let difference = (more.value[i] - less.value[i]).re / (0.01 * value);
                error += (base.slopes[k][i].re - difference).powi(2);
                size += difference.powi(2);
            }
        }
        assert!(
            error < 0.05_f64.powi(2) * size,
            "{}: {}",
            FREE[k],
            (error / size).sqrt()
        );
    }
}

#[test]
fn a_record_that_ends_before_the_plank_is_left_out_by_name() {
    let folder = tempfile::tempdir().expect("a place for files");
    let campaign = campaign(folder.path(), &parameters(), RIGHT, 0.2);
    let error = Evidence::from_campaign(&campaign, Roller::new().about()).expect_err("nothing was recorded");
    let message = error.to_string();
    assert!(message.contains("slow.csv: the record ends at 0.199 s"), "{message}");
}

/// The Fourier transform of the pulse, `sin(2πfT) / 2πfT / (1 - (2fT)²)`, is what a sine keeps of itself.
#[test]
fn a_mean_of_a_sine_is_a_smaller_sine() {
    let means = Means::new(1000.0, 5e-3);
    for means in [means, means.sparse()] {
        for f in [3.0, 20.0, 70.0] {
            let sine: Vec<f64> = (0..1000).map(|k| (TAU * f * k as f64 / means.rate()).sin()).collect();
            let place = 2.0 * f * means.half();
            let gain = (PI * place).sin() / (PI * place) / (1.0 - place * place);
            for t in [0.3, 0.30013, 0.40077] {
                let (mean, slope) = means.at(&sine, t);
                let (sin, cos) = (TAU * f * t).sin_cos();
                assert!((mean - gain * sin).abs() < 2e-3, "{mean} at {t} s of {f} Hz");
                assert!(
                    (slope - gain * TAU * f * cos).abs() < 1.5 * TAU,
                    "{slope} at {t} s of {f} Hz"
                );
            }
        }
    }
}
