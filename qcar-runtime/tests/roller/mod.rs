//! A model written by hand for the tests: body and wheel in z and in x on a tyre that can roll, with its own
//! bookkeeping of energy.

use std::borrow::Cow;

use qcar_runtime::model::{
    About, Contact, ContactAbout, ContactAxis, Default, Excitation, Input, InputKind, Link, Model, Output, Parameter,
    Quantity, ResponseMut, Signal, SignalKind, State, StateKind,
};
use qcar_runtime::simulate::{Car, Variant};
use qcar_runtime::tyre::{Geometry, Rates, Tyre};

pub const GRAVITY: f64 = 9.81;
/// Weight of body and wheel, N.
pub const LOAD: f64 = 445.0 * GRAVITY;
pub const RADIUS: f64 = 0.32;
pub const STATIC_DEFLECTION: f64 = 0.025;

const PARAMETERS: [(&str, f64); 11] = [
    ("m_body", 400.0),
    ("m_wheel", 45.0),
    ("k_tire", 220e3),
    ("c_tire", 250.0),
    ("static_tire_def", STATIC_DEFLECTION),
    ("k_z", 35e3),
    ("c_z", 2500.0),
    ("m_half", 800.0),
    ("k_x", 450e3),
    ("c_x", 700.0),
    ("k_stop", 0.0),
];

/// Outputs: the accelerations of body and wheel in z and x, the heights of body and wheel, the wheel's place in x, and
/// the energy that cannot be accounted for (J).
pub const OUTPUTS: [&str; 8] = [
    "z_body_acceleration",
    "z_wheel_acceleration",
    "x_body_acceleration",
    "x_wheel_acceleration",
    "z_body",
    "z_wheel",
    "x_wheel",
    "imbalance",
];

const STATES: [(&str, &str, StateKind); 10] = [
    ("z_body", "z", StateKind::Position),
    ("z_wheel", "z", StateKind::Position),
    ("vz_body", "z", StateKind::Velocity),
    ("vz_wheel", "z", StateKind::Velocity),
    ("x_body", "x", StateKind::Position),
    ("x_wheel", "x", StateKind::Position),
    ("vx_body", "x", StateKind::Velocity),
    ("vx_wheel", "x", StateKind::Velocity),
    ("energy.lost", "z", StateKind::Inner),
    ("energy.fed", "z", StateKind::Inner),
];

pub struct Roller {
    about: About,
}

impl Roller {
    pub fn new() -> Self {
        Self { about: about() }
    }
}

/// Values of the parameters.
pub fn parameters() -> Vec<f64> {
    PARAMETERS.iter().map(|parameter| parameter.1).collect()
}

pub fn tyre() -> Tyre {
    Tyre::new(RADIUS, STATIC_DEFLECTION, Geometry::Area, Rates::AtStaticDeflection).expect("it is a tyre")
}

pub fn car<'a>(model: &'a Roller, parameters: &'a [f64], variant: Variant) -> Car<'a, Roller> {
    Car {
        model,
        parameters,
        tyre: tyre(),
        load: LOAD,
        variant,
    }
}

/// Compression of the suspension from the design position at which the bump stop is met, m.
pub const GAP: f64 = 0.02;
/// Place of the stiffness of that stop among the parameters; zero by default.
pub const K_STOP: usize = 10;

fn into_stop(x: &[f64]) -> f64 {
    (x[0] - x[1] + GAP).min(0.0)
}

/// Accelerations of body and wheel in z and x under a force on the wheel.
fn accelerations(p: &[f64], x: &[f64], g: f64, force: [f64; 2]) -> [f64; 4] {
    let suspension = p[5] * (x[0] - x[1]) + p[6] * (x[2] - x[3]) + p[K_STOP] * into_stop(x);
    let bushing = p[8] * (x[4] - x[5]) + p[9] * (x[6] - x[7]);
    [
        -g - suspension / p[0],
        -g + (suspension + force[0]) / p[1],
        -bushing / (p[7] - p[1]),
        (bushing + force[1]) / p[1],
    ]
}

/// Kinetic and potential energy of masses and springs without the tyre.
fn stored(p: &[f64], x: &[f64], g: f64) -> f64 {
    let kinetic = p[0] * x[2].powi(2) + p[1] * x[3].powi(2) + (p[7] - p[1]) * x[6].powi(2) + p[1] * x[7].powi(2);
    let springs = p[5] * (x[0] - x[1]).powi(2) + p[8] * (x[4] - x[5]).powi(2) + p[K_STOP] * into_stop(x).powi(2);
    0.5 * (kinetic + springs) + g * (p[0] * x[0] + p[1] * x[1])
}

fn motion(p: &[f64], x: &[f64], g: f64, force: [f64; 2], dx: &mut [f64]) {
    let [body_z, wheel_z, body_x, wheel_x] = accelerations(p, x, g, force);
    let lost = p[6] * (x[2] - x[3]).powi(2) + p[9] * (x[6] - x[7]).powi(2);
    let fed = force[0] * x[3] + force[1] * x[7];
    dx.copy_from_slice(&[x[2], x[3], body_z, wheel_z, x[6], x[7], body_x, wheel_x, lost, fed]);
}

fn seen(p: &[f64], x: &[f64], g: f64, force: [f64; 2], y: &mut [f64]) {
    let [body_z, wheel_z, body_x, wheel_x] = accelerations(p, x, g, force);
    y.copy_from_slice(&[
        body_z,
        wheel_z,
        body_x,
        wheel_x,
        x[0],
        x[1],
        x[5],
        stored(p, x, g) + x[8] - x[9],
    ]);
}

/// The force of the tyre on the rig: a line.
fn on_rig(p: &[f64], x: &[f64], u: &[f64]) -> [f64; 2] {
    [-p[2] * (x[1] - u[0]) - p[3] * (x[3] - u[1]), 0.0]
}

impl Model for Roller {
    fn about(&self) -> &About {
        &self.about
    }

    fn prepare(&self, p: &[f64], constants: &mut [f64]) {
        constants.copy_from_slice(p);
    }

    fn derivative(&self, p: &[f64], x: &[f64], u: &[f64], dx: &mut [f64]) {
        motion(p, x, u[2], on_rig(p, x, u), dx);
    }

    fn outputs(&self, p: &[f64], x: &[f64], u: &[f64], y: &mut [f64]) {
        seen(p, x, u[2], on_rig(p, x, u), y);
    }

    /// A parabola through the static point with the slope of the rig's line there.
    fn contact_force(&self, p: &[f64], _: &[f64], s: f64, v: f64) -> f64 {
        let (deflection, mean) = ((-s).max(0.0), (p[0] + p[1]) * GRAVITY / p[4]);
        p[3] * v - (2.0 * mean - p[2]) * deflection - (p[2] - mean) / p[4] * deflection * deflection
    }

    fn rolling_derivative(&self, p: &[f64], x: &[f64], u: &[f64], contact: &Contact, dx: &mut [f64]) {
        motion(p, x, u[2], contact.force, dx);
    }

    fn rolling_outputs(&self, p: &[f64], x: &[f64], u: &[f64], contact: &Contact, y: &mut [f64]) {
        seen(p, x, u[2], contact.force, y);
    }

    fn matrices(&self, _: &[f64], _: &[f64], _: &[f64], _: &mut [f64]) {}

    fn sensitivities(&self, _: &[f64], _: &[f64], _: &[f64], _: &mut [f64]) {}

    fn parameter_jacobian(&self, _: &[f64], _: &[f64], _: &[f64], _: &mut [f64]) {}

    fn response(&self, _: usize, _: &[f64], _: &[f64], _: ResponseMut<'_>) {}
}

fn about() -> About {
    let parameter = |&(name, _): &(&'static str, f64)| Parameter {
        name: name.into(),
        unit: "".into(),
        doc: "".into(),
        default: Default::None,
        range: None,
        known: false,
        clock: None,
    };
    let state = |&(name, axis, kind): &(&'static str, &'static str, StateKind)| State {
        name: name.into(),
        unit: "".into(),
        location: "".into(),
        axis: axis.into(),
        kind,
    };
    let input = |name: &'static str, kind| Input {
        name: name.into(),
        unit: "".into(),
        axis: "z".into(),
        kind,
    };
    let signal = |name: &'static str| {
        let (axis, location) = name.split_once('_').unwrap_or_default();
        Signal {
            location: location.trim_end_matches("_acceleration").into(),
            axis: axis.into(),
            kind: SignalKind::Motion(if name.ends_with("_acceleration") {
                Quantity::Acceleration
            } else {
                Quantity::Position
            }),
        }
    };
    let output = |name: &&'static str| Output {
        name: (*name).into(),
        unit: "".into(),
        signal: signal(name),
    };
    let axis = |axis: &'static str, position, velocity| ContactAxis {
        axis: axis.into(),
        position,
        velocity,
    };
    About {
        name: "roller".into(),
        doc: "Body and wheel in z and x".into(),
        parameters: PARAMETERS.iter().map(parameter).collect(),
        states: STATES.iter().map(state).collect(),
        inputs: vec![
            input("z_pad", InputKind::Motion(0, Quantity::Position)),
            input("vz_pad", InputKind::Motion(0, Quantity::Velocity)),
            input("g", InputKind::Gravity),
        ]
        .into(),
        outputs: OUTPUTS.iter().map(output).collect(),
        excitations: vec![Excitation {
            name: "pad".into(),
            axis: "z".into(),
            force: false,
            road: true,
        }]
        .into(),
        channels: Cow::Borrowed(&[]),
        links: vec![Link {
            name: "tire".into(),
            axis: "z".into(),
            ends: vec!["wheel".into(), "pad".into()].into(),
            parameters: Cow::Borrowed(&[]),
        }]
        .into(),
        masses: Cow::Borrowed(&[]),
        contact: Some(ContactAbout {
            link: 0,
            axes: vec![axis("z", 1, 3), axis("x", 5, 7)].into(),
        }),
        constants: PARAMETERS.len(),
        linear: false,
        matrices: Cow::Borrowed(&[]),
        sensitivities: Cow::Borrowed(&[]),
        parameter_jacobian: Cow::Borrowed(&[]),
        responses: Cow::Borrowed(&[]),
    }
}
