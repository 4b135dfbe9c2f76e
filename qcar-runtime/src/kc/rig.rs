//! A model on a K&C rig: its body is clamped, its wheel is moved slowly, and the force on the wheel is measured.
//!
//! All else moves as it must: sub-frame, powertrain and top mount yield to what the wheel pulls on. So the gradient at
//! the wheel is that of several links in series, and a parameter is found from a measured gradient by asking for which
//! value the model has it.

use nalgebra::{Complex, DMatrix, DVector};

use crate::model::{About, ContactAxis, InputKind, Matrix, Model, StateKind};
use crate::response::parameters::Values;

/// Which gradient of the force on the wheel is meant.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Slope {
    /// Over displacement, N/m.
    Stiffness,
    /// Over velocity, N s/m.
    Damping,
}

/// rad/s: so slow that masses weigh nothing (a wheel some 1e-6 of its spring), and that dampers still show.
const SLOW: f64 = 0.06;
/// How far from its value a parameter without bounds is looked for, as a factor.
const REACH: f64 = 100.0;
const HALVINGS: usize = 60;

/// The gradient of the force on the wheel of a rolling tyre, moved along `axis` with the mass `clamped` held.
///
/// The model is linearised at rest, and inner states of laws stay at zero: friction is no gradient. Its road moves with
/// the wheel. `None` where the model has no such mass, no wheel that moves along the axis, or no force on that wheel.
pub fn gradient<M: Model + ?Sized>(model: &M, p: &[f64], clamped: &str, axis: &str, slope: Slope) -> Option<f64> {
    let about = model.about();
    let wheel = about.contact.as_ref()?.axes.iter().find(|found| found.axis == axis)?;
    let mut states = about.states.iter();
    states.find(|state| state.location == clamped && state.axis == axis)?;
    let force = Rig::new(model, p).force(clamped, wheel)?;
    let found = match slope {
        Slope::Stiffness => force.re,
        Slope::Damping => force.im / SLOW,
    };
    found.is_finite().then_some(found)
}

/// The value of a parameter with which a model has the `measured` gradient, all others as they are in `values`.
///
/// It is sought within the parameter's bounds; the gradient is taken to grow with it. `None` where [`gradient`] says
/// nothing or no value within reach gives what was measured.
pub fn value_for<M: Model + ?Sized>(
    model: &M,
    values: &Values,
    parameter: usize,
    (clamped, axis, slope): (&str, &str, Slope),
    measured: f64,
) -> Option<f64> {
    let mut p = values.as_slice().to_vec();
    let own = p[parameter];
    let same: Vec<usize> = (0..p.len())
        .filter(|&i| values.leader(i) == values.leader(parameter))
        .collect();
    let bounds = model.about().parameters[parameter].range;
    let (mut low, mut high) = bounds.unwrap_or((own / REACH, own * REACH));
    let mut excess = |value: f64| {
        same.iter().for_each(|&i| p[i] = value);
        gradient(model, &p, clamped, axis, slope).map(|found| found - measured)
    };
    if excess(low)? > 0.0 || excess(high)? < 0.0 {
        return None;
    }
    for _ in 0..HALVINGS {
        let middle = 0.5 * (low + high);
        if excess(middle)? < 0.0 {
            low = middle
        } else {
            high = middle
        }
    }
    Some(0.5 * (low + high))
}

/// A linear model `dx/dt = A x + B u`.
struct Rig<'a> {
    about: &'a About,
    a: DMatrix<Complex<f64>>,
    b: DMatrix<Complex<f64>>,
}

impl<'a> Rig<'a> {
    fn new<M: Model + ?Sized>(model: &'a M, p: &[f64]) -> Self {
        let about = model.about();
        let (states, inputs) = (about.states.len(), about.inputs.len());
        let mut nonzeros = vec![0.0; about.matrices.len()];
        model.matrices(p, &vec![0.0; states], &vec![0.0; inputs], &mut nonzeros);
        let (mut a, mut b) = (DMatrix::zeros(states, states), DMatrix::zeros(states, inputs));
        for (entry, value) in about.matrices.iter().zip(nonzeros) {
            let place = (usize::from(entry.row), usize::from(entry.column));
            match entry.matrix {
                Matrix::A => a[place] = Complex::from(value),
                Matrix::B => b[place] = Complex::from(value),
                Matrix::C | Matrix::D => {}
            }
        }
        Self { about, a, b }
    }

    /// The complex force on the wheel for a displacement of one; `None` where no force can be put on it, or where
    /// something would move without end.
    fn force(&self, clamped: &str, wheel: &ContactAxis) -> Option<Complex<f64>> {
        let moved = usize::from(wheel.velocity);
        let prescribed = self.prescribed(clamped, wheel);
        let free: Vec<usize> = (0..prescribed.len()).filter(|&i| prescribed[i].is_none()).collect();
        let mut x = DVector::from_iterator(prescribed.len(), prescribed.iter().map(|x| x.unwrap_or_default()));
        let u = self.inputs(wheel);
        let missing = |x: &DVector<_>| x * Complex::new(0.0, SLOW) - &self.a * x - &self.b * &u;
        let right = -missing(&x).select_rows(&free);
        let rates = DMatrix::from_diagonal_element(x.len(), x.len(), Complex::new(0.0, SLOW)) - &self.a;
        let answer = rates.select_rows(&free).select_columns(&free).lu().solve(&right)?;
        free.iter().zip(answer.iter()).for_each(|(&i, value)| x[i] = *value);
        Some(missing(&x)[moved] / self.b[(moved, self.handle(moved)?)])
    }

    /// The force input that accelerates the wheel.
    fn handle(&self, moved: usize) -> Option<usize> {
        let mut inputs = self.about.inputs.iter().enumerate();
        let acts = |at: usize| self.b[(moved, at)] != Complex::ZERO;
        let found = inputs.find(|(at, input)| matches!(input.kind, InputKind::Force(_)) && acts(*at));
        found.map(|(at, _)| at)
    }

    /// What the rig prescribes of each state; `None` where it is free.
    fn prescribed(&self, clamped: &str, wheel: &ContactAxis) -> Vec<Option<Complex<f64>>> {
        let [position, velocity] = [wheel.position, wheel.velocity].map(usize::from);
        let held = [clamped, &self.about.states[position].location];
        let states = self.about.states.iter().enumerate();
        let prescribed = states.map(|(at, state)| {
            if at == position {
                Some(Complex::ONE)
            } else if at == velocity {
                Some(Complex::new(0.0, SLOW))
            } else if state.kind == StateKind::Inner || held.contains(&&*state.location) {
                Some(Complex::ZERO)
            } else {
                None
            }
        });
        prescribed.collect()
    }

    /// The road moves with the wheel; nothing else acts.
    fn inputs(&self, wheel: &ContactAxis) -> DVector<Complex<f64>> {
        let value = |kind: InputKind| match kind {
            InputKind::Motion(excitation, quantity) => {
                let excitation = &self.about.excitations[usize::from(excitation)];
                let moves = excitation.road && excitation.axis == wheel.axis;
                let rate = Complex::new(0.0, SLOW).powi(quantity as i32);
                if moves { rate } else { Complex::ZERO }
            }
            InputKind::Force(_) | InputKind::Gravity => Complex::ZERO,
        };
        DVector::from_iterator(
            self.about.inputs.len(),
            self.about.inputs.iter().map(|input| value(input.kind)),
        )
    }
}
