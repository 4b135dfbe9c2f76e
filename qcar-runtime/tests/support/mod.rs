//! Models for the tests, assembled from masses and links by incidence: `M q̈ + C q̇ + K q = k z_pad + c ż_pad`.

pub mod random;
pub mod strut;
pub mod swept;
pub mod track;

use nalgebra::{Complex, DMatrix, DVector};
use qcar_runtime::model::{
    About, Channel, Contact, Default, Entry, Excitation, Input, InputKind, Link, Matrix, Model, Output, Parameter,
    Quantity, ResponseLayout, ResponseMut, Signal, SignalKind, State, StateKind,
};
use std::borrow::Cow;
use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};

/// A function of the parameters.
pub type Law = fn(&[f64]) -> f64;

/// A spring and a damper over a stretch.
pub struct Element {
    /// Its name.
    pub name: &'static str,
    /// Coordinates (`pad` among them) with their shares of the stretch, upper before lower.
    pub ends: Vec<(&'static str, Law)>,
    /// Stiffness and damping.
    pub law: [Law; 2],
}

/// A model along z over one pad. Its last parameter acts nowhere.
pub struct Assembled {
    about: About,
    masses: Vec<(&'static str, Law)>,
    elements: Vec<Element>,
    /// Number of responses that it has computed.
    pub responses: AtomicUsize,
}

/// Name, unit and true value of a parameter.
pub type Given = (&'static str, &'static str, f64);

/// Parameters of [`chain`]. The last one acts along x, where nothing is excited.
pub const CHAIN: [Given; 10] = [
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

/// Pad, wheel, body and powertrain in a chain; if not `linear`, its response is to be taken from its matrices.
pub fn chain(linear: bool) -> Assembled {
    let masses: Vec<(&'static str, Law)> =
        vec![("body", |p| p[0] - p[1] - p[2]), ("wheel", |p| p[1]), ("pwt", |p| p[2])];
    let elements = vec![
        between("tire", "wheel", "pad", [|p| p[3], |p| p[4]]),
        between("spring", "body", "wheel", [|p| p[5], |_| 0.0]),
        between("damper", "body", "wheel", [|_| 0.0, |p| p[6]]),
        between("powertrain_mount", "pwt", "body", [|p| p[7], |p| p[8]]),
    ];
    Assembled::new("chain", &CHAIN, masses, elements, linear)
}

/// An element straight between two coordinates.
pub fn between(name: &'static str, upper: &'static str, lower: &'static str, law: [Law; 2]) -> Element {
    Element {
        name,
        ends: vec![(upper, |_| 1.0), (lower, |_| -1.0)],
        law,
    }
}

/// True values.
pub fn truth(parameters: &[Given]) -> Vec<f64> {
    parameters.iter().map(|parameter| parameter.2).collect()
}

/// The acceleration of a mass or of the pad.
pub fn acceleration(location: &'static str) -> Signal {
    Signal {
        location: location.into(),
        axis: "z".into(),
        kind: SignalKind::Motion(Quantity::Acceleration),
    }
}

struct System {
    m: DVector<f64>,
    k: DMatrix<f64>,
    c: DMatrix<f64>,
    pull: [DVector<f64>; 2],
}

impl Assembled {
    /// Assembles a model from its parts.
    pub fn new(
        name: &'static str,
        parameters: &[Given],
        masses: Vec<(&'static str, Law)>,
        elements: Vec<Element>,
        linear: bool,
    ) -> Self {
        let about = about(name, parameters, &masses, &elements, linear);
        Self {
            about,
            masses,
            elements,
            responses: AtomicUsize::new(0),
        }
    }

    /// The same with some other default of a parameter.
    pub fn with_default(mut self, parameter: usize, default: Default) -> Self {
        self.about.parameters.to_mut()[parameter].default = default;
        self
    }

    fn system(&self, p: &[f64]) -> System {
        let n = self.masses.len();
        let place = |name: &str| self.masses.iter().position(|mass| mass.0 == name);
        let zero = || DVector::zeros(n);
        let m = DVector::from_iterator(n, self.masses.iter().map(|mass| (mass.1)(p)));
        let mut system = System {
            m,
            k: DMatrix::zeros(n, n),
            c: DMatrix::zeros(n, n),
            pull: [zero(), zero()],
        };
        for element in &self.elements {
            let mut incidence = zero();
            let mut pad = 0.0;
            for (name, share) in &element.ends {
                match place(name) {
                    Some(place) => incidence[place] += share(p),
                    None => pad += share(p),
                }
            }
            let square = &incidence * incidence.transpose();
            system.k += &square * (element.law[0])(p);
            system.c += &square * (element.law[1])(p);
            for (pull, law) in system.pull.iter_mut().zip(element.law) {
                *pull -= &incidence * (pad * law(p));
            }
        }
        system
    }

    /// Accelerations of the masses for a unit displacement of the pad.
    pub fn closed_form(&self, p: &[f64], omega: f64) -> DVector<Complex<f64>> {
        let System { m, k, c, pull } = self.system(p);
        let s = Complex::new(0.0, omega);
        let n = m.len();
        let z = DMatrix::from_fn(n, n, |i, j| {
            Complex::from(k[(i, j)]) + s * c[(i, j)] + if i == j { s * s * m[i] } else { Complex::default() }
        });
        let force = DVector::from_fn(n, |i, _| Complex::from(pull[0][i]) + s * pull[1][i]);
        z.lu().solve(&force).expect("the model is held and damped") * (s * s)
    }

    /// All of A, B, C and D row by row; u is pad height, pad velocity and gravity.
    fn dense(&self, p: &[f64]) -> Vec<f64> {
        let System { m, k, c, pull } = self.system(p);
        let n = m.len();
        let of_states = |i: usize| -> Vec<f64> {
            (0..n)
                .map(|j| -k[(i, j)] / m[i])
                .chain((0..n).map(|j| -c[(i, j)] / m[i]))
                .collect()
        };
        let of_inputs = |i: usize| [pull[0][i] / m[i], pull[1][i] / m[i], -1.0];
        let velocity = |i: usize| (0..2 * n).map(move |j| f64::from(u8::from(j == i + n)));
        let a = (0..n).flat_map(velocity).chain((0..n).flat_map(of_states));
        let b = std::iter::repeat_n(0.0, 3 * n).chain((0..n).flat_map(of_inputs));
        a.chain(b)
            .chain((0..n).flat_map(of_states))
            .chain((0..n).flat_map(of_inputs))
            .collect()
    }
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

impl Model for Assembled {
    fn about(&self) -> &About {
        &self.about
    }

    fn prepare(&self, p: &[f64], constants: &mut [f64]) {
        constants.copy_from_slice(p);
    }

    fn derivative(&self, p: &[f64], x: &[f64], u: &[f64], dx: &mut [f64]) {
        let (all, n) = (self.dense(p), x.len());
        for (i, dx) in dx.iter_mut().enumerate() {
            let of_states: f64 = (0..n).map(|j| all[i * n + j] * x[j]).sum();
            *dx = of_states + (0..3).map(|j| all[n * n + i * 3 + j] * u[j]).sum::<f64>();
        }
    }

    fn outputs(&self, p: &[f64], x: &[f64], u: &[f64], y: &mut [f64]) {
        let mut dx = vec![0.0; x.len()];
        self.derivative(p, x, u, &mut dx);
        y.copy_from_slice(&dx[x.len() / 2..]);
    }

    fn matrices(&self, p: &[f64], _: &[f64], _: &[f64], nonzeros: &mut [f64]) {
        nonzeros.copy_from_slice(&self.dense(p));
    }

    fn sensitivities(&self, p: &[f64], _: &[f64], _: &[f64], nonzeros: &mut [f64]) {
        let all = (0..p.len()).flat_map(|parameter| differences(p, parameter, |p| self.dense(p)));
        nonzeros.iter_mut().zip(all).for_each(|(to, value)| *to = value);
    }

    fn parameter_jacobian(&self, _: &[f64], _: &[f64], _: &[f64], _: &mut [f64]) {}

    fn response(&self, _: usize, p: &[f64], omega: &[f64], into: ResponseMut<'_>) {
        self.responses.fetch_add(1, Relaxed);
        let (lines, seen) = (omega.len(), p.len() - 1);
        let mut jacobian = into.jacobian;
        for (line, &omega) in omega.iter().enumerate() {
            let accelerations = |p: &[f64]| self.closed_form(p, omega).iter().copied().collect::<Vec<_>>();
            for (mass, value) in accelerations(p).into_iter().enumerate() {
                into.re[mass * lines + line] = value.re;
                into.im[mass * lines + line] = value.im;
            }
            let Some((jacobian_re, jacobian_im)) = &mut jacobian else {
                continue;
            };
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

fn about(
    name: &'static str,
    parameters: &[Given],
    masses: &[(&'static str, Law)],
    elements: &[Element],
    linear: bool,
) -> About {
    let count = parameters.len() as u16;
    About {
        name: name.into(),
        doc: "A model for tests".into(),
        parameters: parameters.iter().map(parameter).collect(),
        states: states(masses),
        inputs: vec![
            input("z_pad", "m", InputKind::Motion(0, Quantity::Position)),
            input("vz_pad", "m/s", InputKind::Motion(0, Quantity::Velocity)),
            input("g", "m/s^2", InputKind::Gravity),
        ]
        .into(),
        outputs: masses.iter().map(output).collect(),
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
        links: elements.iter().map(link).collect(),
        masses: Cow::Borrowed(&[]),
        contact: None,
        constants: parameters.len(),
        linear,
        matrices: entries(masses.len() as u16).into(),
        sensitivities: (0..count)
            .flat_map(|parameter| {
                entries(masses.len() as u16)
                    .into_iter()
                    .map(move |entry| (entry, parameter))
            })
            .collect(),
        parameter_jacobian: Cow::Borrowed(&[]),
        responses: vec![ResponseLayout {
            outputs: (0..masses.len() as u16).collect(),
            jacobian: (0..masses.len() as u16)
                .flat_map(|mass| (0..count - 1).map(move |parameter| (mass, parameter)))
                .collect(),
        }]
        .into(),
    }
}

fn parameter(&(name, unit, _): &Given) -> Parameter {
    Parameter {
        name: name.into(),
        unit: unit.into(),
        doc: format!("What `{name}` is").into(),
        default: Default::None,
        range: None,
        known: name == "m_corner",
        clock: None,
    }
}

fn states(masses: &[(&'static str, Law)]) -> Cow<'static, [State]> {
    let state = |name: String, unit: &'static str, mass: &'static str, kind| State {
        name: name.into(),
        unit: unit.into(),
        location: mass.into(),
        axis: "z".into(),
        kind,
    };
    let positions = masses
        .iter()
        .map(|mass| state(format!("z_{}", mass.0), "m", mass.0, StateKind::Position));
    let velocities = masses
        .iter()
        .map(|mass| state(format!("vz_{}", mass.0), "m/s", mass.0, StateKind::Velocity));
    positions.chain(velocities).collect()
}

fn input(name: &'static str, unit: &'static str, kind: InputKind) -> Input {
    Input {
        name: name.into(),
        unit: unit.into(),
        axis: "z".into(),
        kind,
    }
}

fn output(mass: &(&'static str, Law)) -> Output {
    Output {
        name: format!("z_{}_acceleration", mass.0).into(),
        unit: "m/s^2".into(),
        signal: acceleration(mass.0),
    }
}

fn link(element: &Element) -> Link {
    Link {
        name: element.name.into(),
        axis: "z".into(),
        ends: element.ends.iter().map(|end| Cow::Borrowed(end.0)).collect(),
        parameters: Cow::Borrowed(&[]),
    }
}

fn entries(masses: u16) -> Vec<Entry> {
    let block = |matrix, rows: u16, columns: u16| {
        (0..rows).flat_map(move |row| (0..columns).map(move |column| Entry { matrix, row, column }))
    };
    let of_states = block(Matrix::A, 2 * masses, 2 * masses).chain(block(Matrix::B, 2 * masses, 3));
    of_states
        .chain(block(Matrix::C, masses, 2 * masses))
        .chain(block(Matrix::D, masses, 3))
        .collect()
}
