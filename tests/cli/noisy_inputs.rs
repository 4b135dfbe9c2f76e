//! Records whose input is recorded with more noise than the responses. The machine did not feel that noise, but a model
//! that replays the record does.

use std::f64::consts::TAU;
use std::fs;
use std::path::Path;

use serde_json::Value;

use crate::common::succeeds;
use crate::records::parameter;

type Complex64 = nalgebra::Complex<f64>;

const RATE: f64 = 250.0;
const SAMPLES: usize = 2000;
/// Noise of the recorded road and of the recorded accelerations, relative to the RMS of the signal.
const NOISE: [f64; 3] = [0.01, 0.004, 0.004];
/// Mass of the corner and of the wheel (kg).
const MASSES: [f64; 2] = [454.0, 44.0];
const TIRE: [f64; 2] = [215e3, 100.0];
const STRUT: [f64; 2] = [27e3, 1650.0];

/// Accelerations of the body and of the wheel over the displacement of the road, as closed forms. `hanging` gives the
/// mass, stiffness and damping of a mass on the body, which is a part of the corner's.
fn response(omega: f64, hanging: Option<[f64; 3]>) -> [Complex64; 2] {
    let dynamic = |[k, c]: [f64; 2]| Complex64::new(k, omega * c);
    let square = omega * omega;
    let [strut, tire] = [STRUT, TIRE].map(dynamic);
    let body = hanging.map_or(Complex64::from(MASSES[0] - MASSES[1]), |[m, k, c]| {
        let mount = dynamic([k, c]);
        MASSES[0] - MASSES[1] - m + mount * m / (mount - square * m)
    });
    let follows = strut / (strut - square * body);
    let wheel = tire / (tire + strut - square * MASSES[1] - strut * follows);
    [-square * wheel * follows, -square * wheel]
}

/// Road, body and wheel of a run without noise: sines from 0.5 to 28 Hz, of which each is as steep.
fn run(place: usize, level: f64, hanging: Option<[f64; 3]>) -> [Vec<f64>; 3] {
    let mut columns = [(); 3].map(|()| vec![0.0; SAMPLES]);
    for k in 1..=220 {
        let f = 0.375 + 0.1255 * k as f64;
        let phase = (7.3 * (k * k) as f64 + 2.1 * (place * k) as f64).sin() * TAU;
        let road = Complex64::from_polar(2e-3 * level / f, phase);
        let [body, wheel] = response(TAU * f, hanging);
        for (column, amplitude) in columns.iter_mut().zip([road, road * body, road * wheel]) {
            for (sample, value) in column.iter_mut().enumerate() {
                *value += (amplitude * Complex64::from_polar(1.0, TAU * f * sample as f64 / RATE)).re;
            }
        }
    }
    columns
}

/// Adds noise that is uniformly distributed.
fn with_noise(columns: &mut [Vec<f64>; 3], mut state: u64) {
    for (column, noise) in columns.iter_mut().zip(NOISE) {
        let rms = (column.iter().map(|own| own * own).sum::<f64>() / SAMPLES as f64).sqrt();
        for value in column {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            let uniform = (state >> 11) as f64 / (1u64 << 53) as f64 - 0.5;
            *value += noise * rms * uniform * 12f64.sqrt();
        }
    }
}

fn answer(folder: &Path, hanging: Option<[f64; 3]>) -> Value {
    let mut text = "format = 1\nname = \"road\"\nmodel = \"quarter_car\"\n\n".to_owned();
    for (name, value) in [("m_corner", MASSES[0]), ("m_wheel", MASSES[1])] {
        text += &format!("[parameters.{name}]\nvalue = {value:?}\nunit = \"kg\"\nfit = false\n\n");
    }
    text += &parameter("k_tire", 180e3, "N/m", "range = [5e4, 1e6]\n");
    text += &parameter("c_tire", 150.0, "N s/m", "range = [5.0, 2e3]\n");
    text += &parameter("k_wheel_z", 33e3, "N/m", "range = [5e3, 2e5]\n");
    text += &parameter("c_wheel_z", 1300.0, "N s/m", "range = [100.0, 9e3]\n");
    for (location, quantity, unit) in [
        ("pad", "displacement", "m"),
        ("body", "acceleration", "m/s^2"),
        ("wheel", "acceleration", "m/s^2"),
    ] {
        text += &format!(
            "[[channel]]\nname = \"{location}\"\nlocation = \"{location}\"\nside = \"centre\"\naxis = \"z\"\n\
             quantity = \"{quantity}\"\nunit = \"{unit}\"\n\n"
        );
    }
    for (place, (level, role)) in [(1.0, "fit"), (0.6, "fit"), (1.3, "held_out")].into_iter().enumerate() {
        let mut columns = run(place, level, hanging);
        with_noise(&mut columns, place as u64);
        let mut table = "time,pad,body,wheel\n".to_owned();
        let [road, body, wheel] = &columns;
        for (sample, ((road, body), wheel)) in road.iter().zip(body).zip(wheel).enumerate() {
            table += &format!("{},{road},{body},{wheel}\n", sample as f64 / RATE);
        }
        fs::write(folder.join(format!("run_{place}.csv")), table).unwrap();
        text += &format!(
            "[[run]]\nkind = \"time_history\"\nfile = \"run_{place}.csv\"\nrole = \"{role}\"\nsample_rate = {RATE}\n\
             band_limited = true\n\n"
        );
    }
    fs::write(folder.join("campaign.toml"), text).unwrap();
    serde_json::from_str(&succeeds(&["discover", folder.to_str().unwrap(), "--format", "json"])).unwrap()
}

/// A resonator on the wheel or a tyre with dynamic stiffness would filter the noise of the road, and explain responses
/// that are smaller than those of the recorded road.
#[test]
fn noise_of_the_recorded_road_is_no_effect() {
    let folder = tempfile::tempdir().unwrap();
    let answer = answer(folder.path(), None);
    assert_eq!(answer["verdict"], "none", "{answer}");
    let notices = answer["notices"].as_array().unwrap();
    let is_it = |own: &&Value| {
        own.as_str()
            .unwrap()
            .contains("recorded input pad z displacement is noise")
    };
    assert_eq!(notices.iter().filter(is_it).count(), 3, "{notices:?}");
    // With the noise that the filter leaves, the residuals are as large as expected.
    let left = answer["gap"]["held_out"]["before"].as_f64();
    assert!(left.is_some_and(|left| (0.7..1.3).contains(&left)), "{answer}");
}

#[test]
#[ignore = "a whole search; .ci/run runs it"]
fn an_effect_is_found_in_spite_of_a_noisy_road() {
    let folder = tempfile::tempdir().unwrap();
    let (m, omega) = (95.0, TAU * 9.5);
    let (k, c) = (m * omega * omega, 2.0 * 0.07 * m * omega);
    let answer = answer(folder.path(), Some([m, k, c]));
    assert_eq!(answer["verdict"], "found", "{answer}");
    let [own] = answer["effects"].as_array().unwrap().as_slice() else {
        panic!("one effect: {}", answer["effects"])
    };
    assert_eq!(
        (own["name"].as_str(), own["at"].as_str()),
        (Some("suspended_mass"), Some("body"))
    );
    for (name, truth) in [("m_pwt", m), ("k_pwt_z", k), ("c_pwt_z", c)] {
        let value = own["parameters"][name].as_f64().unwrap();
        assert!((value / truth - 1.0).abs() < 0.03, "{name} = {value}, truth {truth}");
    }
}
