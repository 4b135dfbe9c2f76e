//! Interface between compiler and workbench: the trait of a compiled axle model.
//!
//! Generated types and the run-time evaluator implement [`Model`]; the workbench uses nothing else of an axle. All
//! quantities are SI. Slices have the lengths that [`About`] states. A shorter one is a bug of the caller and panics
//! once, at the beginning of the call, so that the straight-line code after it needs no bounds checks.

// The description of a model.
mod about;
// Arguments and results of an evaluation.
mod evaluation;
// Roles of the parameters of an effect.
mod role;

pub use about::{
    About, Channel, Clock, ContactAbout, ContactAxis, Default, Entry, Excitation, Input, InputKind, Link, Mass, Matrix,
    Output, Parameter, Quantity, ResponseLayout, Signal, SignalKind, State, StateKind,
};
use evaluation::one_by_one;
pub use evaluation::{Contact, Contacts, LANES, Lanes, Points, ResponseMut};
pub use role::ParameterRole;

/// A compiled axle model.
pub trait Model: Send + Sync {
    /// Names, units, sizes and sparsity.
    fn about(&self) -> &About;

    /// Computes once the constants that depend on the parameters alone: `p` (one value for each parameter) to
    /// `constants`.
    fn prepare(&self, p: &[f64], constants: &mut [f64]);

    /// The equations of motion `dx = f(x, u)` for a prepared parameter set.
    fn derivative(&self, constants: &[f64], x: &[f64], u: &[f64], dx: &mut [f64]);

    /// The outputs `y = h(x, u)` for a prepared parameter set.
    fn outputs(&self, constants: &[f64], x: &[f64], u: &[f64], y: &mut [f64]);

    /// Nonzeros of A = ∂f/∂x, B = ∂f/∂u, C = ∂h/∂x, D = ∂h/∂u, in the order of [`About::matrices`].
    ///
    /// A linear model ignores `x` and `u`.
    fn matrices(&self, p: &[f64], x: &[f64], u: &[f64], nonzeros: &mut [f64]);

    /// Nonzeros of the parameter Jacobians of A, B, C and D, in the order of [`About::sensitivities`].
    fn sensitivities(&self, p: &[f64], x: &[f64], u: &[f64], nonzeros: &mut [f64]);

    /// Nonzeros of ∂f/∂p and ∂h/∂p, in the order of [`About::parameter_jacobian`].
    fn parameter_jacobian(&self, p: &[f64], x: &[f64], u: &[f64], nonzeros: &mut [f64]);

    /// [`Model::derivative`] at several points, a row of them for each entry of `dx`.
    fn derivative_at(&self, constants: &[f64], points: &Points, dx: &mut [f64]) {
        points.one_by_one(dx, |x, u, dx| self.derivative(constants, x, u, dx));
    }

    /// [`Model::outputs`] at several points, a row of them for each output.
    fn outputs_at(&self, constants: &[f64], points: &Points, y: &mut [f64]) {
        points.one_by_one(y, |x, u, y| self.outputs(constants, x, u, y));
    }

    /// [`Model::matrices`] at several points, a row of them for each nonzero.
    fn matrices_at(&self, p: &[f64], points: &Points, nonzeros: &mut [f64]) {
        points.one_by_one(nonzeros, |x, u, nonzeros| self.matrices(p, x, u, nonzeros));
    }

    /// [`Model::parameter_jacobian`] at several points, a row of them for each nonzero.
    fn parameter_jacobian_at(&self, p: &[f64], points: &Points, nonzeros: &mut [f64]) {
        points.one_by_one(nonzeros, |x, u, nonzeros| self.parameter_jacobian(p, x, u, nonzeros));
    }

    /// [`Model::prepare`] for several parameter sets at once; each row has one value of all of them.
    fn prepare_sets(&self, p: &[Lanes], constants: &mut [Lanes]) {
        one_by_one([p, &[], &[]], constants, |p, _, _, constants| {
            self.prepare(p, constants)
        });
    }

    /// [`Model::derivative`] for several prepared parameter sets, each at its own state and input.
    fn derivative_sets(&self, constants: &[Lanes], x: &[Lanes], u: &[Lanes], dx: &mut [Lanes]) {
        one_by_one([constants, x, u], dx, |constants, x, u, dx| {
            self.derivative(constants, x, u, dx)
        });
    }

    /// [`Model::outputs`] for several prepared parameter sets, each at its own state and input.
    fn outputs_sets(&self, constants: &[Lanes], x: &[Lanes], u: &[Lanes], y: &mut [Lanes]) {
        one_by_one([constants, x, u], y, |constants, x, u, y| {
            self.outputs(constants, x, u, y)
        });
    }

    /// [`Model::matrices`] for several parameter sets, each at its own state and input. The bits are the same.
    fn matrices_sets(&self, p: &[Lanes], x: &[Lanes], u: &[Lanes], nonzeros: &mut [Lanes]) {
        one_by_one([p, x, u], nonzeros, |p, x, u, nonzeros| {
            self.matrices(p, x, u, nonzeros)
        });
    }

    /// [`Model::sensitivities`] for several parameter sets, each at its own state and input.
    fn sensitivities_sets(&self, p: &[Lanes], x: &[Lanes], u: &[Lanes], nonzeros: &mut [Lanes]) {
        one_by_one([p, x, u], nonzeros, |p, x, u, nonzeros| {
            self.sensitivities(p, x, u, nonzeros)
        });
    }

    /// The frequency response of a linear model to one excitation, and its parameter Jacobian if wanted.
    ///
    /// [`ResponseLayout`] describes the rows. A nonlinear model has no response.
    fn response(&self, excitation: usize, _constants: &[f64], _omega: &[f64], _into: ResponseMut<'_>) {
        panic!(
            "excitation {excitation} of {}, which has no frequency response",
            self.about().name
        );
    }

    /// [`Model::response`] for several prepared parameter sets. For each line there is a row with the real part of each
    /// output, a row with the imaginary part of each, and, `with_jacobian`, the same for the parameter Jacobian. The
    /// bits are the same.
    ///
    /// The rows of all lines of eight sets seldom fit into a cache: it pays to ask for some lines at a time, and to use
    /// them at once.
    fn response_sets(
        &self,
        excitation: usize,
        constants: &[Lanes],
        omega: &[f64],
        with_jacobian: bool,
        into: &mut [Lanes],
    ) {
        let rows = self.about().responses[excitation].rows(with_jacobian);
        for (omega, into) in omega.iter().zip(into.chunks_exact_mut(rows)) {
            self.line_sets(excitation, constants, *omega, with_jacobian, into);
        }
    }

    /// [`Model::response_sets`] of one line.
    fn line_sets(&self, excitation: usize, constants: &[Lanes], omega: f64, with_jacobian: bool, into: &mut [Lanes]) {
        let layout = &self.about().responses[excitation];
        let (n, m) = (layout.outputs.len(), layout.slopes(with_jacobian));
        one_by_one([constants, &[], &[]], into, |constants, _, _, found| {
            let (re, rest) = found.split_at_mut(n);
            let (im, rest) = rest.split_at_mut(n);
            let jacobian = with_jacobian.then(|| rest.split_at_mut(m));
            self.response(excitation, constants, &[omega], ResponseMut { re, im, jacobian });
        });
    }

    /// The resisting force (N, positive in tension) of the tyre link while it rolls, at stretch `s` (m, negative in
    /// compression) and rate `v` (m/s), with the inner states in `x`. Zero without [`About::contact`].
    fn contact_force(&self, _constants: &[f64], _x: &[f64], _s: f64, _v: f64) -> f64 {
        0.0
    }

    /// The equations of motion with the tyre rolling over a profile: its link is taken out, the forces of `contact`
    /// act on its wheel instead, and its inner states follow `contact.s` and `contact.v`. Without
    /// [`About::contact`] it is [`Model::derivative`].
    fn rolling_derivative(&self, constants: &[f64], x: &[f64], u: &[f64], _contact: &Contact, dx: &mut [f64]) {
        self.derivative(constants, x, u, dx);
    }

    /// The outputs with the tyre rolling over a profile. Without [`About::contact`] it is [`Model::outputs`].
    fn rolling_outputs(&self, constants: &[f64], x: &[f64], u: &[f64], _contact: &Contact, y: &mut [f64]) {
        self.outputs(constants, x, u, y);
    }

    /// [`Model::contact_force`] for several prepared parameter sets, each in its own state. The bits are the same.
    fn contact_force_sets(&self, constants: &[Lanes], x: &[Lanes], s: &Lanes, v: &Lanes) -> Lanes {
        let mut force = [[0.0; LANES]];
        one_by_one([constants, x, &[*s, *v]], &mut force, |constants, x, contact, force| {
            force[0] = self.contact_force(constants, x, contact[0], contact[1]);
        });
        force[0]
    }

    /// [`Model::rolling_derivative`] for several prepared parameter sets, each with its own state and contact. The bits
    /// are the same.
    fn rolling_derivative_sets(
        &self,
        constants: &[Lanes],
        x: &[Lanes],
        u: &[Lanes],
        contacts: &Contacts,
        dx: &mut [Lanes],
    ) {
        let given = [u, &contacts.entries()].concat();
        one_by_one([constants, x, &given], dx, |constants, x, given, dx| {
            let (u, contact) = given.split_at(u.len());
            self.rolling_derivative(constants, x, u, &Contact::of_entries(contact), dx);
        });
    }

    /// [`Model::rolling_outputs`] for several prepared parameter sets, each with its own state and contact. The bits are
    /// the same.
    fn rolling_outputs_sets(
        &self,
        constants: &[Lanes],
        x: &[Lanes],
        u: &[Lanes],
        contacts: &Contacts,
        y: &mut [Lanes],
    ) {
        let given = [u, &contacts.entries()].concat();
        one_by_one([constants, x, &given], y, |constants, x, given, y| {
            let (u, contact) = given.split_at(u.len());
            self.rolling_outputs(constants, x, u, &Contact::of_entries(contact), y);
        });
    }

    /// A link, given by its position in [`About::links`], on a dynamometer: a model with the same parameters, whose
    /// only motion is the link's stretch and whose only output is its force. `None` for a link that was not compiled in
    /// this way.
    fn alone(&self, _link: usize) -> Option<&dyn Model> {
        None
    }
}
