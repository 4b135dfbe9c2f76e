//! The syntax tree of an effect file: where the effect may apply, and how it changes a model there.

use super::{Dotted, Expression, LawStatement, Name, Statement, UnitText};

/// A patch of a model.
#[derive(Clone, Debug, PartialEq)]
pub struct Effect {
    /// The name.
    pub name: Name,
    /// The places where it may apply.
    pub pattern: Pattern,
    /// The sentence.
    pub doc: String,
    /// Where its law comes from: `source "…";`
    pub source: String,
    /// How it shows in measurements: `shows "…";`
    pub shows: String,
    /// `nuisance;`: every real car has some of it, so a search never names it as a missing effect.
    pub nuisance: bool,
    /// In the order of the text.
    pub body: Vec<Change>,
    /// The ways in which it may act, the usual one first; empty if there is only one.
    pub forms: Vec<Form>,
}

impl Effect {
    /// The changes of its usual form.
    pub fn changes(&self) -> impl Iterator<Item = &Change> {
        self.body
            .iter()
            .chain(self.forms.first().into_iter().flat_map(|form| &form.body))
    }

    /// The parameters of all its forms, including those of single directions.
    pub fn parameters(&self) -> Vec<&EffectParameter> {
        parameters(&self.body)
    }
}

/// `form NAME { "sentence" … }`: a way in which an effect may act. Its changes are made in addition to those of all
/// forms.
#[derive(Clone, Debug, PartialEq)]
pub struct Form {
    /// The name.
    pub name: Name,
    /// The sentence.
    pub doc: String,
    /// `role wheel`: a role that the place must have for this form.
    pub role: Option<Name>,
    /// `with law`: terms that the link must have for this form.
    pub terms: Vec<Name>,
    /// In the order of the text.
    pub body: Vec<Change>,
}

impl Form {
    /// The parameters that it declares in addition to those of all forms.
    pub fn parameters(&self) -> Vec<&EffectParameter> {
        parameters(&self.body)
    }
}

fn parameters(changes: &[Change]) -> Vec<&EffectParameter> {
    let declared = changes.iter().map(|change| match change {
        Change::Parameter(parameter) => vec![parameter],
        Change::Direction { body, .. } => parameters(body),
        _ => vec![],
    });
    declared.flatten().collect()
}

/// `at link l in z named damper with damper given pivot seen from wheel`
#[derive(Clone, Debug, PartialEq)]
pub struct Pattern {
    /// The kind of a place.
    pub kind: PlaceKind,
    /// The name of the place inside the effect.
    pub variable: Name,
    /// `in z`: the only direction in which the effect applies.
    pub direction: Option<Name>,
    /// `named damper` or `named sf as subframe`: the names that a place may have, with their labels. Empty if any name
    /// is allowed.
    pub names: Vec<(Name, Option<Name>)>,
    /// `role suspension` or `role body | pivot as subframe`: the roles that a place may have, with their labels. Empty
    /// if any role is allowed.
    pub roles: Vec<(Name, Option<Name>)>,
    /// `on body`: the point that is the upper end of the link.
    pub on: Option<Name>,
    /// `with spring, damper`: terms that the link must have: linear ones, `damping` of any kind, or a `law` besides
    /// linear terms.
    pub terms: Vec<Name>,
    /// `given m_corner, pivot`: what the model must declare.
    pub given: Vec<Name>,
    /// `seen from wheel`: laws and coefficients are per travel of this point, whatever the motion ratio.
    pub seen_from: Option<Name>,
}

/// The kind of a place.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PlaceKind {
    /// A link.
    Link,
    /// A mass or rotational inertia.
    Mass,
    /// A point that can carry a sensor: any coordinate except a massless node.
    Sensor,
    /// A force input that acts on a point.
    Force,
}

impl PlaceKind {
    /// Every kind.
    pub const ALL: [PlaceKind; 4] = [PlaceKind::Link, PlaceKind::Mass, PlaceKind::Sensor, PlaceKind::Force];

    /// As written.
    pub fn word(self) -> &'static str {
        match self {
            PlaceKind::Link => "link",
            PlaceKind::Mass => "mass",
            PlaceKind::Sensor => "sensor",
            PlaceKind::Force => "force",
        }
    }
}

/// A change of a model.
#[derive(Clone, Debug, PartialEq)]
pub enum Change {
    /// `param NAME: unit = start in low..high "sentence";`
    Parameter(EffectParameter),
    /// A derived quantity, something that moves, a link, a point, an output or a channel.
    Declare(Statement),
    /// `take m_tm from body;`: a part of a mass becomes one of its own.
    Take(Expression, Dotted),
    /// `add to l { … }`
    Add(Name, Vec<LawStatement>),
    /// `replace damper of l { … }`: other terms in place of the linear ones of a kind.
    ReplaceTerm(Name, Name, Vec<LawStatement>),
    /// `replace l.upper of l by tm;`: replaces the first occurrence of the point in the link's stretch. Without `of`,
    /// replaces all occurrences in the stretches of the direction.
    ReplacePoint {
        /// A name, or an end of a link.
        point: Dotted,
        /// The link.
        of: Option<Name>,
        /// Its replacement.
        by: Expression,
    },
    /// `replace s of l by 1.2 * s rolling 1.3 * s;`: replaces the stretch in the law of a link.
    ReplaceStretch {
        /// The link.
        of: Name,
        /// The replacement of `s`.
        by: Expression,
        /// The replacement while a tyre rolls; `None` if the rolling law does not change.
        rolling: Option<Expression>,
    },
    /// `sensor front of l.lower at l.lower + arm * pitch;`: the point at which the sensor at an end of a mass is
    /// mounted, named `sf_front`. Without an end, the point of all its other sensors, named `sf_sensor`.
    PlaceSensor {
        /// `front` or `rear`.
        end: Option<Name>,
        /// The mass.
        of: Dotted,
        /// The motion of the sensor.
        at: Expression,
    },
    /// `remove l;`
    Remove(Name),
    /// `direction x without sf { … }`: changes that are made if the place moves along this direction too.
    Direction {
        /// The direction.
        name: Name,
        /// No change is made if the direction has one of these names.
        without: Vec<Name>,
        /// The changes.
        body: Vec<Change>,
    },
    /// `delay m by delay;`: the signal of a location is delayed.
    Delay(Name, Name),
    /// `scale m by gain;`: the signal of a location has a gain error.
    Scale(Name, Name),
}

/// A parameter of an effect.
#[derive(Clone, Debug, PartialEq)]
pub struct EffectParameter {
    /// `shared param`: uses the model's own parameter of this name, if it has one.
    pub shared: bool,
    /// `known param`
    pub known: bool,
    /// `strength param`, `shape param` or `clock param`
    pub role: Role,
    /// The name.
    pub name: Name,
    /// The declared unit.
    pub unit: UnitText,
    /// Start of a search, an expression in the model's parameters and coefficients.
    pub start: Expression,
    /// Plausible range, lower and upper bound.
    pub range: (Expression, Expression),
    /// The sentence.
    pub doc: String,
}

/// The role of a parameter in its effect.
#[derive(Clone, Debug, PartialEq)]
pub enum Role {
    /// `strength param`: at its vanishing value the effect changes nothing.
    Strength(VanishesAt),
    /// `shape param`: determines at which travel, speed or frequency the effect acts.
    Shape,
    /// `clock param`: the time since the start of a run, in s or, without a unit, as a fraction of the run.
    Clock,
    /// None of these.
    Other,
}

/// The value of a strength at which its effect vanishes.
#[derive(Clone, Debug, PartialEq)]
pub enum VanishesAt {
    /// At 0, the default.
    Zero,
    /// `vanishes at infinity`
    Infinity,
    /// `vanishes at 1`: an expression in the model's parameters and coefficients.
    Value(Expression),
}
