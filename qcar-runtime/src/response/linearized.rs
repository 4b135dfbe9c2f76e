//! The response of a model from its matrices: `H = C (jω − A)⁻¹ B(ω) + D(ω)`.
//!
//! The excitation enters u as position, velocity and acceleration, so its column is `B(ω) = Σ_k B_k (jω)^k`.

use crate::model::{About, Entry, InputKind, Matrix, Model, Quantity, ResponseLayout, ResponseMut};
use nalgebra::{Complex, DMatrix, DVector};

/// The point at which a nonlinear model is linearised.
#[derive(Clone, Debug, PartialEq)]
pub struct OperatingPoint {
    /// States.
    pub x: Vec<f64>,
    /// Inputs.
    pub u: Vec<f64>,
}

impl OperatingPoint {
    /// All states and inputs zero.
    pub fn rest(about: &About) -> Self {
        Self {
            x: vec![0.0; about.states.len()],
            u: vec![0.0; about.inputs.len()],
        }
    }
}

/// A layout in which every output responds to every parameter: zeros are not known in advance.
pub(super) fn layout(about: &About) -> ResponseLayout {
    let outputs = 0..about.outputs.len() as u16;
    let parameters = 0..about.parameters.len() as u16;
    let jacobian = outputs
        .clone()
        .flat_map(|output| parameters.clone().map(move |parameter| (output, parameter)));
    ResponseLayout {
        outputs: outputs.collect(),
        jacobian: jacobian.collect(),
    }
}

/// Writes the response in the order of [`layout`]; NaN at a frequency where `jω − A` is singular.
pub(super) fn response<M: Model + ?Sized>(
    model: &M,
    excitation: usize,
    p: &[f64],
    point: &OperatingPoint,
    omega: &[f64],
    into: ResponseMut<'_>,
) {
    let about = model.about();
    let mut matrices = vec![0.0; about.matrices.len()];
    model.matrices(p, &point.x, &point.u, &mut matrices);
    let mut sensitivities = vec![0.0; about.sensitivities.len()];
    model.sensitivities(p, &point.x, &point.u, &mut sensitivities);
    let lines = omega.len();
    let (mut jacobian_re, mut jacobian_im) = into.jacobian.unzip();
    for (line, &omega) in omega.iter().enumerate() {
        let at = Line::solve(about, &matrices, excitation, omega);
        for (output, value) in at.h.iter().enumerate() {
            into.re[output * lines + line] = value.re;
            into.im[output * lines + line] = value.im;
        }
        if let (Some(re), Some(im)) = (&mut jacobian_re, &mut jacobian_im) {
            for (entry, value) in at.jacobian(about, &sensitivities).iter().enumerate() {
                re[entry * lines + line] = value.re;
                im[entry * lines + line] = value.im;
            }
        }
    }
}

/// The solution at one frequency.
struct Line {
    /// Amplitude of each input for a unit excitation.
    input: Vec<Complex<f64>>,
    /// The states.
    x: DVector<Complex<f64>>,
    /// Response of each output to a rate of each state: `C (jω − A)⁻¹`.
    reach: DMatrix<Complex<f64>>,
    /// The outputs.
    h: DVector<Complex<f64>>,
}

impl Line {
    fn solve(about: &About, values: &[f64], excitation: usize, omega: f64) -> Self {
        let (states, outputs) = (about.states.len(), about.outputs.len());
        let input = input(about, excitation, omega);
        let mut dynamics = DMatrix::from_diagonal_element(states, states, Complex::new(0.0, omega));
        let mut c = DMatrix::zeros(outputs, states);
        let mut b = DVector::zeros(states);
        let mut h = DVector::zeros(outputs);
        for (Entry { matrix, row, column }, &value) in about.matrices.iter().zip(values) {
            let (row, column, value) = (usize::from(*row), usize::from(*column), Complex::from(value));
            match matrix {
                Matrix::A => dynamics[(row, column)] -= value,
                Matrix::B => b[row] += value * input[column],
                Matrix::C => c[(row, column)] += value,
                Matrix::D => h[row] += value * input[column],
            }
        }
        let missing = Complex::new(f64::NAN, f64::NAN);
        let inverse = dynamics
            .try_inverse()
            .unwrap_or_else(|| DMatrix::from_element(states, states, missing));
        let reach = c * &inverse;
        let x = inverse * &b;
        h += &reach * b;
        Self { input, x, reach, h }
    }

    /// `dH = C (jω − A)⁻¹ (dA x + dB u) + dC x + dD u`, output by output, parameter by parameter.
    fn jacobian(&self, about: &About, values: &[f64]) -> Vec<Complex<f64>> {
        let parameters = about.parameters.len();
        let mut result = vec![Complex::default(); self.h.len() * parameters];
        for ((Entry { matrix, row, column }, parameter), &value) in about.sensitivities.iter().zip(values) {
            let (row, column, parameter) = (usize::from(*row), usize::from(*column), usize::from(*parameter));
            let source = match matrix {
                Matrix::A | Matrix::C => self.x[column],
                Matrix::B | Matrix::D => self.input[column],
            };
            match matrix {
                Matrix::C | Matrix::D => result[row * parameters + parameter] += source * value,
                Matrix::A | Matrix::B => {
                    for output in 0..self.h.len() {
                        result[output * parameters + parameter] += self.reach[(output, row)] * source * value;
                    }
                }
            }
        }
        result
    }
}

fn input(about: &About, excitation: usize, omega: f64) -> Vec<Complex<f64>> {
    let rate = Complex::new(0.0, omega);
    let unit = |kind| match kind {
        InputKind::Force(place) if usize::from(place) == excitation => Complex::from(1.0),
        InputKind::Motion(place, quantity) if usize::from(place) == excitation => match quantity {
            Quantity::Position => Complex::from(1.0),
            Quantity::Velocity => rate,
            Quantity::Acceleration => rate * rate,
        },
        _ => Complex::default(),
    };
    about.inputs.iter().map(|input| unit(input.kind)).collect()
}
