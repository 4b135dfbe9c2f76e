//! What there is to know of a compiled model without evaluating it: names, places and sparsity.
//!
//! It says which symbol of the equations stands at which place of the vectors `p`, `x`, `u` and `y`, and mirrors
//! what the runtime's seam shows of a model, as plain data.

use crate::expr::{CoordinateId, Symbol};
use crate::model::{Default, Quantity};
use crate::units::Unit;

/// Names, units, sizes and sparsity of a compiled model.
#[derive(Clone, Debug, PartialEq)]
pub struct About {
    /// Snake case.
    pub name: String,
    /// The sentence that describes it.
    pub doc: String,
    /// In the order of `p`; `Symbol::Parameter` counts them.
    pub parameters: Vec<Parameter>,
    /// In the order of `x`: positions of the masses, their velocities, positions of the nodes, inner states.
    pub states: Vec<State>,
    /// In the order of `u`: of each direction its motions, its forces, its gravity.
    pub inputs: Vec<Input>,
    /// In the order of `y`.
    pub outputs: Vec<Output>,
    /// Harmonic excitations: each prescribed motion and each force input, in the order of `u`.
    pub excitations: Vec<Excitation>,
    /// Named ratios of two signals.
    pub channels: Vec<Channel>,
    /// The force elements; `LinkId` counts them.
    pub links: Vec<Link>,
    /// The inertias.
    pub masses: Vec<Mass>,
    /// The tyre link that can roll over a profile.
    pub contact: Option<Contact>,
    /// How many values `prepare` computes.
    pub constants: usize,
    /// True where A, B, C and D depend on the parameters alone.
    pub linear: bool,
    /// The nonzeros of A, B, C and D, matrix after matrix, row after row.
    pub matrices: Vec<Entry>,
    /// The nonzeros of their parameter Jacobians with the parameter, parameter after parameter.
    pub sensitivities: Vec<(Entry, u16)>,
    /// The nonzeros of ∂f/∂p, then of ∂h/∂p: is it an output, row, parameter; row after row.
    pub parameter_jacobian: Vec<(bool, u16, u16)>,
    /// For each excitation; empty for a nonlinear model.
    pub responses: Vec<ResponseLayout>,
}

/// A parameter of the model.
#[derive(Clone, Debug, PartialEq)]
pub struct Parameter {
    /// Name.
    pub name: String,
    /// What people call its unit.
    pub unit: String,
    /// Sentence.
    pub doc: String,
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
    /// In parts of the run, for a clock without a unit.
    PartOfRun,
}

/// A state of the model.
#[derive(Clone, Debug, PartialEq)]
pub struct State {
    /// What it is in the equations: a position, a velocity or an inner state.
    pub symbol: Symbol,
    /// `z_wheel`, `vz_wheel` or, for an inner state, `z_damper_f`.
    pub name: String,
    /// Unit.
    pub unit: Unit,
    /// The mass or node that moves, or the link of an inner state.
    pub location: String,
    /// `z`, `x`.
    pub axis: String,
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
    /// What it is in the equations.
    pub symbol: Symbol,
    /// `z_pad`, `vz_pad`, `az_pad`, `f_wheel_z`, `g`.
    pub name: String,
    /// Unit.
    pub unit: Unit,
    /// `z`, `x`.
    pub axis: String,
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
    pub name: String,
    /// `z`, `x`.
    pub axis: String,
    /// What is excited.
    pub source: Source,
    /// True for a road.
    pub road: bool,
}

/// What excites a model.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Source {
    /// A prescribed motion: the response is per m or rad.
    Motion(CoordinateId),
    /// A force input, by its place in `Model::forces`: the response is per N or N m.
    Force(u16),
}

/// What can be measured: where, along which axis, what.
#[derive(Clone, Debug, PartialEq)]
pub struct Signal {
    /// A mass, node, motion or link.
    pub location: String,
    /// `z`, `x`.
    pub axis: String,
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
    pub name: String,
    /// Unit.
    pub unit: Unit,
    /// What it measures.
    pub signal: Signal,
}

/// A named ratio of two signals, each an output or a prescribed motion.
#[derive(Clone, Debug, PartialEq)]
pub struct Channel {
    /// `pad_to_body`.
    pub name: String,
    /// Above the line.
    pub numerator: Signal,
    /// Below the line.
    pub denominator: Signal,
}

/// A force element.
#[derive(Clone, Debug, PartialEq)]
pub struct Link {
    /// Name.
    pub name: String,
    /// Axis.
    pub axis: String,
    /// The coordinates it acts between, in the order of its stretch.
    pub ends: Vec<String>,
    /// The parameters on which its law depends, by their places, in that order.
    pub parameters: Vec<u16>,
}

/// An inertia: a mass that moves along an axis, or a moment of inertia that turns.
#[derive(Clone, Debug, PartialEq)]
pub struct Mass {
    /// What moves.
    pub location: String,
    /// `z`, `x`.
    pub axis: String,
    /// True for what turns.
    pub angle: bool,
    /// The parameters of which it is made, by their places, in that order.
    pub parameters: Vec<u16>,
}

/// The tyre link that can roll over a profile: the first whose stretch joins a mass to a road.
#[derive(Clone, Debug, PartialEq)]
pub struct Contact {
    /// Its place in [`About::links`].
    pub link: u16,
    /// The mass that it carries, along the direction of the link (`Symbol::ContactForce(0)`) and, where a mass of that
    /// name moves in a second direction too, along that one (`Symbol::ContactForce(1)`).
    pub axes: Vec<ContactAxis>,
}

/// A direction in which the wheel of a rolling tyre moves.
#[derive(Clone, Debug, PartialEq)]
pub struct ContactAxis {
    /// `z`, `x`.
    pub axis: String,
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
    pub outputs: Vec<u16>,
    /// Nonzeros of the parameter Jacobian: place in `outputs` of this layout, parameter; output after output.
    pub jacobian: Vec<(u16, u16)>,
}

impl About {
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
