//! A model with its suspension travel as a further output.

use std::borrow::Cow;

use crate::campaign::RoleNames;
use crate::model::{
    About, Contact, Contacts, Entry, Lanes, Matrix, Model, Output, ResponseMut, Signal, SignalKind, StateKind,
};
use crate::roles::{Roles, state};

/// Name of the added output.
pub const TRAVEL: &str = "suspension_travel";

/// A model with one output more: the height of the wheel over the body relative to rest, m. It is not added if the
/// structure of the model does not determine wheel and body.
pub struct WithTravel<'a> {
    inner: &'a dyn Model,
    about: About,
    /// Indices of the states that are the positions of wheel and body.
    travel: Option<[usize; 2]>,
}

impl<'a> WithTravel<'a> {
    /// Adds the output to a model.
    pub fn new(inner: &'a dyn Model, names: &RoleNames) -> Self {
        let mut about = inner.about().clone();
        let travel = travel(&about, names);
        if let Some(places) = travel {
            let row = about.outputs.len() as u16;
            let wheel = &about.states[places[0]];
            let signal = Signal {
                location: wheel.location.clone(),
                axis: wheel.axis.clone(),
                kind: SignalKind::Stretch,
            };
            about.outputs.to_mut().push(Output {
                name: Cow::Borrowed(TRAVEL),
                unit: Cow::Borrowed("m"),
                signal,
            });
            let entries = places.map(|place| Entry::at(Matrix::C, row, place as u16));
            about.matrices.to_mut().extend(entries);
        }
        Self { inner, about, travel }
    }

    /// Position of the added output; `None` without one.
    pub fn added(&self) -> Option<usize> {
        self.travel.map(|_| self.own())
    }

    /// The model without it.
    pub fn inner(&self) -> &'a dyn Model {
        self.inner
    }

    fn own(&self) -> usize {
        self.inner.about().outputs.len()
    }

    fn add_travel(&self, x: &[f64], y: &mut [f64]) {
        if let Some([wheel, body]) = self.travel {
            y[self.own()] = x[wheel] - x[body];
        }
    }
}

fn travel(about: &About, names: &RoleNames) -> Option<[usize; 2]> {
    let roles = Roles::of(about, names).ok()?;
    let on_rig = roles.on_rig().ok()?;
    let place = |mass: &str| state(about, StateKind::Position, mass, &roles.axis);
    Some([place(&on_rig.wheel)?, place(&on_rig.body)?])
}

impl Model for WithTravel<'_> {
    fn about(&self) -> &About {
        &self.about
    }

    fn prepare(&self, p: &[f64], constants: &mut [f64]) {
        self.inner.prepare(p, constants);
    }

    fn derivative(&self, constants: &[f64], x: &[f64], u: &[f64], dx: &mut [f64]) {
        self.inner.derivative(constants, x, u, dx);
    }

    fn outputs(&self, constants: &[f64], x: &[f64], u: &[f64], y: &mut [f64]) {
        self.inner.outputs(constants, x, u, &mut y[..self.own()]);
        self.add_travel(x, y);
    }

    fn matrices(&self, p: &[f64], x: &[f64], u: &[f64], nonzeros: &mut [f64]) {
        let own = self.inner.about().matrices.len();
        self.inner.matrices(p, x, u, &mut nonzeros[..own]);
        if self.travel.is_some() {
            nonzeros[own..].copy_from_slice(&[1.0, -1.0]);
        }
    }

    fn sensitivities(&self, p: &[f64], x: &[f64], u: &[f64], nonzeros: &mut [f64]) {
        self.inner.sensitivities(p, x, u, nonzeros);
    }

    fn parameter_jacobian(&self, p: &[f64], x: &[f64], u: &[f64], nonzeros: &mut [f64]) {
        self.inner.parameter_jacobian(p, x, u, nonzeros);
    }

    fn response(&self, excitation: usize, constants: &[f64], omega: &[f64], into: ResponseMut<'_>) {
        self.inner.response(excitation, constants, omega, into);
    }

    fn contact_force(&self, constants: &[f64], x: &[f64], s: f64, v: f64) -> f64 {
        self.inner.contact_force(constants, x, s, v)
    }

    fn rolling_derivative(&self, constants: &[f64], x: &[f64], u: &[f64], contact: &Contact, dx: &mut [f64]) {
        self.inner.rolling_derivative(constants, x, u, contact, dx);
    }

    fn contact_force_sets(&self, constants: &[Lanes], x: &[Lanes], s: &Lanes, v: &Lanes) -> Lanes {
        self.inner.contact_force_sets(constants, x, s, v)
    }

    fn rolling_derivative_sets(
        &self,
        constants: &[Lanes],
        x: &[Lanes],
        u: &[Lanes],
        contacts: &Contacts,
        dx: &mut [Lanes],
    ) {
        self.inner.rolling_derivative_sets(constants, x, u, contacts, dx);
    }

    fn rolling_outputs_sets(
        &self,
        constants: &[Lanes],
        x: &[Lanes],
        u: &[Lanes],
        contacts: &Contacts,
        y: &mut [Lanes],
    ) {
        let own = &mut y[..self.own()];
        self.inner.rolling_outputs_sets(constants, x, u, contacts, own);
        if let Some([wheel, body]) = self.travel {
            y[self.own()] = std::array::from_fn(|lane| x[wheel][lane] - x[body][lane]);
        }
    }

    fn rolling_outputs(&self, constants: &[f64], x: &[f64], u: &[f64], contact: &Contact, y: &mut [f64]) {
        self.inner
            .rolling_outputs(constants, x, u, contact, &mut y[..self.own()]);
        self.add_travel(x, y);
    }
}
