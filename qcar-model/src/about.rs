//! The description of a model: names, units, indices and sparsity.

use std::borrow::Cow;

/// Description of a model, available without evaluating it.
#[derive(Clone, Debug, PartialEq)]
pub struct About {
    /// Name, in snake case.
    pub name: Cow<'static, str>,
    /// Description.
    pub doc: Cow<'static, str>,
    /// Parameters, in the order of `p`.
    pub parameters: Cow<'static, [Parameter]>,
    /// States, in the order of `x`.
    pub states: Cow<'static, [State]>,
    /// Inputs, in the order of `u`.
    pub inputs: Cow<'static, [Input]>,
    /// Outputs, in the order of `y`.
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
    /// True if f and h are linear in x and u.
    pub linear: bool,
    /// The nonzeros of A, B, C and D.
    pub matrices: Cow<'static, [Entry]>,
    /// The nonzeros of their parameter Jacobians, with the parameter.
    pub sensitivities: Cow<'static, [(Entry, u16)]>,
    /// Nonzeros of ∂f/∂p (rows as in A) and ∂h/∂p (rows as in C): true for an output, row, parameter.
    pub parameter_jacobian: Cow<'static, [(bool, u16, u16)]>,
    /// Response layout of each excitation; empty for a nonlinear model.
    pub responses: Cow<'static, [ResponseLayout]>,
}

impl About {
    /// The state whose rate is a signal: the velocity of a mass, for its acceleration.
    pub fn rate(&self, signal: &Signal) -> Option<usize> {
        let moves = |state: &State| state.axis == signal.axis && state.location == signal.location;
        let accelerates = signal.kind == SignalKind::Motion(Quantity::Acceleration);
        let velocity = |state: &State| state.kind == StateKind::Velocity && accelerates && moves(state);
        self.states.iter().position(velocity)
    }

    /// Names of the row and the column of an entry of A, B, C or D.
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
    /// Description.
    pub doc: Cow<'static, str>,
    /// Default.
    pub default: Default,
    /// Bounds.
    pub range: Option<(f64, f64)>,
    /// True if it is estimated only if a campaign asks for it.
    pub known: bool,
    /// Unit of time if it is the time since the start of a run; `None` for any other parameter.
    pub clock: Option<Clock>,
}

/// Unit of the time since the start of a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Clock {
    /// In seconds.
    Seconds,
    /// Relative to the run: from 0 at its start to 1 at its end.
    PartOfRun,
}

/// The default of a parameter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Default {
    /// It must be given.
    None,
    /// A value.
    Value(f64),
    /// The value of another parameter, by its position.
    Same(u16),
}

/// A state of the model.
#[derive(Clone, Debug, PartialEq)]
pub struct State {
    /// Name: `z_wheel`, `vz_wheel` or, for an inner state, `damper.f`.
    pub name: Cow<'static, str>,
    /// Unit.
    pub unit: Cow<'static, str>,
    /// The moving mass or node, or the link of an inner state.
    pub location: Cow<'static, str>,
    /// Axis: `z`, `x`.
    pub axis: Cow<'static, str>,
    /// Kind.
    pub kind: StateKind,
}

/// Kind of a state.
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
    /// Name: `z_pad`, `vz_pad`, `az_pad`, `f_wheel_z`, `g`.
    pub name: Cow<'static, str>,
    /// Unit.
    pub unit: Cow<'static, str>,
    /// Axis: `z`, `x`.
    pub axis: Cow<'static, str>,
    /// Kind.
    pub kind: InputKind,
}

/// Kind of an entry of `u`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum InputKind {
    /// Position, velocity or acceleration of this excitation, a prescribed motion.
    Motion(u16, Quantity),
    /// Force of this excitation.
    Force(u16),
    /// A uniform acceleration, m/s².
    Gravity,
}

/// A harmonic excitation: unit displacement of a prescribed motion, or unit force.
#[derive(Clone, Debug, PartialEq)]
pub struct Excitation {
    /// Name: `pad`, `f_wheel_z`.
    pub name: Cow<'static, str>,
    /// Axis: `z`, `x`.
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

/// A measurable quantity: location, axis and kind.
#[derive(Clone, Debug, PartialEq)]
pub struct Signal {
    /// Location: a mass, node, motion or link.
    pub location: Cow<'static, str>,
    /// Axis: `z`, `x`.
    pub axis: Cow<'static, str>,
    /// Kind.
    pub kind: SignalKind,
}

/// Kind of a signal.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum SignalKind {
    /// A motion of a mass, node or prescribed motion.
    Motion(Quantity),
    /// The resisting force of a link, N, positive in tension.
    Force,
    /// The stretch of a link, m, positive in extension.
    Stretch,
}

impl SignalKind {
    /// The word for it in model files, as in `output body.acceleration;`.
    pub const fn word(self) -> &'static str {
        match self {
            SignalKind::Motion(Quantity::Position) => "position",
            SignalKind::Motion(Quantity::Velocity) => "velocity",
            SignalKind::Motion(Quantity::Acceleration) => "acceleration",
            SignalKind::Force => "force",
            SignalKind::Stretch => "stretch",
        }
    }
}

/// An entry of `y`.
#[derive(Clone, Debug, PartialEq)]
pub struct Output {
    /// Name, such as `z_body_acceleration`.
    pub name: Cow<'static, str>,
    /// Unit.
    pub unit: Cow<'static, str>,
    /// The signal.
    pub signal: Signal,
}

/// A named ratio of two signals, each an output or a prescribed motion.
#[derive(Clone, Debug, PartialEq)]
pub struct Channel {
    /// Name, such as `pad_to_body`.
    pub name: Cow<'static, str>,
    /// Numerator.
    pub numerator: Signal,
    /// Denominator.
    pub denominator: Signal,
}

/// A force element.
#[derive(Clone, Debug, PartialEq)]
pub struct Link {
    /// Name.
    pub name: Cow<'static, str>,
    /// Axis.
    pub axis: Cow<'static, str>,
    /// The coordinates between which it acts, in the order of its stretch.
    pub ends: Cow<'static, [Cow<'static, str>]>,
    /// The parameters of its law, by position, in that order.
    pub parameters: Cow<'static, [u16]>,
}

/// An inertia: a mass that moves along an axis, or a moment of inertia that turns.
#[derive(Clone, Debug, PartialEq)]
pub struct Mass {
    /// The moving part.
    pub location: Cow<'static, str>,
    /// Axis: `z`, `x`.
    pub axis: Cow<'static, str>,
    /// True for a rotation.
    pub angle: bool,
    /// The parameters that determine it, by position, in that order.
    pub parameters: Cow<'static, [u16]>,
}

/// The tyre link that can roll over a profile: its stretch connects a mass to a road.
#[derive(Clone, Debug, PartialEq)]
pub struct ContactAbout {
    /// Its position in [`About::links`].
    pub link: u16,
    /// The mass that it carries: positions of its displacement and velocity in `x`, along the direction of the link and
    /// along a second direction if the mass moves in one.
    pub axes: Cow<'static, [ContactAxis]>,
}

/// A direction in which the wheel of a rolling tyre moves.
#[derive(Clone, Debug, PartialEq)]
pub struct ContactAxis {
    /// Axis: `z`, `x`.
    pub axis: Cow<'static, str>,
    /// Position of the wheel's displacement in `x`.
    pub position: u16,
    /// Position of its velocity.
    pub velocity: u16,
}

/// A nonzero entry of A, B, C or D.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Entry {
    /// The matrix.
    pub matrix: Matrix,
    /// Row.
    pub row: u16,
    /// Column.
    pub column: u16,
}

impl ResponseLayout {
    /// Number of rows of its parameter Jacobian, if it is wanted.
    pub fn slopes(&self, wanted: bool) -> usize {
        if wanted { self.jacobian.len() } else { 0 }
    }

    /// Number of all rows; real and imaginary parts are separate.
    pub fn rows(&self, with_jacobian: bool) -> usize {
        2 * (self.outputs.len() + self.slopes(with_jacobian))
    }
}

impl Entry {
    /// An entry of a matrix.
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

/// Rows of the response to one excitation. Outputs that are not listed are zero at every frequency.
#[derive(Clone, Debug, PartialEq)]
pub struct ResponseLayout {
    /// Responding outputs, by position in `y`.
    pub outputs: Cow<'static, [u16]>,
    /// Nonzeros of the parameter Jacobian: position in `outputs` of this layout, parameter.
    pub jacobian: Cow<'static, [(u16, u16)]>,
}
