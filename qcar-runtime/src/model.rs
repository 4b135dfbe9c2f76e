//! The seam between compiler and workbench: what a compiled axle model offers.
//!
//! Generated types and the run-time evaluator implement [`Model`]; the workbench knows nothing else of an axle.
//! All quantities are SI. Slices have the lengths that [`About`] states; a shorter one is a caller's bug and panics
//! once, at the top of the call, so that no bounds check is left in the straight-line code below it.

use std::borrow::Cow;

/// A compiled axle model.
pub trait Model: Send + Sync {
    /// Names, units, sizes and sparsity.
    fn about(&self) -> &About;

    /// Computes once what depends on the parameters alone: `p` (one value a parameter) to `constants`.
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

    /// [`Model::prepare`] of several parameter sets at once, each row one value of all of them.
    fn prepare_sets(&self, p: &[Lanes], constants: &mut [Lanes]) {
        one_by_one([p, &[], &[]], constants, |p, _, _, constants| {
            self.prepare(p, constants)
        });
    }

    /// [`Model::derivative`] of several prepared parameter sets, each at a state and input of its own.
    fn derivative_sets(&self, constants: &[Lanes], x: &[Lanes], u: &[Lanes], dx: &mut [Lanes]) {
        one_by_one([constants, x, u], dx, |constants, x, u, dx| {
            self.derivative(constants, x, u, dx)
        });
    }

    /// [`Model::matrices`] of several parameter sets, each at a state and input of its own. The bits are the same.
    fn matrices_sets(&self, p: &[Lanes], x: &[Lanes], u: &[Lanes], nonzeros: &mut [Lanes]) {
        one_by_one([p, x, u], nonzeros, |p, x, u, nonzeros| {
            self.matrices(p, x, u, nonzeros)
        });
    }

    /// [`Model::sensitivities`] of several parameter sets, each at a state and input of its own.
    fn sensitivities_sets(&self, p: &[Lanes], x: &[Lanes], u: &[Lanes], nonzeros: &mut [Lanes]) {
        one_by_one([p, x, u], nonzeros, |p, x, u, nonzeros| {
            self.sensitivities(p, x, u, nonzeros)
        });
    }

    /// The frequency response of a linear model to one excitation, and where asked for its parameter Jacobian.
    ///
    /// See [`ResponseLayout`] for what is written where. A nonlinear model has no excitation to ask for.
    fn response(&self, excitation: usize, _constants: &[f64], _omega: &[f64], _into: ResponseMut<'_>) {
        panic!(
            "excitation {excitation} of {}, which has no frequency response",
            self.about().name
        );
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
}

/// What a tyre that rolls over a profile gives to its model.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Contact {
    /// Equivalent stretch, m: minus the deflection on a flat road that would have the same contact.
    pub s: f64,
    /// Its rate, m/s.
    pub v: f64,
    /// The force on the wheel along [`ContactAbout::axes`], N.
    pub force: [f64; 2],
}

/// How many parameter sets, or lines of a frequency response, are computed together.
pub const LANES: usize = 8;

/// One value of each of several parameter sets.
pub type Lanes = [f64; LANES];

/// Lets `work` find from the values of each set what stands there in the rows `into`.
fn one_by_one(from: [&[Lanes]; 3], into: &mut [Lanes], mut work: impl FnMut(&[f64], &[f64], &[f64], &mut [f64])) {
    let mut of_set = from.map(|rows| vec![0.0; rows.len()]);
    let mut found = vec![0.0; into.len()];
    for set in 0..LANES {
        for (values, rows) in of_set.iter_mut().zip(from) {
            values.iter_mut().zip(rows).for_each(|(value, row)| *value = row[set]);
        }
        let [a, b, c] = &of_set;
        work(a, b, c, &mut found);
        into.iter_mut().zip(&found).for_each(|(row, value)| row[set] = *value);
    }
}

/// States and inputs at several points: structure of arrays, so that a model may work on many points at once.
#[derive(Clone, Copy, Debug)]
pub struct Points<'a> {
    /// How many.
    pub count: usize,
    /// A row of `count` points for each state.
    pub x: &'a [f64],
    /// A row of `count` points for each input.
    pub u: &'a [f64],
}

impl Points<'_> {
    /// Lets `work` find from the states and inputs of each point what stands there in the rows `into`.
    fn one_by_one(&self, into: &mut [f64], mut work: impl FnMut(&[f64], &[f64], &mut [f64])) {
        let room = |rows: &[f64]| vec![0.0; rows.len() / self.count.max(1)];
        let (mut x, mut u, mut found) = (room(self.x), room(self.u), room(into));
        let take = |rows: &[f64], point: usize, column: &mut [f64]| {
            let rows = rows.iter().skip(point).step_by(self.count);
            column.iter_mut().zip(rows).for_each(|(value, row)| *value = *row);
        };
        for point in 0..self.count {
            take(self.x, point, &mut x);
            take(self.u, point, &mut u);
            work(&x, &u, &mut found);
            for (row, value) in into.chunks_exact_mut(self.count).zip(&found) {
                row[point] = *value;
            }
        }
    }
}

/// Where a frequency response is written: structure of arrays, a row of `omega.len()` lines for each entry.
pub struct ResponseMut<'a> {
    /// Real parts, row after row, in the order of [`ResponseLayout::outputs`].
    pub re: &'a mut [f64],
    /// Imaginary parts.
    pub im: &'a mut [f64],
    /// Real and imaginary parts of the parameter Jacobian, in the order of [`ResponseLayout::jacobian`], where wanted.
    pub jacobian: Option<(&'a mut [f64], &'a mut [f64])>,
}

/// What there is to know of a model without evaluating it.
#[derive(Clone, Debug, PartialEq)]
pub struct About {
    /// Snake case.
    pub name: Cow<'static, str>,
    /// The sentence that describes it.
    pub doc: Cow<'static, str>,
    /// In the order of `p`.
    pub parameters: Cow<'static, [Parameter]>,
    /// In the order of `x`.
    pub states: Cow<'static, [State]>,
    /// In the order of `u`.
    pub inputs: Cow<'static, [Input]>,
    /// In the order of `y`.
    pub outputs: Cow<'static, [Output]>,
    /// Harmonic excitations: each prescribed motion and each force input.
    pub excitations: Cow<'static, [Excitation]>,
    /// Named ratios of two signals.
    pub channels: Cow<'static, [Channel]>,
    /// The force elements.
    pub links: Cow<'static, [Link]>,
    /// The inertias.
    pub masses: Cow<'static, [Mass]>,
    /// The tyre link that can roll over a profile.
    pub contact: Option<ContactAbout>,
    /// Length of `constants`.
    pub constants: usize,
    /// True where f and h are linear in x and u.
    pub linear: bool,
    /// The nonzeros of A, B, C and D.
    pub matrices: Cow<'static, [Entry]>,
    /// The nonzeros of their parameter Jacobians, with the parameter.
    pub sensitivities: Cow<'static, [(Entry, u16)]>,
    /// The nonzeros of ∂f/∂p (block A's rows) and ∂h/∂p (block C's rows): is it an output, row, parameter.
    pub parameter_jacobian: Cow<'static, [(bool, u16, u16)]>,
    /// For each excitation; empty for a nonlinear model.
    pub responses: Cow<'static, [ResponseLayout]>,
}

impl About {
    /// The state whose rate a signal is: the velocity of a mass, for its acceleration.
    pub fn rate(&self, signal: &Signal) -> Option<usize> {
        let moves = |state: &State| state.axis == signal.axis && state.location == signal.location;
        let accelerates = signal.kind == SignalKind::Motion(Quantity::Acceleration);
        let velocity = |state: &State| state.kind == StateKind::Velocity && accelerates && moves(state);
        self.states.iter().position(velocity)
    }
}

/// A parameter of the model.
#[derive(Clone, Debug, PartialEq)]
pub struct Parameter {
    /// Name.
    pub name: Cow<'static, str>,
    /// Unit, as in `N s/m`.
    pub unit: Cow<'static, str>,
    /// Sentence.
    pub doc: Cow<'static, str>,
    /// What it is when nobody gives it a value.
    pub default: Default,
    /// Bounds.
    pub range: Option<(f64, f64)>,
    /// True where it is never estimated unless a campaign asks for it.
    pub known: bool,
    /// Set where it is the time since a run began.
    pub clock: Option<Clock>,
}

/// How the time since a run began is counted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Clock {
    /// In s.
    Seconds,
    /// In parts of the run: from 0 at its beginning to 1 at its end.
    PartOfRun,
}

/// What a parameter is when nobody gives it a value.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Default {
    /// It must be given.
    None,
    /// A value.
    Value(f64),
    /// The value of another parameter, by its place.
    Same(u16),
}

/// A state of the model.
#[derive(Clone, Debug, PartialEq)]
pub struct State {
    /// `z_wheel`, `vz_wheel` or, for an inner state, `damper.f`.
    pub name: Cow<'static, str>,
    /// Unit.
    pub unit: Cow<'static, str>,
    /// The mass or node that moves, or the link of an inner state.
    pub location: Cow<'static, str>,
    /// `z`, `x`.
    pub axis: Cow<'static, str>,
    /// What it is.
    pub kind: StateKind,
}

/// What a state is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum StateKind {
    /// The position of a mass or node.
    Position,
    /// The velocity of a mass.
    Velocity,
    /// An inner state of a link's law.
    Inner,
}

/// An entry of `u`.
#[derive(Clone, Debug, PartialEq)]
pub struct Input {
    /// `z_pad`, `vz_pad`, `az_pad`, `f_wheel_z`, `g`.
    pub name: Cow<'static, str>,
    /// Unit.
    pub unit: Cow<'static, str>,
    /// `z`, `x`.
    pub axis: Cow<'static, str>,
    /// What it is.
    pub kind: InputKind,
}

/// What an entry of `u` is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum InputKind {
    /// The position, velocity or acceleration of the prescribed motion that is this excitation.
    Motion(u16, Quantity),
    /// The force that is this excitation.
    Force(u16),
    /// A uniform acceleration, m/s².
    Gravity,
}

/// A harmonic excitation: unit displacement of a prescribed motion, or unit force.
#[derive(Clone, Debug, PartialEq)]
pub struct Excitation {
    /// `pad`, `f_wheel_z`.
    pub name: Cow<'static, str>,
    /// `z`, `x`.
    pub axis: Cow<'static, str>,
    /// True for a force (response per N), false for a motion (response per m).
    pub force: bool,
    /// True for a road.
    pub road: bool,
}

/// A derivative of a motion.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
#[expect(missing_docs, reason = "each says it")]
pub enum Quantity {
    Position,
    Velocity,
    Acceleration,
}

/// What can be measured: where, along which axis, what.
#[derive(Clone, Debug, PartialEq)]
pub struct Signal {
    /// A mass, node, motion or link.
    pub location: Cow<'static, str>,
    /// `z`, `x`.
    pub axis: Cow<'static, str>,
    /// What.
    pub kind: SignalKind,
}

/// What a signal measures.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum SignalKind {
    /// A motion of a mass, node or prescribed motion.
    Motion(Quantity),
    /// The resisting force of a link, N, positive in tension.
    Force,
    /// The stretch of a link, m, positive in extension.
    Stretch,
}

/// An entry of `y`.
#[derive(Clone, Debug, PartialEq)]
pub struct Output {
    /// `z_body_acceleration`.
    pub name: Cow<'static, str>,
    /// Unit.
    pub unit: Cow<'static, str>,
    /// What it measures.
    pub signal: Signal,
}

/// A named ratio of two signals, each an output or a prescribed motion.
#[derive(Clone, Debug, PartialEq)]
pub struct Channel {
    /// `pad_to_body`.
    pub name: Cow<'static, str>,
    /// Above the line.
    pub numerator: Signal,
    /// Below the line.
    pub denominator: Signal,
}

/// A force element.
#[derive(Clone, Debug, PartialEq)]
pub struct Link {
    /// Name.
    pub name: Cow<'static, str>,
    /// Axis.
    pub axis: Cow<'static, str>,
    /// The coordinates it acts between, in the order of its stretch.
    pub ends: Cow<'static, [Cow<'static, str>]>,
    /// The parameters on which its law depends, by their places, in that order.
    pub parameters: Cow<'static, [u16]>,
}

/// An inertia: a mass that moves along an axis, or a moment of inertia that turns.
#[derive(Clone, Debug, PartialEq)]
pub struct Mass {
    /// What moves.
    pub location: Cow<'static, str>,
    /// `z`, `x`.
    pub axis: Cow<'static, str>,
    /// True for what turns.
    pub angle: bool,
    /// The parameters of which it is made, by their places, in that order.
    pub parameters: Cow<'static, [u16]>,
}

/// The tyre link that can roll over a profile: the one whose stretch joins a mass to a road.
#[derive(Clone, Debug, PartialEq)]
pub struct ContactAbout {
    /// Its place in [`About::links`].
    pub link: u16,
    /// The mass that it carries: places of its position and velocity in `x`, along the direction of the link and,
    /// where that mass moves in a second direction too, along that one.
    pub axes: Cow<'static, [ContactAxis]>,
}

/// A direction in which the wheel of a rolling tyre moves.
#[derive(Clone, Debug, PartialEq)]
pub struct ContactAxis {
    /// `z`, `x`.
    pub axis: Cow<'static, str>,
    /// Place of the wheel's position in `x`.
    pub position: u16,
    /// Place of its velocity.
    pub velocity: u16,
}

/// A place in A, B, C or D.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Entry {
    /// Which.
    pub matrix: Matrix,
    /// Row.
    pub row: u16,
    /// Column.
    pub column: u16,
}

impl Entry {
    /// A place in a matrix.
    pub const fn at(matrix: Matrix, row: u16, column: u16) -> Entry {
        Entry { matrix, row, column }
    }
}

/// A matrix of the state-space form.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
#[expect(missing_docs, reason = "the names of the field")]
pub enum Matrix {
    A,
    B,
    C,
    D,
}

/// The rows of the response to one excitation. What is not listed is zero at every frequency.
#[derive(Clone, Debug, PartialEq)]
pub struct ResponseLayout {
    /// Outputs (places in `y`) that respond.
    pub outputs: Cow<'static, [u16]>,
    /// Nonzeros of the parameter Jacobian: place in `outputs` of this layout, parameter.
    pub jacobian: Cow<'static, [(u16, u16)]>,
}
