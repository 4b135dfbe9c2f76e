//! Natural vibrations against closed forms: a chain of masses whose modes are textbook algebra.

use std::collections::BTreeMap;
use std::f64::consts::TAU;

use nalgebra::Complex;
use qcar_runtime::model::Model;
use qcar_runtime::modes::{Mode, Part, modes, pairs};
use qcar_runtime::response::parameters::Values;

use super::support::{CHAIN, chain};

fn of_chain(change: &[(&str, f64)]) -> (Vec<f64>, Vec<Mode>) {
    let model = chain(true);
    let mut given: BTreeMap<String, f64> = CHAIN
        .iter()
        .map(|(name, _, value)| (name.to_string(), *value))
        .collect();
    given.extend(change.iter().map(|(name, value)| (name.to_string(), *value)));
    let values = Values::resolve(model.about(), &given, &BTreeMap::new()).unwrap();
    (values.as_slice().to_vec(), modes(&model, &values))
}

/// `M λ² + C λ + K` of pad, wheel, body and powertrain in a chain, times a shape: no force is left in a mode.
#[test]
fn no_force_is_left_in_a_mode() {
    let (p, modes) = of_chain(&[]);
    assert_eq!(modes.len(), 3);
    for mode in &modes {
        let omega = TAU * mode.frequency;
        let root = Complex::new(-mode.damping, (1.0 - mode.damping.powi(2)).sqrt()) * omega;
        let z = |location: &str| {
            let part = mode.shape.iter().find(|part| part.location == location);
            part.map_or(Complex::ZERO, |part| part.amplitude)
        };
        let link = |k: f64, c: f64| root * c + k;
        let (body, wheel, pwt) = (z("body"), z("wheel"), z("pwt"));
        let (tire, strut, mount) = (link(p[3], p[4]), link(p[5], p[6]), link(p[7], p[8]));
        let forces = [
            root * root * p[1] * wheel + tire * wheel + strut * (wheel - body),
            root * root * (p[0] - p[1] - p[2]) * body + strut * (body - wheel) + mount * (body - pwt),
            root * root * p[2] * pwt + mount * (pwt - body),
        ];
        for force in forces {
            assert!(force.norm() < 1e-6 * p[3], "{force} at {} Hz", mode.frequency);
        }
        let largest = mode.shape.iter().map(|part| part.amplitude.norm()).fold(0.0, f64::max);
        assert!((largest - 1.0).abs() < 1e-9);
    }
    assert!(modes.windows(2).all(|pair| pair[0].frequency <= pair[1].frequency));
}

/// Without damping the squares of the frequencies solve `det(K - ω² M) = 0`, whose roots have a known product and sum.
#[test]
fn frequencies_without_damping_are_the_roots_of_the_determinant() {
    let none = [("c_tire", 0.0), ("c_wheel_z", 0.0), ("c_pwt_z", 0.0)];
    let (p, modes) = of_chain(&none);
    let squares: Vec<f64> = modes.iter().map(|mode| (TAU * mode.frequency).powi(2)).collect();
    let (wheel, body, pwt) = (p[1], p[0] - p[1] - p[2], p[2]);
    let product = p[3] * p[5] * p[7] / (wheel * body * pwt);
    let sum = (p[3] + p[5]) / wheel + (p[5] + p[7]) / body + p[7] / pwt;
    assert!((squares.iter().product::<f64>() / product - 1.0).abs() < 1e-9);
    assert!((squares.iter().sum::<f64>() / sum - 1.0).abs() < 1e-9);
    assert!(modes.iter().all(|mode| mode.damping.abs() < 1e-9));
}

/// What decays without vibrating is no mode.
#[test]
fn an_overdamped_wheel_leaves_its_mode() {
    let (_, modes) = of_chain(&[("c_tire", 50e3)]);
    assert_eq!(modes.len(), 2);
}

/// Two vibrations of one point each, whose frequencies cross as a spring is changed, keep their partners.
#[test]
fn vibrations_are_paired_by_their_shapes() {
    let mode = |frequency: f64, shape: &[(&str, f64)]| Mode {
        frequency,
        damping: 0.1,
        shape: shape
            .iter()
            .map(|&(location, amplitude)| Part {
                location: location.into(),
                axis: "z".into(),
                amplitude: Complex::from(amplitude),
            })
            .collect(),
    };
    let first = [
        mode(1.0, &[("body", 1.0)]),
        mode(9.0, &[("wheel", 1.0)]),
        mode(10.0, &[("pwt", 1.0), ("body", -0.1)]),
    ];
    let second = [
        mode(1.1, &[("body", -1.0), ("seat", 0.9)]),
        mode(9.5, &[("pwt", 1.0), ("wheel", 0.2)]),
        mode(11.0, &[("wheel", 1.0)]),
    ];
    assert_eq!(pairs(&first, &second), [(0, 0), (1, 2), (2, 1)]);
    // What a model without a powertrain has is like no vibration of the powertrain.
    assert_eq!(pairs(&first[2..], &second[..1]), []);
    let (_, chain) = of_chain(&[]);
    let (_, stiffer) = of_chain(&[("k_tire", 1.2 * CHAIN[3].2)]);
    assert_eq!(pairs(&chain, &stiffer), [(0, 0), (1, 1), (2, 2)]);
}
