//! The campaigns in `models/campaigns` can be read to the last number, and say what is known of their systems.

use std::collections::BTreeMap;
use std::f64::consts::TAU;
use std::fs;
use std::path::{Path, PathBuf};

use nalgebra::{Complex, DMatrix, DVector};
use qcar_runtime::campaign::{Axis, Campaign, Quantity, Test, Truth};
use qcar_runtime::transmissibility::{Options, Point, Transmissibility, transmissibilities};

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../models/campaigns")
}

fn point(location: &str, quantity: Quantity) -> Point {
    Point::new(location, Axis::Z, quantity)
}

#[test]
fn every_file_is_sound_and_says_where_it_comes_from() {
    let folders: Vec<_> = fs::read_dir(folder())
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .collect();
    assert!(folders.len() >= 2);
    for folder in folders {
        let campaign = Campaign::open(&folder).unwrap();
        assert!(campaign.notices.is_empty(), "{:?}", campaign.notices);
        for run in &campaign.runs {
            match run.test {
                Test::Bounce | Test::Longitudinal => drop(campaign.curve(run).unwrap()),
                Test::DynamicBounce { .. } => drop(campaign.dynamic_curve(run).unwrap()),
                Test::Dynamometer(_) => drop(campaign.force_table(run).unwrap()),
                _ => drop(campaign.history(run).unwrap()),
            }
        }
        campaign
            .roads
            .iter()
            .for_each(|road| drop(campaign.road(road).unwrap()));
        assert!(
            fs::read_to_string(folder.join("README.md"))
                .unwrap()
                .contains("**Origin**")
        );
    }
}

/// The dynamic stiffness of links on masses, put together from incidence: response of each mass to unit road motion.
///
/// A link is `(upper, lower, k, c)`; without a lower mass it stands on the road.
fn response(masses: &[f64], links: &[(usize, Option<usize>, f64, f64)], f: f64) -> DVector<Complex<f64>> {
    let w = TAU * f;
    let mut stiffness = DMatrix::from_fn(masses.len(), masses.len(), |i, j| {
        if i == j {
            Complex::from(-w * w * masses[i])
        } else {
            Complex::ZERO
        }
    });
    let mut road = DVector::zeros(masses.len());
    for &(upper, lower, k, c) in links {
        let k = Complex::new(k, w * c);
        stiffness[(upper, upper)] += k;
        match lower {
            Some(lower) => {
                stiffness[(lower, lower)] += k;
                stiffness[(upper, lower)] -= k;
                stiffness[(lower, upper)] -= k;
            }
            None => road[upper] += k,
        }
    }
    stiffness.lu().solve(&road).unwrap()
}

/// Body, wheel, top mount, powertrain on the body: axle_a with the true parameters.
fn axle_a(campaign: &Campaign, f: f64) -> DVector<Complex<f64>> {
    let truth = Truth::read(&campaign.folder.join("truth.toml")).unwrap();
    let p: BTreeMap<_, _> = truth.parameters.into_iter().collect();
    let body = campaign.vehicle("m_corner").unwrap() - p["m_wheel"] - p["m_tm"] - p["m_pwt"];
    let links = [
        (1, None, p["k_tire"], p["c_tire"]),
        (0, Some(1), p["k_wheel_z"], 0.0),
        (2, Some(1), 0.0, p["c_wheel_z"]),
        (0, Some(2), p["k_tm"], p["c_tm"]),
        (3, Some(0), p["k_pwt_z"], p["c_pwt_z"]),
    ];
    response(&[body, p["m_wheel"], p["m_tm"], p["m_pwt"]], &links, f)
}

/// Sensors have gain errors of about 0.5 %, and the sides of this axle differ by 1 to 2 %.
#[test]
fn the_rig_sweeps_show_the_response_of_the_true_axle() {
    let campaign = Campaign::open(folder().join("axle_a_rig")).unwrap();
    let pad = point("pad", Quantity::Acceleration);
    let to = |location| (pad.clone(), point(location, Quantity::Acceleration));
    let places = [("wheel", 1, 30.0), ("body", 0, 18.0), ("pwt", 3, 15.0)];
    let pairs = places.map(|(location, ..)| to(location));
    for run in campaign.runs.iter().filter(|run| matches!(run.test, Test::Sweep(_))) {
        let history = campaign.history(run).unwrap();
        let measured = transmissibilities(&history, &pad, &pairs, &Options::default()).unwrap();
        for (measured, (location, place, highest)) in measured.iter().zip(places) {
            let errors = lines(measured, 1.0, highest).map(|(f, value, deviation)| {
                let ratio = value / axle_a(&campaign, f)[place];
                let allowed = 0.012 + 4.0 * deviation / value.norm();
                assert!(
                    (ratio - 1.0).norm() < allowed,
                    "{location} at {f} Hz in {}: {ratio}",
                    run.file
                );
                ratio.norm() - 1.0
            });
            let errors: Vec<f64> = errors.collect();
            let mean = errors.iter().sum::<f64>() / errors.len() as f64;
            assert!(mean.abs() < 0.007, "{location} in {}: {mean}", run.file);
        }
    }
}

fn lines(measured: &Transmissibility, first: f64, last: f64) -> impl Iterator<Item = (f64, Complex<f64>, f64)> {
    let lines = measured
        .frequency
        .iter()
        .zip(measured.value.iter().zip(&measured.variance));
    lines
        .map(|(f, (value, variance))| (*f, *value, variance.sqrt()))
        .filter(move |line| (first..=last).contains(&line.0))
}

/// The circuit resonates at 69.5 Hz with a damping ratio of 0.05: by a straight line through `1 / response`.
#[test]
fn the_silverbox_multisines_show_its_resonance() {
    let campaign = Campaign::open(folder().join("silverbox")).unwrap();
    let pair = (point("f", Quantity::Force), point("body", Quantity::Displacement));
    for run in &campaign.runs {
        let history = campaign.history(run).unwrap();
        let measured = transmissibilities(&history, &pair.0, std::slice::from_ref(&pair), &Options::default()).unwrap();
        let near: Vec<_> = lines(&measured[0], 50.0, 90.0).collect();
        let system = DMatrix::from_fn(
            near.len(),
            2,
            |i, j| if j == 0 { 1.0 } else { -(TAU * near[i].0).powi(2) },
        );
        let stiffness = DVector::from_fn(near.len(), |i, _| near[i].1.inv().re);
        let fitted = system.svd(true, true).solve(&stiffness, 0.0).unwrap();
        let resonance = (fitted[0] / fitted[1]).sqrt();
        let lost = near.iter().map(|(f, value, _)| value.inv().im / (TAU * f)).sum::<f64>() / near.len() as f64;
        let damping = lost / (2.0 * fitted[1] * resonance);
        assert!(
            (resonance / TAU - 69.5).abs() < 0.5,
            "{}: {} Hz",
            run.file,
            resonance / TAU
        );
        assert!((damping - 0.05).abs() < 0.005, "{}: {damping}", run.file);
    }
}
