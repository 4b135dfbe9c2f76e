//! The description of a model: names, units, indices and sparsity.

use std::borrow::Cow;

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

    /// The names of the row and the column of a place in A, B, C or D.
    pub fn relates(&self, entry: &Entry) -> (&str, &str) {
        let (row, column) = (usize::from(entry.row), usize::from(entry.column));
        let row = match entry.matrix {
            Matrix::A | Matrix::B => &self.states[row].name,
            Matrix::C | Matrix::D => &self.outputs[row].name,
        };
        let column = match entry.matrix {
            Matrix::A | Matrix::C => &self.states[column].name,
            Matrix::B | Matrix::D => &self.inputs[column].name,
        };
        (row, column)
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
    /// Its default.
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

/// The default of a parameter.
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
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Entry {
    /// Which.
    pub matrix: Matrix,
    /// Row.
    pub row: u16,
    /// Column.
    pub column: u16,
}

impl ResponseLayout {
    /// How many rows its parameter Jacobian has, where it is wanted.
    pub fn slopes(&self, wanted: bool) -> usize {
        if wanted { self.jacobian.len() } else { 0 }
    }

    /// How many rows there are in all, real and imaginary parts each for itself.
    pub fn rows(&self, with_jacobian: bool) -> usize {
        2 * (self.outputs.len() + self.slopes(with_jacobian))
    }
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
