//! A model on a K&C rig: the body is clamped, the wheel is moved slowly, and the force on the wheel is measured.
//!
//! Sub-frame, powertrain and top mount yield to the forces on them. So the gradient at the wheel is that of several
//! links in series, and a parameter is found as the value for which the model has the measured gradient.

use nalgebra::{Complex, DVector};

use crate::banded::Ordered;
use crate::matrices::at_rest;
use crate::model::{About, Contact, InputKind, Matrix, Model, StateKind};
use crate::response::parameters::Values;
use crate::roles::{OnRig, state};

/// Gradient of the force on the wheel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Slope {
    /// Over displacement, N/m.
    Stiffness,
    /// Over velocity, N s/m.
    Damping,
}

/// Angular frequency, rad/s: so low that inertia is negligible (1e-6 of the wheel's spring), and that damper forces are
/// still resolved.
const SLOW: f64 = 0.06;
/// Range of the search for a parameter without bounds, as a factor of its value.
const REACH: f64 = 100.0;
const HALVINGS: usize = 60;

/// The gradient of the force on the wheel, moved along `axis` with the body held.
///
/// The model is linearised at rest, and inner states of laws stay at zero, since friction is no gradient. The road
/// moves with the wheel. `None` if wheel or body does not move along the axis, or if no force can act on the wheel.
pub fn gradient<M: Model + ?Sized>(model: &M, p: &[f64], on: &OnRig, axis: &str, slope: Slope) -> Option<f64> {
    let force = Rig::new(model, p, on, axis)?.force();
    let found = match slope {
        Slope::Stiffness => force.re,
        Slope::Damping => force.im / SLOW,
    };
    found.is_finite().then_some(found)
}

/// Value of a parameter for which a model has the `measured` gradient, with all others as in `values`.
///
/// It is searched within the bounds of the parameter, assuming that the gradient increases with it. `None` if
/// [`gradient`] gives none, or if no value within the bounds gives the measured one.
pub fn value_for<M: Model + ?Sized>(
    model: &M,
    values: &Values,
    parameter: usize,
    (on, axis, slope): (&OnRig, &str, Slope),
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
        gradient(model, &p, on, axis, slope).map(|found| found - measured)
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

/// The parameter that a measured gradient determines: of those in the laws of the links at the wheel, except the tyre,
/// the one with the largest influence on the gradient of the model. Known and tied parameters are left out.
///
/// `None` if [`gradient`] gives none, or depends on none of them.
pub fn parameter_for<M: Model + ?Sized>(
    model: &M,
    values: &Values,
    (on, axis, slope): (&OnRig, &str, Slope),
) -> Option<usize> {
    let p = values.as_slice();
    let own = gradient(model, p, on, axis, slope)?;
    let change = |&parameter: &usize| {
        let mut moved = values.clone();
        moved.set(parameter, p[parameter] * (1.0 + STEP));
        let moved = gradient(model, moved.as_slice(), on, axis, slope)?;
        let share = (moved - own).abs() / (STEP * own.abs());
        (share > LEAST_SHARE).then_some((parameter, share))
    };
    let changes = at_wheel(model.about(), values, on, axis).into_iter();
    let changes = changes.filter_map(|parameter| change(&parameter));
    let most = changes.reduce(|most, next| if next.1 > most.1 { next } else { most });
    most.map(|(parameter, _)| parameter)
}

/// Relative change of a parameter for its influence, and the smallest relative change of a gradient that counts.
const STEP: f64 = 1e-3;
const LEAST_SHARE: f64 = 1e-3;

/// The parameters in the laws of the links at the wheel, in the order of the model.
fn at_wheel(about: &About, values: &Values, on: &OnRig, axis: &str) -> Vec<usize> {
    let tyre = about.contact.as_ref().map(|contact| usize::from(contact.link));
    let links = about.links.iter().enumerate().filter(|(place, link)| {
        let ends = link.ends.iter().any(|end| *end == *on.wheel);
        Some(*place) != tyre && link.axis == axis && ends
    });
    let parameters = links.flat_map(|(_, link)| link.parameters.iter().map(|&place| usize::from(place)));
    let mut own: Vec<usize> = parameters
        .filter(|&place| values.leader(place) == place && !about.parameters[place].known)
        .collect();
    own.sort_unstable();
    own.dedup();
    own
}

/// Change of `dx/dt` at rest by a unit force on a mass along an axis: by the contact of the tyre if it carries that
/// mass, otherwise by a force input of the model. `None` if neither acts on it.
pub(crate) fn of_unit_force<M: Model + ?Sized>(model: &M, p: &[f64], mass: &str, axis: &str) -> Option<Vec<f64>> {
    let about = model.about();
    let velocity = state(about, StateKind::Velocity, mass, axis)?;
    let mut constants = vec![0.0; about.constants];
    model.prepare(p, &mut constants);
    let (x, rest) = (vec![0.0; about.states.len()], vec![0.0; about.inputs.len()]);
    let difference = |rates: &dyn Fn(f64, &mut [f64])| -> Vec<f64> {
        let (mut pushed, mut alone) = (x.clone(), x.clone());
        rates(1.0, &mut pushed);
        rates(0.0, &mut alone);
        pushed.iter().zip(alone).map(|(pushed, alone)| pushed - alone).collect()
    };
    let axes = about.contact.iter().flat_map(|contact| contact.axes.iter());
    if let Some(at) = axes
        .map(|axis| usize::from(axis.velocity))
        .position(|at| at == velocity)
    {
        return Some(difference(&|force, dx| {
            let mut contact = Contact::default();
            contact.force[at] = force;
            model.rolling_derivative(&constants, &x, &rest, &contact, dx);
        }));
    }
    let forces = about.inputs.iter().enumerate().filter(|(_, input)| {
        let is_force = matches!(input.kind, InputKind::Force(_));
        is_force && input.axis == axis
    });
    let mut found = forces.map(|(place, _)| {
        difference(&|force, dx| {
            let mut u = rest.clone();
            u[place] = force;
            model.derivative(&constants, &x, &u, dx);
        })
    });
    found.find(|of_unit| of_unit[velocity] != 0.0)
}

/// A linear model `dx/dt = A x + B u` with a unit displacement of its wheel.
struct Rig<'a> {
    about: &'a About,
    /// The nonzeros of the matrices, in the order of [`About::matrices`].
    nonzeros: Vec<f64>,
    axis: &'a str,
    /// Acceleration of the wheel by a unit force.
    of_unit: f64,
    /// Velocity of the wheel.
    moved: usize,
    /// Motion that the rig prescribes for each state; `None` if the state is free.
    prescribed: Vec<Option<Complex<f64>>>,
}

impl<'a> Rig<'a> {
    fn new<M: Model + ?Sized>(model: &'a M, p: &[f64], on: &OnRig, axis: &'a str) -> Option<Self> {
        let about = model.about();
        let position = state(about, StateKind::Position, &on.wheel, axis)?;
        let moved = state(about, StateKind::Velocity, &on.wheel, axis)?;
        state(about, StateKind::Position, &on.body, axis)?;
        let states = about.states.iter().enumerate();
        let prescribed = states.map(|(at, state)| {
            if at == position {
                Some(Complex::ONE)
            } else if at == moved {
                Some(Complex::new(0.0, SLOW))
            } else if state.kind == StateKind::Inner
                || [&on.wheel, &on.body].iter().any(|held| **held == state.location)
            {
                Some(Complex::ZERO)
            } else {
                None
            }
        });
        Some(Self {
            of_unit: of_unit_force(model, p, &on.wheel, axis)?[moved],
            prescribed: prescribed.collect(),
            about,
            nonzeros: at_rest(model, p),
            axis,
            moved,
        })
    }

    /// Complex force on the wheel for a unit displacement.
    fn force(&self) -> Complex<f64> {
        let prescribed = &self.prescribed;
        let free: Vec<usize> = (0..prescribed.len()).filter(|&i| prescribed[i].is_none()).collect();
        let mut x = DVector::from_iterator(prescribed.len(), prescribed.iter().map(|x| x.unwrap_or_default()));
        if !free.is_empty() {
            let right = self.missing(&x).select_rows(&free);
            let answer = self.among(&free).solution(Complex::new(0.0, SLOW), &right);
            free.iter().zip(answer.iter()).for_each(|(&i, value)| x[i] = *value);
        }
        self.missing(&x)[self.moved] / self.of_unit
    }

    /// What a motion would need beside the model's own `dx/dt`.
    fn missing(&self, x: &DVector<Complex<f64>>) -> DVector<Complex<f64>> {
        let (u, mut missing) = (self.inputs(), x * Complex::new(0.0, SLOW));
        for (entry, &value) in self.about.matrices.iter().zip(&self.nonzeros) {
            let (row, column) = (usize::from(entry.row), usize::from(entry.column));
            match entry.matrix {
                Matrix::A => missing[row] -= x[column] * value,
                Matrix::B => missing[row] -= u[column] * value,
                Matrix::C | Matrix::D => {}
            }
        }
        missing
    }

    /// A between the free states.
    fn among(&self, free: &[usize]) -> Ordered {
        let mut places = vec![None; self.prescribed.len()];
        free.iter()
            .enumerate()
            .for_each(|(place, &state)| places[state] = Some(place));
        let entries = self.about.matrices.iter().zip(&self.nonzeros);
        let entries = entries.filter(|(entry, _)| entry.matrix == Matrix::A);
        let nonzeros: Vec<_> = entries
            .filter_map(|(entry, &value)| {
                let [row, column] = [entry.row, entry.column].map(|state| places[usize::from(state)]);
                Some((row?, column?, value))
            })
            .collect();
        Ordered::of(free.len(), &nonzeros)
    }

    /// Input of the road, which moves with the wheel; all others are zero.
    fn inputs(&self) -> DVector<Complex<f64>> {
        let value = |kind: InputKind| match kind {
            InputKind::Motion(excitation, quantity) => {
                let excitation = &self.about.excitations[usize::from(excitation)];
                let moves = excitation.road && excitation.axis == self.axis;
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
