//! The model graph: an axle with its options chosen, its names resolved and its units checked.
//!
//! It contains the content of the text and nothing derived from it: coordinates, links between them, inputs, outputs.
//! Every expression is in [`Model::graph`]. `parse` and `resolve` build it; all later stages read it.
//!
//! Sign convention: a link's stretch `s` is positive in extension and its law gives the *resisting* force
//! `f(s, v)`, positive in tension (`k s + c v` for a spring and damper). A coordinate `q` of the stretch receives
//! the generalised force `-(∂s/∂q) f` (virtual work).

use std::collections::BTreeSet;

pub use qcar_model::{Default, Quantity};

use crate::expr::{CoordinateId, Expr, Graph, LinkId, Symbol};
use crate::source::Span;
use crate::units::Unit;

/// An axle with its options chosen and its names resolved.
#[derive(Clone, Debug)]
pub struct Model {
    /// The name, a Rust identifier in snake case.
    pub name: String,
    /// The description; may be empty.
    pub doc: String,
    /// The chosen options with their values, in the order of the family.
    pub choices: Vec<(String, String)>,
    /// Graph of all expressions of the model.
    pub graph: Graph,
    /// In the order of the text.
    pub parameters: Vec<Parameter>,
    /// Derived quantities (`let`), in the order of the text.
    pub definitions: Vec<Definition>,
    /// Masses, nodes, roads and motions, in the order of the text.
    pub coordinates: Vec<Coordinate>,
    /// Points that several coordinates move, in the order of the text.
    pub points: Vec<Point>,
    /// Force inputs, in the order of the text.
    pub forces: Vec<ForceInput>,
    /// At most one for a direction.
    pub gravities: Vec<Gravity>,
    /// In the order of the text.
    pub links: Vec<Link>,
    /// Declared outputs, in the order of the text. If a model declares none, they are the accelerations of every mass
    /// and of every point that several coordinates move.
    pub outputs: Vec<Output>,
    /// In the order of the text.
    pub channels: Vec<Channel>,
}

impl Model {
    /// True if a road, a motion or a force moves the model; without any, it can only decay freely.
    pub fn is_excited(&self) -> bool {
        let prescribed = |own: &Coordinate| matches!(own.kind, CoordinateKind::Road | CoordinateKind::Motion);
        !self.forces.is_empty() || self.coordinates.iter().any(prescribed)
    }
}

/// A declaration: its position, and its statement as one canonical line of model text.
///
/// The line is printed from the syntax tree, not copied from the file. Files and inline macros therefore generate the
/// same code.
#[derive(Clone, Debug)]
pub struct Declaration {
    /// The position of the name in its source.
    pub span: Span,
    /// For example `link tire: wheel - pad { spring k_tire; damper c_tire; }`.
    pub line: String,
}

/// A parameter.
#[derive(Clone, Debug)]
pub struct Parameter {
    /// The name, a Rust identifier.
    pub name: String,
    /// A coherent SI unit.
    pub unit: Unit,
    /// Unit as usually written.
    pub unit_name: String,
    /// The description.
    pub doc: String,
    /// The default, in SI.
    pub default: Default,
    /// Bounds in SI, lower below upper.
    pub range: Option<(f64, f64)>,
    /// Declared `known`: never estimated unless a campaign asks for it, so the identifiability rules leave it alone.
    pub known: bool,
    /// Declared `clock`: the time since the start of a run, which varies within it.
    pub clock: bool,
    /// The declaration.
    pub declared: Declaration,
}

/// A derived quantity. Its expression may be shared with other names.
#[derive(Clone, Debug)]
pub struct Definition {
    /// The name.
    pub name: String,
    /// Its unit.
    pub unit: Unit,
    /// An expression in parameters and earlier definitions.
    pub value: Expr,
    /// The declaration.
    pub declared: Declaration,
}

/// A direction of motion. Names of coordinates and links are unique within a direction.
#[derive(Clone, PartialEq, Eq, Hash, PartialOrd, Ord, Debug)]
pub struct Direction(pub String);

/// A point (or angle) that moves.
#[derive(Clone, Debug)]
pub struct Coordinate {
    /// The name, unique in its direction.
    pub name: String,
    /// The names of points that move with it in the same direction.
    pub also: Vec<String>,
    /// For example z or x.
    pub direction: Direction,
    /// What moves it.
    pub kind: CoordinateKind,
    /// True for an angle (rad, inertia in kg m²), false for a position (m, mass in kg).
    pub angle: bool,
    /// The description; may be empty.
    pub doc: String,
    /// The declaration.
    pub declared: Declaration,
}

/// A point that coordinates move together, such as the nose of a body that pitches.
#[derive(Clone, Debug)]
pub struct Point {
    /// The name, unique in its direction.
    pub name: String,
    /// For example z or x.
    pub direction: Direction,
    /// Coordinates with their coefficients (functions of parameters only), each coordinate once.
    pub combination: Vec<(CoordinateId, Expr)>,
    /// True for an angle, false for a position.
    pub angle: bool,
    /// The declaration.
    pub declared: Declaration,
}

/// What moves a coordinate.
#[derive(Clone, Copy, PartialEq, Debug)]
pub enum CoordinateKind {
    /// Newton: an inertia in kg (kg m² for an angle).
    Mass(Expr),
    /// A massless point: its force balance holds at every instant.
    Node,
    /// A road under a tyre: a prescribed motion on which a tyre can also roll.
    Road,
    /// Any other prescribed motion.
    Motion,
}

/// An input that pushes a point, or two points apart.
#[derive(Clone, Debug)]
pub struct ForceInput {
    /// The name, unique in its direction.
    pub name: String,
    /// The direction of its excitation.
    pub direction: Direction,
    /// The point, or difference of points, on which it acts: coordinates with their coefficients (functions of
    /// parameters only), each coordinate once. A coordinate `q` receives `∂on/∂q` times the force (virtual work), so
    /// that the ends of a difference get opposite signs. Empty for an input that acts through laws alone.
    pub on: Vec<(CoordinateId, Expr)>,
    /// N, or N m for a moment.
    pub unit: Unit,
    /// The declaration.
    pub declared: Declaration,
}

/// A uniform acceleration `-g` of every mass of a direction; inertias of angles are not affected.
#[derive(Clone, Debug)]
pub struct Gravity {
    /// The name, for example `g`.
    pub name: String,
    /// The direction along which it acts, towards negative positions.
    pub direction: Direction,
    /// The declaration.
    pub declared: Declaration,
}

/// A massless connection of coordinates.
#[derive(Clone, Debug)]
pub struct Link {
    /// The name, unique in its direction.
    pub name: String,
    /// The direction it was declared in.
    pub direction: Direction,
    /// The stretch: coordinates with their coefficients (functions of parameters only), each coordinate once.
    pub stretch: Vec<(CoordinateId, Expr)>,
    /// Unit of the stretch: m, or 1 (rad).
    pub unit: Unit,
    /// The force.
    pub law: Law,
    /// The terms that replace those of `law` while a tyre rolls over a profile; `None` if the text has no `rolling`
    /// block. The stretch then contains a road. The inner states are the same.
    pub rolling: Option<Vec<Term>>,
    /// The description; may be empty.
    pub doc: String,
    /// The declaration.
    pub declared: Declaration,
}

/// The constitutive law of a link: the sum of its terms.
#[derive(Clone, Debug, Default)]
pub struct Law {
    /// In the order of the text, elements expanded.
    pub terms: Vec<Term>,
    /// Inner states of all terms, in the order of the text.
    pub inner: Vec<Inner>,
    /// True if it may supply energy: the text declares it `active`.
    pub active: bool,
}

impl Law {
    /// The other links in the terms and the rates.
    pub fn other_links(&self, graph: &Graph, own: LinkId) -> BTreeSet<LinkId> {
        let link = |leaf| match leaf {
            Symbol::Stretch(link) | Symbol::Rate(link) => Some(link).filter(|link| *link != own),
            _ => None,
        };
        self.leaves(graph).into_iter().filter_map(link).collect()
    }

    /// The force inputs in the terms and the rates, by their positions in `Model::forces`.
    pub fn force_inputs(&self, graph: &Graph) -> Vec<u16> {
        let input = |leaf| match leaf {
            Symbol::Force(place) => Some(place),
            _ => None,
        };
        self.leaves(graph).into_iter().filter_map(input).collect()
    }

    /// Symbols in the forces and the rates.
    pub fn leaves(&self, graph: &Graph) -> BTreeSet<Symbol> {
        let forces = self.terms.iter().filter_map(|term| match *term {
            Term::Force(force) => Some(force),
            _ => None,
        });
        graph.symbols(forces.chain(self.inner.iter().map(|inner| inner.rate)))
    }
}

/// One summand of a law, a resisting force that is positive in tension.
#[derive(Clone, Copy, PartialEq, Debug)]
pub enum Term {
    /// `k s`
    Spring(Expr),
    /// `c v`
    Damper(Expr),
    /// `b dv/dt`
    Inerter(Expr),
    /// Any expression in `Symbol::Stretch`, `Symbol::Rate`, `Symbol::Inner` of this link, stretches and rates of
    /// others, force inputs and parameters.
    Force(Expr),
}

/// An inner state of a law.
#[derive(Clone, Debug)]
pub struct Inner {
    /// The name, unique in the link (elements prefix theirs with their own name).
    pub name: String,
    /// Its unit.
    pub unit: Unit,
    /// Its time derivative; it may use the arguments of a force.
    pub rate: Expr,
}

/// A measurable quantity.
#[derive(Clone, PartialEq, Debug)]
pub enum Signal {
    /// The position, velocity or acceleration of a coordinate.
    Motion(CoordinateId, Quantity),
    /// The same of a point, by its position in `Model::points`.
    Point(u16, Quantity),
    /// The resisting force of a link, positive in tension.
    LinkForce(LinkId),
    /// The stretch of a link.
    LinkStretch(LinkId),
}

/// An output of the model.
#[derive(Clone, Debug)]
pub struct Output {
    /// `z_body_acceleration`, or the name in the text.
    pub name: String,
    /// The measured quantity.
    pub signal: Signal,
    /// Its unit.
    pub unit: Unit,
    /// The declaration.
    pub declared: Declaration,
}

/// A ratio of a signal to another or to a force input, such as `pad_to_body`.
#[derive(Clone, Debug)]
pub struct Channel {
    /// The name.
    pub name: String,
    /// Numerator.
    pub numerator: Signal,
    /// Denominator.
    pub denominator: Reference,
    /// The declaration.
    pub declared: Declaration,
}

/// Denominator of a channel.
#[derive(Clone, PartialEq, Debug)]
pub enum Reference {
    /// A signal of a coordinate or link.
    Signal(Signal),
    /// A force input, by its place in `Model::forces`.
    Force(u16),
}
