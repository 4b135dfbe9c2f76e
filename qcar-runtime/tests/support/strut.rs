//! A strut axle written by hand for the tests: wheel, top mount, body and, where wanted, a powertrain on the body and a
//! Dahl friction in the damper. Its matrices are differences of its equations.

use nalgebra::{Complex, DMatrix, DVector};
use qcar_runtime::model::{
    About, Contact, Default, Entry, Excitation, Input, InputKind, Link, Matrix, Model, Output, Parameter, Quantity,
    ResponseLayout, ResponseMut, Signal, SignalKind, State, StateKind,
};
use std::borrow::Cow;

/// What a strut axle has beside wheel, top mount and body.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Parts {
    /// A mass on mounts on the body.
    pub powertrain: bool,
    /// Dahl's law across the damper.
    pub friction: bool,
}

/// The axle.
pub struct Strut {
    pub about: About,
    parts: Parts,
    /// Factor on its Jacobian; 1 is right.
    pub jacobian_factor: f64,
    /// Cubic stiffness of the powertrain's mounts, N/m³.
    pub hardening: f64,
}

const BASE: [(&str, &str); 9] = [
    ("m_corner", "kg"),
    ("m_wheel", "kg"),
    ("m_tm", "kg"),
    ("k_wheel_z", "N/m"),
    ("c_wheel_z", "N s/m"),
    ("k_tm", "N/m"),
    ("c_tm", "N s/m"),
    ("k_tire", "N/m"),
    ("c_tire", "N s/m"),
];
const POWERTRAIN: [(&str, &str); 3] = [("m_pwt", "kg"), ("k_pwt_z", "N/m"), ("c_pwt_z", "N s/m")];
const FRICTION: [(&str, &str); 2] = [("f_coulomb", "N"), ("k_presliding", "N/m")];

impl Strut {
    /// An axle with these parts.
    pub fn new(parts: Parts) -> Self {
        Self {
            about: about(parts),
            parts,
            jacobian_factor: 1.0,
            hardening: 0.0,
        }
    }

    fn masses(&self) -> usize {
        3 + usize::from(self.parts.powertrain)
    }

    fn states(&self) -> usize {
        2 * self.masses() + usize::from(self.parts.friction)
    }

    /// `dx` for parameters, states and inputs (pad height, pad velocity, wheel force).
    fn rates(&self, p: &[f64], x: &[f64], u: &[f64]) -> Vec<f64> {
        let n = self.masses();
        let (z, v) = x.split_at(n);
        let (body, wheel, tm, pwt) = (0, 1, 2, 3);
        let extra = &p[BASE.len()..];
        let m_pwt = if self.parts.powertrain { extra[0] } else { 0.0 };
        let spring = p[3] * (z[body] - z[wheel]);
        let mut damper = p[4] * (v[tm] - v[wheel]);
        let top = p[5] * (z[body] - z[tm]) + p[6] * (v[body] - v[tm]);
        let tire = p[7] * (z[wheel] - u[0]) + p[8] * (v[wheel] - u[1]);
        let mut dx = v[..n].to_vec();
        let mut inner = Vec::new();
        if self.parts.friction {
            let law = &extra[extra.len() - 2..];
            let (f, rate) = (x[2 * n], v[tm] - v[wheel]);
            damper += f;
            inner.push(law[1] * (rate - rate.abs() * f / law[0]));
        }
        let mut force = vec![-spring - top, spring + damper - tire + u[2], top - damper];
        if self.parts.powertrain {
            let (s, rate) = (z[pwt] - z[body], v[pwt] - v[body]);
            let mount = extra[1] * s + self.hardening * s.powi(3) + extra[2] * rate;
            force[body] += mount;
            force.push(-mount);
        }
        let mass = [p[0] - p[1] - p[2] - m_pwt, p[1], p[2], m_pwt];
        dx.extend(force.iter().zip(mass).map(|(force, mass)| force / mass));
        dx.extend(inner);
        dx
    }

    fn answers(&self, p: &[f64], x: &[f64], u: &[f64]) -> Vec<f64> {
        let n = self.masses();
        self.rates(p, x, u)[n..2 * n].to_vec()
    }

    /// A, B, C, D row by row, by central differences.
    fn dense(&self, p: &[f64], x: &[f64], u: &[f64]) -> Vec<f64> {
        let both = |x: &[f64], u: &[f64]| {
            let mut both = self.rates(p, x, u);
            both.extend(self.answers(p, x, u));
            both
        };
        let column = |at: &[f64], k: usize, of: &dyn Fn(&[f64]) -> Vec<f64>| -> Vec<f64> {
            let step = 1e-7;
            let shifted = |by: f64| {
                let mut at = at.to_vec();
                at[k] += by;
                of(&at)
            };
            shifted(step)
                .iter()
                .zip(shifted(-step))
                .map(|(up, down)| (up - down) / (2.0 * step))
                .collect()
        };
        let of_x: Vec<_> = (0..x.len()).map(|k| column(x, k, &|x| both(x, u))).collect();
        let of_u: Vec<_> = (0..u.len()).map(|k| column(u, k, &|u| both(x, u))).collect();
        let n = x.len();
        let rows = |columns: &[Vec<f64>], from: usize, to: usize| -> Vec<f64> {
            (from..to)
                .flat_map(|row| columns.iter().map(move |column| column[row]).collect::<Vec<_>>())
                .collect()
        };
        let end = n + self.masses();
        [
            rows(&of_x, 0, n),
            rows(&of_u, 0, n),
            rows(&of_x, n, end),
            rows(&of_u, n, end),
        ]
        .concat()
    }

    fn differences(&self, p: &[f64], of: impl Fn(&[f64]) -> Vec<f64>) -> Vec<Vec<f64>> {
        let along = |k: usize| {
            let step = 1e-6 * p[k];
            let shifted = |by: f64| {
                let mut p = p.to_vec();
                p[k] += by;
                of(&p)
            };
            shifted(step)
                .iter()
                .zip(shifted(-step))
                .map(|(up, down)| (up - down) / (2.0 * step))
                .collect()
        };
        (0..p.len()).map(along).collect()
    }

    /// Outputs for a unit displacement of the pad, real and imaginary part of each in turn.
    fn line(&self, p: &[f64], excitation: usize, omega: f64) -> Vec<f64> {
        let (n, inputs, outputs) = (self.states(), 3, self.masses());
        let all = self.dense(p, &vec![0.0; n], &vec![0.0; inputs]);
        let (a, rest) = all.split_at(n * n);
        let (b, rest) = rest.split_at(n * inputs);
        let (c, d) = rest.split_at(outputs * n);
        let s = Complex::new(0.0, omega);
        let u = if excitation == 0 {
            [Complex::ONE, s, Complex::ZERO]
        } else {
            [Complex::ZERO, Complex::ZERO, Complex::ONE]
        };
        let dynamics = DMatrix::from_fn(n, n, |i, j| {
            Complex::from(-a[i * n + j]) + if i == j { s } else { Complex::ZERO }
        });
        let push = DVector::from_fn(n, |i, _| {
            (0..inputs).map(|k| u[k] * b[i * inputs + k]).sum::<Complex<f64>>()
        });
        let x = dynamics.lu().solve(&push).expect("the axle is held and damped");
        (0..outputs)
            .map(|i| {
                (0..n).map(|k| x[k] * c[i * n + k]).sum::<Complex<f64>>()
                    + (0..inputs).map(|k| u[k] * d[i * inputs + k]).sum::<Complex<f64>>()
            })
            .flat_map(|y: Complex<f64>| [y.re, y.im])
            .collect()
    }
}

impl Model for Strut {
    fn about(&self) -> &About {
        &self.about
    }

    fn prepare(&self, p: &[f64], constants: &mut [f64]) {
        constants.copy_from_slice(p);
    }

    fn derivative(&self, p: &[f64], x: &[f64], u: &[f64], dx: &mut [f64]) {
        dx.copy_from_slice(&self.rates(p, x, u));
    }

    fn outputs(&self, p: &[f64], x: &[f64], u: &[f64], y: &mut [f64]) {
        y.copy_from_slice(&self.answers(p, x, u));
    }

    fn matrices(&self, p: &[f64], x: &[f64], u: &[f64], nonzeros: &mut [f64]) {
        let right = self.dense(p, x, u).into_iter();
        nonzeros
            .iter_mut()
            .zip(right)
            .for_each(|(own, right)| *own = self.jacobian_factor * right);
    }

    fn sensitivities(&self, p: &[f64], x: &[f64], u: &[f64], nonzeros: &mut [f64]) {
        let all = self.differences(p, |p| self.dense(p, x, u)).concat();
        nonzeros.copy_from_slice(&all);
    }

    fn parameter_jacobian(&self, p: &[f64], x: &[f64], u: &[f64], nonzeros: &mut [f64]) {
        let rates = self.differences(p, |p| self.rates(p, x, u)).concat();
        let answers = self.differences(p, |p| self.answers(p, x, u)).concat();
        nonzeros.copy_from_slice(&[rates, answers].concat());
    }

    fn response(&self, excitation: usize, p: &[f64], omega: &[f64], into: ResponseMut<'_>) {
        let lines = omega.len();
        let mut jacobian = into.jacobian;
        for (line, &omega) in omega.iter().enumerate() {
            for (output, value) in self.line(p, excitation, omega).chunks(2).enumerate() {
                into.re[output * lines + line] = value[0];
                into.im[output * lines + line] = value[1];
            }
            let Some((re, im)) = &mut jacobian else { continue };
            for (k, along) in self
                .differences(p, |p| self.line(p, excitation, omega))
                .iter()
                .enumerate()
            {
                for (output, value) in along.chunks(2).enumerate() {
                    re[(output * p.len() + k) * lines + line] = value[0];
                    im[(output * p.len() + k) * lines + line] = value[1];
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

fn about(parts: Parts) -> About {
    let mut masses = vec!["body", "wheel", "tm"];
    let mut parameters = BASE.to_vec();
    if parts.powertrain {
        masses.push("pwt");
        parameters.extend(POWERTRAIN);
    }
    if parts.friction {
        parameters.extend(FRICTION);
    }
    let (n, outputs, count) = (
        2 * masses.len() + usize::from(parts.friction),
        masses.len(),
        parameters.len(),
    );
    let state = |name: String, unit: &'static str, location: &'static str, kind| State {
        name: name.into(),
        unit: unit.into(),
        location: location.into(),
        axis: "z".into(),
        kind,
    };
    let mut states: Vec<State> = Vec::new();
    states.extend(
        masses
            .iter()
            .map(|m| state(format!("z_{m}"), "m", m, StateKind::Position)),
    );
    states.extend(
        masses
            .iter()
            .map(|m| state(format!("vz_{m}"), "m/s", m, StateKind::Velocity)),
    );
    if parts.friction {
        states.push(state("damper.f".into(), "N", "damper", StateKind::Inner));
    }
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
        parameters: Cow::Borrowed(&[]),
    };
    let mut links = vec![
        link("tire", "wheel", "pad"),
        link("spring", "body", "wheel"),
        link("damper", "tm", "wheel"),
        link("top_mount", "body", "tm"),
    ];
    if parts.powertrain {
        links.push(link("powertrain_mount", "pwt", "body"));
    }
    let block = |matrix, rows: usize, columns: usize| {
        (0..rows).flat_map(move |row| {
            (0..columns).map(move |column| Entry {
                matrix,
                row: row as u16,
                column: column as u16,
            })
        })
    };
    let matrices: Vec<Entry> = block(Matrix::A, n, n)
        .chain(block(Matrix::B, n, 3))
        .chain(block(Matrix::C, outputs, n))
        .chain(block(Matrix::D, outputs, 3))
        .collect();
    let along = |is_output: bool, rows: usize| {
        (0..count).flat_map(move |k| (0..rows).map(move |row| (is_output, row as u16, k as u16)))
    };
    let layout = || ResponseLayout {
        outputs: (0..outputs as u16).collect(),
        jacobian: (0..outputs as u16)
            .flat_map(|o| (0..count as u16).map(move |k| (o, k)))
            .collect(),
    };
    let excitation = |name: &'static str, force: bool| Excitation {
        name: name.into(),
        axis: "z".into(),
        force,
        road: !force,
    };
    About {
        name: "strut".into(),
        doc: "A strut axle".into(),
        parameters: parameters
            .iter()
            .map(|&(name, unit)| Parameter {
                name: name.into(),
                unit: unit.into(),
                doc: format!("What `{name}` is").into(),
                default: Default::None,
                range: None,
                known: matches!(name, "m_corner" | "m_tm"),
                clock: None,
            })
            .collect(),
        states: states.into(),
        inputs: vec![
            input("z_pad", "m", InputKind::Motion(0, Quantity::Position)),
            input("vz_pad", "m/s", InputKind::Motion(0, Quantity::Velocity)),
            input("f_wheel_z", "N", InputKind::Force(1)),
        ]
        .into(),
        outputs: masses
            .iter()
            .map(|mass| Output {
                name: format!("z_{mass}_acceleration").into(),
                unit: "m/s^2".into(),
                signal: Signal {
                    location: (*mass).into(),
                    axis: "z".into(),
                    kind: SignalKind::Motion(Quantity::Acceleration),
                },
            })
            .collect(),
        excitations: vec![excitation("pad", false), excitation("f_wheel_z", true)].into(),
        channels: Cow::Borrowed(&[]),
        links: links.into(),
        masses: Cow::Borrowed(&[]),
        contact: None,
        constants: count,
        linear: !parts.friction,
        sensitivities: (0..count as u16)
            .flat_map(|k| matrices.iter().map(move |entry| (*entry, k)).collect::<Vec<_>>())
            .collect(),
        matrices: matrices.into(),
        parameter_jacobian: along(false, n).chain(along(true, outputs)).collect(),
        responses: vec![layout(), layout()].into(),
    }
}
