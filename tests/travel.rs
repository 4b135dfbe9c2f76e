//! K&C cycles as evidence, written in closed form and held against what compiled models say of them.

use std::collections::BTreeMap;
use std::fmt::Write;
use std::fs;
use std::path::Path;
use std::sync::Arc;

use qcar::catalogue::{compiled, load_text};
use qcar::effects;
use qcar::workshop::Bench;
use qcar_runtime::campaign::{Campaign, Role};
use qcar_runtime::discover::candidate::Workshop;
use qcar_runtime::discover::observe::{Kind, predict};
use qcar_runtime::discover::{Evidence, Free};
use qcar_runtime::model::Model;
use qcar_runtime::response::parameters::Values;

const FRICTION: f64 = 140.0;
const PRESLIDING: f64 = 1e6;
/// Stiffness of the wheel's bushing and of the sub-frame's, along x.
const BUSHINGS: [f64; 2] = [5e5, 2.4e6];
const SPRING: f64 = 26e3;
const AMPLITUDE: f64 = 0.02;

/// A cycle there and back whose friction changes sign with the direction.
fn cycle(reach: f64, force: impl Fn(f64) -> f64) -> String {
    let steps = 600;
    let there = (0..=steps).map(|i| (f64::from(i) / f64::from(steps) * 2.0 - 1.0, 1.0));
    let back = there.clone().map(|(x, _)| (-x, -1.0));
    there
        .chain(back)
        .fold("displacement,force\n".to_string(), |mut text, (x, way)| {
            let x = reach * x;
            let _ = writeln!(text, "{x:.6},{:.3}", force(x) + way * FRICTION);
            text
        })
}

/// Two sines and three quarters: a spring, a damper, and a friction that has turned all but e^(-d) after so many times
/// `FRICTION / PRESLIDING` of travel behind a reversal (the solution of Dahl's law).
fn sine(frequency: f64, damping: f64) -> String {
    let omega = std::f64::consts::TAU * frequency;
    let samples = 1000;
    (0..=samples).fold("time,displacement,velocity,force\n".to_string(), |mut text, i| {
        let t = 2.75 / frequency * f64::from(i) / f64::from(samples);
        let (x, v) = (AMPLITUDE * (omega * t).cos(), -omega * AMPLITUDE * (omega * t).sin());
        let behind = AMPLITUDE - x * -v.signum();
        let turned = 1.0 - 2.0 * (-behind * PRESLIDING / FRICTION).exp();
        let force = SPRING * x + damping * v + FRICTION * turned * v.signum();
        let _ = writeln!(text, "{t:.6},{x:.8},{v:.8},{force:.4}");
        text
    })
}

fn campaign(folder: &Path, kind: &str, curve: &str) -> Campaign {
    fs::write(folder.join("curve.csv"), curve).unwrap();
    let run = format!("[[run]]\nkind = \"{kind}\"\nfile = \"curve.csv\"\nrole = \"fit\"\n");
    opened(folder, &run)
}

/// A slow cycle, and sines of these frequencies on a damper.
fn with_sines(folder: &Path, curve: &str, frequencies: &[f64], damping: f64) -> Campaign {
    fs::write(folder.join("curve.csv"), curve).unwrap();
    let mut runs = "[[run]]\nkind = \"bounce\"\nfile = \"curve.csv\"\nrole = \"fit\"\n".to_string();
    for (i, frequency) in frequencies.iter().enumerate() {
        fs::write(folder.join(format!("sine_{i}.csv")), sine(*frequency, damping)).unwrap();
        let peak = std::f64::consts::TAU * frequency * AMPLITUDE;
        let _ = write!(
            runs,
            "[[run]]\nkind = \"dynamic_bounce\"\nfile = \"sine_{i}.csv\"\nrole = \"fit\"\npeak_velocity = \
             {peak}\namplitude = {AMPLITUDE}\n"
        );
    }
    opened(folder, &runs)
}

fn opened(folder: &Path, runs: &str) -> Campaign {
    let channel = "[[channel]]\nname = \"pad\"\nlocation = \"pad\"\nside = \"left\"\naxis = \"z\"\nquantity = \
                   \"acceleration\"\nunit = \"m/s^2\"\n";
    let toml = format!("format = 1\nname = \"rig\"\nmodel = \"axle_c\"\n{channel}{runs}");
    fs::write(folder.join("campaign.toml"), toml).unwrap();
    Campaign::open(folder).unwrap()
}

/// Parameters of a car; what an effect adds is given beside them.
fn values(model: &dyn Model, effect: &[(&str, f64)]) -> Values {
    let [bushing, subframe] = BUSHINGS;
    let car = [
        ("k_wheel_z", SPRING),
        ("k_wheel_x", bushing),
        ("k_sf_x", subframe),
        ("m_corner", 430.0),
    ];
    let other = model
        .about()
        .parameters
        .iter()
        .filter_map(|p| Some((p.name.to_string(), middle(p.range?))));
    let has = |name: &str| model.about().parameters.iter().any(|p| p.name == name);
    let own = car.iter().chain(effect).filter(|(name, _)| has(name));
    let own = own.map(|(name, value)| (name.to_string(), *value));
    let given: BTreeMap<String, f64> = other.chain(own).collect();
    Values::resolve(model.about(), &given, &BTreeMap::new()).unwrap()
}

fn middle((low, high): (f64, f64)) -> f64 {
    (low * high).max(0.0).sqrt()
}

/// The largest difference between the forces that were measured and those of a model, N.
fn worst(model: &dyn Model, values: &Values, evidence: &Evidence) -> f64 {
    let predictions = predict(model, values, &[], evidence, Role::Fit).unwrap();
    let of = |p: &qcar_runtime::discover::observe::Prediction| {
        let measured = &evidence.series[p.series].value;
        let pairs = measured.iter().zip(&p.value);
        pairs
            .map(|(measured, said)| (measured - said).norm())
            .fold(0.0, f64::max)
    };
    predictions.iter().map(of).fold(0.0, f64::max)
}

fn bench(model: &str) -> Bench {
    let catalogue = effects::catalogue().map_err(|_| "the catalogue reads").unwrap();
    let model = compiled(model).map_err(|_| "the model compiles").unwrap().model;
    Bench::new(model, Arc::new(catalogue), Arc::new(BTreeMap::new()))
}

#[test]
fn a_progressive_spring_bends_the_middle_of_the_bounce_curve() {
    let folder = tempfile::tempdir().unwrap();
    // Half stiffer at 40 mm: the rate grows with the square of the travel.
    let force = |x: f64| SPRING * (x + 0.5 * x.powi(3) / (3.0 * 0.04 * 0.04));
    let campaign = campaign(folder.path(), "bounce", &cycle(0.08, force));
    let bench = bench("axle_c");
    let evidence = Evidence::from_campaign(&campaign, bench.model().about()).unwrap();
    assert!(evidence.series.len() == 1 && evidence.series[0].kind == Kind::Travel);
    let straight = worst(bench.model(), &values(bench.model(), &[]), &evidence);
    assert!(straight > 500.0, "{straight} N");
    let bent = bench.with("progressive_spring", "spring", None).unwrap();
    let values = values(bent.model(), &[("rate_increase_at_40mm", 0.5)]);
    let error = worst(bent.model(), &values, &evidence);
    assert!(error < 2.0, "{error} N");
}

/// The rig is slow: an inerter pushes nothing, whether it couples the wheel with the body or with a mass between.
#[test]
fn an_inerter_is_not_felt_on_a_slow_rig() {
    for axle in ["axle_c_rigid_tm", "axle_c"] {
        let folder = tempfile::tempdir().unwrap();
        let campaign = campaign(folder.path(), "bounce", &cycle(0.08, |x| SPRING * x));
        let bench = bench(axle).with("inerter", "damper", None).unwrap();
        let evidence = Evidence::from_campaign(&campaign, bench.model().about()).unwrap();
        let values = values(bench.model(), &[("inertance", 20.0)]);
        let error = worst(bench.model(), &values, &evidence);
        assert!(error < 0.1, "{axle}: {error} N");
    }
}

#[test]
fn the_longitudinal_curve_sees_bushing_and_sub_frame_in_series() {
    let folder = tempfile::tempdir().unwrap();
    let [bushing, subframe] = BUSHINGS;
    let campaign = campaign(
        folder.path(),
        "longitudinal",
        &cycle(0.004, |x| x / (1.0 / bushing + 1.0 / subframe)),
    );
    let bench = bench("axle_d");
    let evidence = Evidence::from_campaign(&campaign, bench.model().about()).unwrap();
    let error = worst(bench.model(), &values(bench.model(), &[]), &evidence);
    assert!(error < 0.1, "{error} N");
}

/// Without dampers of a known speed nobody can tell the friction in the width of a loop from what a damper adds.
#[test]
fn the_width_of_a_loop_needs_sines_beside_it() {
    let folder = tempfile::tempdir().unwrap();
    let alone = campaign(folder.path(), "bounce", &cycle(0.08, |x| SPRING * x));
    let bench = bench("axle_c_rigid_tm");
    let kinds = |campaign: &Campaign| {
        let evidence = Evidence::from_campaign(campaign, bench.model().about()).unwrap();
        evidence.series.iter().map(|series| series.kind).collect::<Vec<_>>()
    };
    assert_eq!(kinds(&alone), [Kind::Travel]);
    let folder = tempfile::tempdir().unwrap();
    let beside = with_sines(folder.path(), &cycle(0.08, |x| SPRING * x), &[0.5], 1500.0);
    let all = [
        Kind::Travel,
        Kind::Width,
        Kind::Cycle(1),
        Kind::Cycle(2),
        Kind::Cycle(3),
    ];
    assert_eq!(kinds(&beside), all);
}

/// A damper's force grows with the speed of the rig and a friction's does not: only a model with both has all loops.
#[test]
fn loops_of_several_speeds_tell_friction_from_a_damper() {
    const DAMPING: f64 = 1500.0;
    let folder = tempfile::tempdir().unwrap();
    let frequencies = [0.2, 0.6, 1.0];
    let campaign = with_sines(folder.path(), &cycle(0.08, |x| SPRING * x), &frequencies, DAMPING);
    let bench = bench("axle_c_rigid_tm");
    let evidence = Evidence::from_campaign(&campaign, bench.model().about()).unwrap();
    // A sine of N/m is as large as its force over the amplitude.
    let newtons = |model: &dyn Model, effect: &[(&str, f64)]| {
        let given: Vec<_> = effect.iter().copied().chain([("c_wheel_z", DAMPING)]).collect();
        let values = values(model, &given);
        let predictions = predict(model, &values, &[], &evidence, Role::Fit).unwrap();
        let of = |p: &qcar_runtime::discover::observe::Prediction| {
            let series = &evidence.series[p.series];
            let unit = if series.kind.complex() { AMPLITUDE } else { 1.0 };
            let pairs = series.value.iter().zip(&p.value);
            unit * pairs
                .map(|(measured, said)| (measured - said).norm())
                .fold(0.0, f64::max)
        };
        predictions.iter().map(of).collect::<Vec<_>>()
    };
    let without = newtons(bench.model(), &[]);
    assert!((without[1] - FRICTION).abs() < 1.5, "{without:?}");
    // A square wave has harmonics of 4/π and 4/3π of its height, and no even one.
    for harmonics in without[2..].chunks(3) {
        let [first, second, third] = harmonics.try_into().unwrap();
        assert!(
            first > FRICTION && second < 1.0 && third > 0.3 * FRICTION,
            "{without:?}"
        );
    }
    let both = bench.with("coulomb_friction", "damper", Some("in_damper")).unwrap();
    let with = newtons(both.model(), &[("f_coulomb", FRICTION), ("k_presliding", PRESLIDING)]);
    assert!(with.iter().all(|missing| *missing < 1.5), "{with:?}");
}

/// The largest difference between the derivatives of the forces by all parameters and differences of fourth order: a
/// part of the spring's force, for a parameter that changes by all of itself.
fn worst_slope(model: &dyn Model, given: &[(&str, f64)], evidence: &Evidence) -> (f64, String) {
    const PART: f64 = 1e-3;
    let here = values(model, given);
    let free = |parameter: usize| Free {
        parameter,
        lower: 0.0,
        upper: 2.0 * here.as_slice()[parameter],
    };
    let leaders = (0..here.as_slice().len()).filter(|&k| here.leader(k) == k);
    let free: Vec<Free> = leaders.map(free).collect();
    let all = predict(model, &here, &free, evidence, Role::Fit).unwrap();
    let mut worst = (0.0, String::new());
    for (k, free) in free.iter().enumerate() {
        let moved = [1.0, -1.0, 2.0, -2.0].map(|times| {
            let mut moved = here.clone();
            moved.set(free.parameter, here.as_slice()[free.parameter] * (1.0 + times * PART));
            predict(model, &moved, &[], evidence, Role::Fit).unwrap()
        });
        for (series, prediction) in all.iter().enumerate() {
            let complex = evidence.series[prediction.series].kind.complex();
            let scale = if complex { SPRING } else { SPRING * AMPLITUDE };
            for (value, slope) in prediction.slopes[k].iter().enumerate() {
                let [up, down, far_up, far_down] = moved.each_ref().map(|moved| moved[series].value[value]);
                let expected = ((up - down) * 8.0 - (far_up - far_down)) / (12.0 * PART);
                let error = (slope * here.as_slice()[free.parameter] - expected).norm() / scale;
                if error > worst.0 || error.is_nan() {
                    let name = &model.about().parameters[free.parameter].name;
                    worst = (
                        error,
                        format!("{name} in {series}: {expected} over its value, not {slope}"),
                    );
                }
            }
        }
    }
    worst
}

/// A sub-frame between spring and body, on a mount with friction that slips after 0.02 mm. Between two instants of the rig
/// it moves two hundred times as far, so full steps of Newton's method go back and forth between both signs of the friction.
const ON_A_RUBBING_MOUNT: &str = r#"
axle rubbing {
    "A spring on a sub-frame, whose mount rubs"

    known param m_corner: kg = 430 in 50..2000 "Static mass carried by the tyre";
    param m_wheel: kg = 40 in 5..200 "Unsprung mass";
    param k_wheel_z: N/m = 26e3 in 1e3..1e6 "Stiffness between wheel and sub-frame";
    param k_mount: N/m = 52e3 in 1e3..1e6 "Stiffness of the mount";
    param c_mount: N s/m = 100 in 1..1e4 "Damping of the mount";
    param f_rub: N = 420 in 1..1e4 "Its friction";

    direction z {
        road pad;
        mass body = m_corner - m_wheel - 20 kg;
        mass frame = 20 kg;
        mass wheel = m_wheel;
        link tire: wheel - pad { spring 2e5 N/m; damper 100 N s/m; }
        link spring: frame - wheel { spring k_wheel_z; }
        link mount: body - frame {
            spring k_mount;
            damper c_mount;
            state rub: N;
            rate rub = 21e6 N/m * (v - abs(v) * rub / f_rub);
            force = rub;
        }
        channel wheel_to_body = body.acceleration / wheel.acceleration;
    }
}
"#;

/// Spring and mount are in series. While the mount slips, the rig feels its friction in the ratio of the compliances. After a
/// reversal it sticks until the force of the spring has changed by twice the friction.
#[test]
fn friction_of_a_mount_in_series_with_the_spring_is_felt_by_the_rig() {
    const REACH: f64 = 0.08;
    let (mount, friction) = (2.0 * SPRING, 3.0 * FRICTION);
    let slips_within = REACH - 2.0 * friction / SPRING;
    let folder = tempfile::tempdir().unwrap();
    let in_series = SPRING * mount / (SPRING + mount);
    let curve = cycle(REACH, |x| in_series * x);
    let campaign = with_sines(folder.path(), &curve, &[0.2], 1500.0);
    let model = load_text("rubbing", ON_A_RUBBING_MOUNT)
        .map_err(|_| "the model compiles")
        .unwrap();
    let evidence = Evidence::from_campaign(&campaign, model.about()).unwrap();
    let values = values(&*model, &[("f_rub", friction), ("k_mount", mount), ("c_mount", 100.0)]);
    let mut slipping = 0;
    for prediction in predict(&*model, &values, &[], &evidence, Role::Fit).unwrap() {
        let series = &evidence.series[prediction.series];
        let is_slow = matches!(series.kind, Kind::Travel | Kind::Width);
        for ((at, measured), said) in series.at.iter().zip(&series.value).zip(&prediction.value) {
            assert!(said.norm().is_finite(), "{:?} at {at}", series.kind);
            if is_slow && at.abs() < 0.98 * slips_within {
                let error = (measured - said).norm();
                assert!(error < 1.0, "{:?} at {at}: {measured}, not {said}", series.kind);
                slipping += 1;
            }
        }
    }
    assert!(slipping > 20, "{slipping}");
}

/// The derivatives of the forces of a K&C rig agree with differences for a law with memory, a nonlinear spring, and
/// masses that an inerter couples.
#[test]
fn slopes_are_what_a_changed_parameter_does() {
    let folder = tempfile::tempdir().unwrap();
    let campaign = with_sines(folder.path(), &cycle(0.08, |x| SPRING * x), &[0.2, 1.0], 1500.0);
    let axle = bench("axle_c");
    let evidence = Evidence::from_campaign(&campaign, axle.model().about()).unwrap();
    let cases = [
        (
            "coulomb_friction",
            "damper",
            Some("in_damper"),
            &[("f_coulomb", 60.0), ("k_presliding", 1e5)][..],
        ),
        ("progressive_spring", "spring", None, &[("rate_increase_at_40mm", 0.5)]),
        ("inerter", "damper", None, &[("inertance", 20.0)]),
    ];
    for (effect, place, form, given) in cases {
        let with = axle.with(effect, place, form).unwrap();
        let worst = worst_slope(with.model(), given, &evidence);
        assert!(worst.0 < 1e-6, "{effect}: {worst:?}");
    }
}
