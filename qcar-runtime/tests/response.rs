//! Transmissibilities of a hand-written model against its closed form, its matrices and finite differences.

use nalgebra::Complex;
use qcar_runtime::model::{Default, Model, Quantity, Signal, SignalKind};
use qcar_runtime::response::Response;
use qcar_runtime::response::parameters::{ParameterError, Values};
use qcar_runtime::response::ratio::{Ratio, Ratios, ratio};
use qcar_runtime::response::signal::{SignalError, locate};
use std::collections::BTreeMap;
use std::sync::atomic::Ordering::Relaxed;

use super::support::{self, Assembled, CHAIN, acceleration, chain};

const FREQUENCIES: [f64; 4] = [0.7, 3.0, 11.0, 27.0];

fn given(names: impl IntoIterator<Item = &'static str>) -> BTreeMap<String, f64> {
    let value = |name: &str| CHAIN.iter().find(|p| p.0 == name).map_or(1.0, |p| p.2);
    names.into_iter().map(|name| (name.to_owned(), value(name))).collect()
}

fn values(chain: &Assembled) -> Values {
    Values::resolve(chain.about(), &given(CHAIN.map(|p| p.0)), &BTreeMap::new()).unwrap()
}

fn transmissibility(chain: &Assembled, numerator: &Signal, denominator: &Signal) -> Ratio {
    ratio(chain, &values(chain), 0, numerator, denominator, &FREQUENCIES).unwrap()
}

#[track_caller]
fn assert_near(actual: Complex<f64>, expected: Complex<f64>, relative: f64) {
    assert!(
        (actual - expected).norm() <= relative * expected.norm(),
        "{actual} is not {expected}"
    );
}

/// The response a model gives and the one taken from its matrices, both about the same closed form.
fn both() -> [Assembled; 2] {
    [chain(true), chain(false)]
}

#[test]
fn ratios_from_the_pad_and_between_masses_are_those_of_the_closed_form() {
    for chain in both() {
        let pad_to_body = transmissibility(&chain, &acceleration("body"), &acceleration("pad"));
        let body_to_pwt = transmissibility(&chain, &acceleration("pwt"), &acceleration("body"));
        for (line, frequency) in FREQUENCIES.iter().enumerate() {
            let omega = std::f64::consts::TAU * frequency;
            let h = chain.closed_form(&support::truth(&CHAIN), omega);
            assert_near(pad_to_body.value[line], h[0] / (-omega * omega), 1e-11);
            assert_near(body_to_pwt.value[line], h[2] / h[0], 1e-11);
        }
    }
}

/// However many signals are asked for: a response has all of them.
#[test]
fn ratios_at_the_same_frequencies_share_one_response() {
    let [chain, other] = [chain(true), chain(true)];
    let [values, other_values] = [values(&chain), values(&other)];
    let mut ratios = Ratios::new(&chain, &values);
    let pad = acceleration("pad");
    for (frequencies, computed) in [(&FREQUENCIES[..], 1), (&FREQUENCIES[1..], 2)] {
        for location in ["wheel", "body", "pwt"] {
            let signals = [&acceleration(location), &pad];
            let shared = ratios.ratio(0, signals, frequencies).unwrap();
            let alone = ratio(&other, &other_values, 0, signals[0], signals[1], frequencies).unwrap();
            assert!(shared.value == alone.value && shared.jacobian.is_empty(), "{location}");
        }
        assert_eq!(chain.responses.load(Relaxed), computed);
    }
}

#[test]
fn a_slow_pad_moves_everything_with_it() {
    let chain = chain(true);
    let slow = ratio(
        &chain,
        &values(&chain),
        0,
        &acceleration("pwt"),
        &acceleration("pad"),
        &[1e-3],
    )
    .unwrap();
    assert_near(slow.value[0], Complex::from(1.0), 1e-5);
}

#[test]
fn derivatives_of_a_motion_are_powers_of_frequency() {
    let position = Signal {
        kind: SignalKind::Motion(Quantity::Position),
        ..acceleration("wheel")
    };
    for chain in both() {
        let ratio = transmissibility(&chain, &position, &acceleration("wheel"));
        for (line, frequency) in FREQUENCIES.iter().enumerate() {
            let omega = std::f64::consts::TAU * frequency;
            assert_near(ratio.value[line], Complex::from(-1.0 / (omega * omega)), 1e-12);
        }
    }
}

#[test]
fn the_parameter_jacobian_is_that_of_finite_differences() {
    for chain in both() {
        let ratio = transmissibility(&chain, &acceleration("pwt"), &acceleration("wheel"));
        for (parameter, slope) in ratio.jacobian.iter().filter(|(parameter, _)| *parameter < 9) {
            let value = |scale: f64, line: usize| {
                let mut p = support::truth(&CHAIN);
                p[*parameter] *= scale;
                let h = chain.closed_form(&p, std::f64::consts::TAU * FREQUENCIES[line]);
                h[2] / h[1]
            };
            for (line, slope) in slope.iter().enumerate() {
                let step = 1e-5 * support::truth(&CHAIN)[*parameter];
                let expected = (value(1.0 + 1e-5, line) - value(1.0 - 1e-5, line)) / (2.0 * step);
                let size = expected
                    .norm()
                    .max(1e-3 * ratio.value[line].norm() / support::truth(&CHAIN)[*parameter]);
                assert!((slope - expected).norm() < 1e-5 * size, "{parameter} {line}");
            }
        }
    }
}

#[test]
fn a_tied_parameter_follows_and_adds_its_slope() {
    let tied = chain(true).with_default(8, Default::Same(6));
    let free = chain(true);
    let others = CHAIN.map(|p| p.0).into_iter().filter(|name| *name != "c_pwt_z");
    let values = Values::resolve(tied.about(), &given(others), &BTreeMap::new()).unwrap();
    assert_eq!(values.as_slice()[8], values.as_slice()[6]);
    let together = ratio(
        &tied,
        &values,
        0,
        &acceleration("pwt"),
        &acceleration("pad"),
        &FREQUENCIES,
    )
    .unwrap();
    let mut all = self::values(&free);
    all.set(8, all.as_slice()[6]);
    let apart = ratio(&free, &all, 0, &acceleration("pwt"), &acceleration("pad"), &FREQUENCIES).unwrap();
    let slope = |ratio: &Ratio, parameter: usize| ratio.jacobian.iter().find(|j| j.0 == parameter).unwrap().1[1];
    assert_near(slope(&together, 6), slope(&apart, 6) + slope(&apart, 8), 1e-12);
    assert!(together.jacobian.iter().all(|j| j.0 != 8));
}

#[test]
fn a_value_breaks_a_tie_and_the_vehicle_fills_gaps() {
    let tied = chain(true).with_default(8, Default::Same(6));
    let names = CHAIN.map(|p| p.0).into_iter().filter(|name| *name != "m_corner");
    let values = Values::resolve(tied.about(), &given(names), &given(["m_corner", "r_tire"])).unwrap();
    assert_eq!(values.as_slice(), support::truth(&CHAIN));
}

#[test]
fn every_parameter_at_fault_is_named_at_once() {
    let chain = chain(true);
    let mut given = given([
        "m_corner",
        "m_wheel",
        "m_pwt",
        "k_tyre",
        "c_tire",
        "k_wheel_z",
        "c_wheel_z",
        "k_pwt_z",
    ]);
    given.insert("c_pwt_z".into(), f64::NAN);
    let errors = Values::resolve(chain.about(), &given, &BTreeMap::new()).unwrap_err();
    let names: Vec<&str> = errors.iter().map(ParameterError::name).collect();
    assert_eq!(names, ["k_tyre", "k_tire", "c_pwt_z", "k_wheel_x"]);
    let said = errors[0].to_string();
    assert!(
        said.contains("no parameter `k_tyre`") && said.contains("did you mean `k_tire`"),
        "{said}"
    );
}

#[test]
fn a_signal_that_the_model_cannot_give_is_refused_with_what_it_has() {
    let chain = chain(true);
    let response = Response::new(&chain, 0, &FREQUENCIES);
    let find = |signal: &Signal| locate(chain.about(), response.layout(), 0, signal).unwrap_err();
    let unknown = find(&acceleration("sf"));
    assert!(matches!(unknown, SignalError::Unknown { .. }));
    assert!(
        unknown.to_string().contains("it has `body`, `wheel`, `pwt`, `pad`"),
        "{unknown}"
    );
    let force = Signal {
        kind: SignalKind::Force,
        ..acceleration("damper")
    };
    assert!(find(&force).to_string().contains("add `output damper.force;`"));
}
