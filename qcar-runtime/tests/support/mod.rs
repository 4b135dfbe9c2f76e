//! A model written by hand for the tests: pad, wheel, body and powertrain in a chain, all linear.

use nalgebra::{Complex, DMatrix, DVector};
use qcar_runtime::model::{
    About, Channel, Contact, Default, Entry, Excitation, Input, InputKind, Link, Matrix, Model, Output, Parameter,
    Quantity, ResponseLayout, ResponseMut, Signal, SignalKind, State, StateKind,
};
use std::borrow::Cow;

/// Names, units and true values of the parameters. The last one acts along x, where nothing is excited.
pub const PARAMETERS: [(&str, &str, f64); 10] = [
    ("m_corner", "kg", 490.0),
    ("m_wheel", "kg", 45.0),
    ("m_pwt", "kg", 70.0),
    ("k_tire", "N/m", 220e3),
    ("c_tire", "N s/m", 150.0),
    ("k_wheel_z", "N/m", 33e3),
    ("c_wheel_z", "N s/m", 1900.0),
    ("k_pwt_z", "N/m", 210e3),
    ("c_pwt_z", "N s/m", 520.0),
    ("k_wheel_x", "N/m", 400e3),
];

/// The masses in the order of the states.
pub const MASSES: [&str; 3] = ["body", "wheel", "pwt"];

/// The chain.
pub struct Chain {
    about: About,
}

impl Chain {
    /// A chain that says of itself whether it is linear: if not, its response is taken from its matrices.
    pub fn new(linear: bool) -> Self {
        Self { about: about(linear) }
    }

    /// The same with some other default of a parameter.
    pub fn with_default(parameter: usize, default: Default) -> Self {
        let mut about = about(true);
        about.parameters.to_mut()[parameter].default = default;
        Self { about }
    }
}

/// True values.
pub fn truth() -> Vec<f64> {
    PARAMETERS.iter().map(|parameter| parameter.2).collect()
}

/// The acceleration of a mass or of the pad.
pub fn acceleration(location: &'static str) -> Signal {
    Signal {
        location: location.into(),
        axis: "z".into(),
        kind: SignalKind::Motion(Quantity::Acceleration),
    }
}

/// `M q̈ + C q̇ + K q = pull_k z_pad + pull_c ż_pad`.
struct System {
    m: DVector<f64>,
    k: DMatrix<f64>,
    c: DMatrix<f64>,
    pull_k: DVector<f64>,
    pull_c: DVector<f64>,
}

fn system(p: &[f64]) -> System {
    let chain = |wheel: f64, tire: f64, pwt: f64| {
        DMatrix::from_row_slice(
            3,
            3,
            &[wheel + pwt, -wheel, -pwt, -wheel, wheel + tire, 0.0, -pwt, 0.0, pwt],
        )
    };
    let pull = |tire: f64| DVector::from_column_slice(&[0.0, tire, 0.0]);
    System {
        m: DVector::from_column_slice(&[p[0] - p[1] - p[2], p[1], p[2]]),
        k: chain(p[5], p[3], p[7]),
        c: chain(p[6], p[4], p[8]),
        pull_k: pull(p[3]),
        pull_c: pull(p[4]),
    }
}

/// Accelerations of the masses for a unit displacement of the pad.
pub fn closed_form(p: &[f64], omega: f64) -> DVector<Complex<f64>> {
    let System {
        m,
        k,
        c,
        pull_k,
        pull_c,
    } = system(p);
    let s = Complex::new(0.0, omega);
    let z = DMatrix::from_fn(3, 3, |i, j| {
        Complex::from(k[(i, j)]) + s * c[(i, j)] + if i == j { s * s * m[i] } else { Complex::default() }
    });
    let force = DVector::from_fn(3, |i, _| Complex::from(pull_k[i]) + s * pull_c[i]);
    z.lu().solve(&force).expect("the chain is held and damped") * (s * s)
}

/// All of A, B, C and D row by row; u is pad height, pad velocity and gravity.
fn dense(p: &[f64]) -> Vec<f64> {
    let System {
        m,
        k,
        c,
        pull_k,
        pull_c,
    } = system(p);
    let acceleration = |i: usize| {
        let of_states = (0..3)
            .map(|j| -k[(i, j)] / m[i])
            .chain((0..3).map(|j| -c[(i, j)] / m[i]))
            .collect::<Vec<_>>();
        (of_states, [pull_k[i] / m[i], pull_c[i] / m[i], -1.0])
    };
    let velocity = |i: usize| (0..6).map(move |j| f64::from(u8::from(j == i + 3)));
    let a = (0..3).flat_map(velocity).chain((0..3).flat_map(|i| acceleration(i).0));
    let b = std::iter::repeat_n(0.0, 9).chain((0..3).flat_map(|i| acceleration(i).1));
    let c = (0..3).flat_map(|i| acceleration(i).0);
    let d = (0..3).flat_map(|i| acceleration(i).1);
    a.chain(b).chain(c).chain(d).collect()
}

fn entries() -> Vec<Entry> {
    let block = |matrix, rows: u16, columns: u16| {
        (0..rows).flat_map(move |row| (0..columns).map(move |column| Entry { matrix, row, column }))
    };
    block(Matrix::A, 6, 6)
        .chain(block(Matrix::B, 6, 3))
        .chain(block(Matrix::C, 3, 6))
        .chain(block(Matrix::D, 3, 3))
        .collect()
}

/// Central differences; what is compared with them allows for their error.
fn differences<T>(p: &[f64], parameter: usize, of: impl Fn(&[f64]) -> Vec<T>) -> Vec<T>
where
    T: Copy + std::ops::Sub<Output = T> + std::ops::Div<f64, Output = T>,
{
    let step = 1e-6 * p[parameter];
    let shifted = |by: f64| {
        let mut p = p.to_vec();
        p[parameter] += by;
        of(&p)
    };
    let pairs = shifted(step).into_iter().zip(shifted(-step));
    pairs.map(|(up, down)| (up - down) / (2.0 * step)).collect()
}

impl Model for Chain {
    fn about(&self) -> &About {
        &self.about
    }

    fn prepare(&self, p: &[f64], constants: &mut [f64]) {
        constants.copy_from_slice(p);
    }

    fn derivative(&self, p: &[f64], x: &[f64], u: &[f64], dx: &mut [f64]) {
        let all = dense(p);
        for (i, dx) in dx.iter_mut().enumerate() {
            let of_states: f64 = (0..6).map(|j| all[i * 6 + j] * x[j]).sum();
            *dx = of_states + (0..3).map(|j| all[36 + i * 3 + j] * u[j]).sum::<f64>();
        }
    }

    fn outputs(&self, p: &[f64], x: &[f64], u: &[f64], y: &mut [f64]) {
        let mut dx = [0.0; 6];
        self.derivative(p, x, u, &mut dx);
        y.copy_from_slice(&dx[3..]);
    }

    fn matrices(&self, p: &[f64], _: &[f64], _: &[f64], nonzeros: &mut [f64]) {
        nonzeros.copy_from_slice(&dense(p));
    }

    fn sensitivities(&self, p: &[f64], _: &[f64], _: &[f64], nonzeros: &mut [f64]) {
        let all = (0..p.len()).flat_map(|parameter| differences(p, parameter, dense));
        nonzeros.iter_mut().zip(all).for_each(|(to, value)| *to = value);
    }

    fn parameter_jacobian(&self, _: &[f64], _: &[f64], _: &[f64], _: &mut [f64]) {}

    fn response(&self, _: usize, p: &[f64], omega: &[f64], into: ResponseMut<'_>) {
        let (lines, seen) = (omega.len(), p.len() - 1);
        let (jacobian_re, jacobian_im) = into.jacobian.expect("the fit asks for it");
        for (line, &omega) in omega.iter().enumerate() {
            let accelerations = |p: &[f64]| closed_form(p, omega).iter().copied().collect::<Vec<_>>();
            for (mass, value) in accelerations(p).into_iter().enumerate() {
                into.re[mass * lines + line] = value.re;
                into.im[mass * lines + line] = value.im;
            }
            for parameter in 0..seen {
                for (mass, value) in differences(p, parameter, accelerations).into_iter().enumerate() {
                    jacobian_re[(mass * seen + parameter) * lines + line] = value.re;
                    jacobian_im[(mass * seen + parameter) * lines + line] = value.im;
                }
            }
        }
    }

    fn contact_force(&self, _: &[f64], _: &[f64], _: f64, _: f64) -> f64 {
        0.0
    }

    fn rolling_derivative(&self, p: &[f64], x: &[f64], u: &[f64], _: &Contact, dx: &mut [f64]) {
        self.derivative(p, x, u, dx);
    }

    fn rolling_outputs(&self, p: &[f64], x: &[f64], u: &[f64], _: &Contact, y: &mut [f64]) {
        self.outputs(p, x, u, y);
    }
}

fn about(linear: bool) -> About {
    let parameter = |&(name, unit, _): &(&'static str, &'static str, f64)| Parameter {
        name: name.into(),
        unit: unit.into(),
        doc: format!("What `{name}` is").into(),
        default: Default::None,
        range: None,
        known: name == "m_corner",
    };
    let state = |name: String, unit: &'static str, mass: &&'static str, kind| State {
        name: name.into(),
        unit: unit.into(),
        location: (*mass).into(),
        axis: "z".into(),
        kind,
    };
    let positions = MASSES
        .iter()
        .map(|mass| state(format!("z_{mass}"), "m", mass, StateKind::Position));
    let velocities = MASSES
        .iter()
        .map(|mass| state(format!("vz_{mass}"), "m/s", mass, StateKind::Velocity));
    let input = |name: &'static str, unit: &'static str, kind| Input {
        name: name.into(),
        unit: unit.into(),
        axis: "z".into(),
        kind,
    };
    let link = |name: &'static str, upper: &'static str, lower: &'static str| Link {
        name: name.into(),
        axis: "z".into(),
        ends: vec![upper.into(), lower.into()].into(),
    };
    let seen = PARAMETERS.len() as u16 - 1;
    About {
        name: "chain".into(),
        doc: "Pad, wheel, body and powertrain".into(),
        parameters: PARAMETERS.iter().map(parameter).collect(),
        states: positions.chain(velocities).collect(),
        inputs: vec![
            input("z_pad", "m", InputKind::Motion(0, Quantity::Position)),
            input("vz_pad", "m/s", InputKind::Motion(0, Quantity::Velocity)),
            input("g", "m/s^2", InputKind::Gravity),
        ]
        .into(),
        outputs: MASSES
            .iter()
            .map(|mass| Output {
                name: format!("z_{mass}_acceleration").into(),
                unit: "m/s^2".into(),
                signal: acceleration(mass),
            })
            .collect(),
        excitations: vec![Excitation {
            name: "pad".into(),
            axis: "z".into(),
            force: false,
            road: true,
        }]
        .into(),
        channels: vec![Channel {
            name: "pad_to_body".into(),
            numerator: acceleration("body"),
            denominator: acceleration("pad"),
        }]
        .into(),
        links: vec![
            link("tire", "wheel", "pad"),
            link("spring", "body", "wheel"),
            link("damper", "body", "wheel"),
            link("powertrain_mount", "pwt", "body"),
        ]
        .into(),
        contact: None,
        constants: PARAMETERS.len(),
        linear,
        matrices: entries().into(),
        sensitivities: (0..PARAMETERS.len() as u16)
            .flat_map(|parameter| entries().into_iter().map(move |entry| (entry, parameter)))
            .collect(),
        parameter_jacobian: Cow::Borrowed(&[]),
        responses: vec![ResponseLayout {
            outputs: (0..3).collect(),
            jacobian: (0..3)
                .flat_map(|mass| (0..seen).map(move |parameter| (mass, parameter)))
                .collect(),
        }]
        .into(),
    }
}
