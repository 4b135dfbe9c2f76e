//! Units whose tyre rolls over a profile, in FMPy: their tyre forces are those of qcar's own rides.

use std::fs;
use std::path::Path;

use qcar::catalogue;
use qcar::parameters;
use qcar_runtime::campaign::{Campaign, RoadSamples};
use qcar_runtime::road::Road;
use qcar_runtime::simulate::{Car, Drive, Method, Ride, Settings, Variant, ride, tyre};
use serde_json::Value;

use crate::programs::{python_with, qcar, run};

const CAMPAIGN: &str = "models/campaigns/axle_a_rig";
const CLEAT: &str = "models/campaigns/axle_a_rig/road/cleat_30.csv.gz";
const RATE: f64 = 1000.0;
const SAMPLES: usize = 601;

/// How far forces may be from ours, in parts of the largest change of each.
const TOLERANCE: f64 = 1e-6;

/// What is changed in the unit after it was exported.
#[derive(Clone, Copy)]
struct Changed {
    parameter: Option<(&'static str, f64)>,
    /// m/s.
    speed: f64,
}

const AS_EXPORTED: Changed = Changed {
    parameter: None,
    speed: 30.0 / 3.6,
};

#[test]
fn a_linear_axle_rolls_over_a_cleat_as_here() {
    compare("axle_a", AS_EXPORTED);
}

#[test]
fn what_is_changed_in_a_unit_that_rolls_is_changed_in_the_ride() {
    let changed = Changed {
        parameter: Some(("k_tm", 500e3)),
        speed: 12.0,
    };
    compare("axle_a", changed);
}

#[test]
fn an_axle_with_friction_rolls_over_a_cleat_as_here() {
    let folder = tempfile::tempdir().unwrap();
    let patched = folder.path().join("friction.axle");
    let patched = patched.to_str().unwrap();
    qcar(&[
        "patch",
        "axle_a",
        "coulomb_friction",
        "--at",
        "damper",
        "--params",
        CAMPAIGN,
        "--out",
        patched,
    ]);
    compare(patched, AS_EXPORTED);
}

/// Both kinds and both versions against the ride.
fn compare(model: &str, changed: Changed) {
    let Some(python) = python_with("fmpy", "units whose tyre rolls") else {
        return;
    };
    let own = driven(model, changed);
    assert!(
        own.force[1].iter().any(|force| force.abs() > 100.0),
        "the cleat is felt"
    );
    let folder = tempfile::tempdir().unwrap();
    for fmi in ["2", "3"] {
        let unit = folder.path().join(format!("unit{fmi}.fmu"));
        let unit = unit.to_str().unwrap();
        let road = format!("{CLEAT}@30km/h");
        let export = ["export", model, "--params", CAMPAIGN, "--as", "fmu", "--fmi", fmi];
        qcar(&[&export[..], &["--road", &road, "--out", unit]].concat());
        let result = folder.path().join("result.json");
        let given = changed.parameter.map(|(name, value)| format!("{name}={value}"));
        let speed = format!("v_car={:?}", changed.speed);
        let (samples, rate) = (SAMPLES.to_string(), RATE.to_string());
        let mut arguments = vec![
            concat!(env!("CARGO_MANIFEST_DIR"), "/tests/export/rolling.py"),
            unit,
            result.to_str().unwrap(),
            &samples,
            &rate,
            &speed,
        ];
        arguments.extend(given.as_deref());
        run(&python, &arguments, folder.path());
        let answer: Value = serde_json::from_str(&fs::read_to_string(&result).unwrap()).unwrap();
        assert_eq!(answer["problems"], Value::Array(Vec::new()));
        // The contact has no Jacobians, and says so before an importer asks.
        assert_eq!(answer["promises"], serde_json::json!(["false", "false"]), "FMI {fmi}");
        for kind in ["model_exchange", "co_simulation"] {
            check(&answer[kind], &own, &format!("{kind} of FMI {fmi}"));
        }
    }
}

/// The ride by qcar's own contact and integrator, at a tolerance that is tighter by two orders.
fn driven(model: &str, changed: Changed) -> Ride {
    let campaign = Campaign::open(Path::new(CAMPAIGN)).unwrap();
    let (tyre, load) = tyre(&campaign).unwrap();
    let model = catalogue::load(model).unwrap();
    let set: Vec<_> = changed
        .parameter
        .iter()
        .map(|(name, value)| format!("{name}={value}").parse().unwrap())
        .collect();
    let values = parameters::resolve(model.about(), Some(Path::new(CAMPAIGN)), &set).unwrap();
    let samples = RoadSamples::measured(Path::new(CLEAT), None).unwrap();
    let road = Road::from_samples(&samples.x, &samples.z, &samples.slope).unwrap();
    let car = Car {
        model: &*model,
        parameters: values.as_slice(),
        tyre,
        load,
        variant: Variant::Complete,
    };
    let drive = Drive {
        road: &road.reaching(20.0),
        speed: changed.speed,
        sample_rate: RATE,
        samples: SAMPLES,
    };
    let settings = Settings {
        method: Method::Adaptive(1e-11),
        ..Settings::default()
    };
    ride(&car, &drive, &settings).unwrap()
}

fn check(found: &Value, own: &Ride, what: &str) {
    let of = |name: &str| -> Vec<f64> { serde_json::from_value(found[name].clone()).unwrap() };
    for (name, own) in ["force_tire_z", "force_tire_x"].into_iter().zip(&own.force) {
        let off = furthest(own, &of(name));
        println!("{name} of {what}: {off:.1e} of its largest change");
        assert!(off < TOLERANCE, "{name} of {what}: {off:e} of its largest change");
    }
    // What is told of the body is what moves it.
    assert_eq!(of("z_body_acceleration"), of("der_vz_body"), "{what}");
}

fn furthest(own: &[f64], other: &[f64]) -> f64 {
    let change = own.iter().fold(0.0_f64, |most, force| most.max((force - own[0]).abs()));
    let off = own.iter().zip(other).map(|(a, b)| (a - b).abs());
    off.fold(0.0, f64::max) / change
}
