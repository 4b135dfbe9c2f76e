//! Quasi-static K&C cycles as evidence, written in closed form and held against what compiled models say of them.

use std::collections::BTreeMap;
use std::fmt::Write;
use std::fs;
use std::path::Path;
use std::sync::Arc;

use qcar::catalogue::compiled;
use qcar::effects;
use qcar::workshop::Bench;
use qcar_runtime::campaign::{Campaign, Role};
use qcar_runtime::discover::Evidence;
use qcar_runtime::discover::candidate::Workshop;
use qcar_runtime::discover::evidence::Kind;
use qcar_runtime::discover::predict::predict;
use qcar_runtime::model::Model;
use qcar_runtime::response::parameters::Values;

const FRICTION: f64 = 140.0;
/// Stiffness of the wheel's bushing and of the sub-frame's, along x.
const BUSHINGS: [f64; 2] = [5e5, 2.4e6];
const SPRING: f64 = 26e3;

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

fn campaign(folder: &Path, kind: &str, curve: &str) -> Campaign {
    fs::write(folder.join("curve.csv"), curve).unwrap();
    let run = format!("[[run]]\nkind = \"{kind}\"\nfile = \"curve.csv\"\nrole = \"fit\"\n");
    let channel = "[[channel]]\nname = \"pad\"\nlocation = \"pad\"\nside = \"left\"\naxis = \"z\"\nquantity = \
                   \"acceleration\"\nunit = \"m/s^2\"\n";
    let toml = format!("format = 1\nname = \"rig\"\nmodel = \"axle_c\"\n{channel}{run}");
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
    let of = |p: &qcar_runtime::discover::predict::Prediction| {
        let measured = &evidence.series[p.series].value;
        let pairs = measured.iter().zip(&p.value);
        pairs
            .map(|(measured, said)| (measured - said).norm())
            .fold(0.0, f64::max)
    };
    predictions.iter().map(of).fold(0.0, f64::max)
}

fn bench(model: &str) -> Bench {
    let catalogue = effects::all().map_err(|_| "the catalogue reads").unwrap();
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
