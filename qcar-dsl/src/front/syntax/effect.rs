//! What an effect file says: where the effect may apply, and how it changes a model there.

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
    /// `nuisance;`: every real car has some of it, so that it is no answer to what is missing.
    pub nuisance: bool,
    /// In the order of the text.
    pub body: Vec<Change>,
    /// The ways in which it may act, the usual one first; none where there is only one.
    pub forms: Vec<Form>,
}

impl Effect {
    /// What it changes in its usual form.
    pub fn changes(&self) -> impl Iterator<Item = &Change> {
        self.body
            .iter()
            .chain(self.forms.first().into_iter().flat_map(|form| &form.body))
    }

    /// The parameters that it declares in every form, those of single directions among them.
    pub fn parameters(&self) -> Vec<&EffectParameter> {
        parameters(&self.body)
    }
}

/// `form NAME { "sentence" … }`: a way in which an effect may act, beside what all its forms change.
#[derive(Clone, Debug, PartialEq)]
pub struct Form {
    /// The name.
    pub name: Name,
    /// The sentence.
    pub doc: String,
    /// `with law`: terms that the link must have for this form.
    pub terms: Vec<Name>,
    /// In the order of the text.
    pub body: Vec<Change>,
}

impl Form {
    /// The parameters that it declares beside those of all forms.
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
    /// What a place is.
    pub kind: PlaceKind,
    /// What the effect calls the place.
    pub variable: Name,
    /// `in z`: the only direction that has places.
    pub direction: Option<Name>,
    /// `named damper` or `named sf as subframe`: the names that a place may have, with what the catalogue calls it.
    /// Any name where there is none.
    pub names: Vec<(Name, Option<Name>)>,
    /// `role suspension` or `role body | pivot as subframe`: what the place does, with what the catalogue calls it.
    /// Anything where there is none.
    pub roles: Vec<(Name, Option<Name>)>,
    /// `on body`: the point that is the upper end of the link.
    pub on: Option<Name>,
    /// `with spring, damper`: linear terms that the link must have, `damping` of any law, or a `law` beside linear terms.
    pub terms: Vec<Name>,
    /// `given m_corner, pivot`: what the model must declare.
    pub given: Vec<Name>,
    /// `seen from wheel`: laws and coefficients are per travel of this point, whatever lever is between.
    pub seen_from: Option<Name>,
}

/// What a place is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PlaceKind {
    /// A link.
    Link,
    /// A mass or rotational inertia.
    Mass,
    /// Where something can be measured: anything that moves but a massless node.
    Sensor,
    /// A force input that acts on something.
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
    /// `replace damper of l { … }`: other terms for the linear ones of a kind.
    ReplaceTerm(Name, Name, Vec<LawStatement>),
    /// `replace l.upper of l by tm;`: the first time that the point stands in the link's stretch, or, without `of`,
    /// wherever it stands in the stretches of the direction.
    ReplacePoint {
        /// A name, or an end of a link.
        point: Dotted,
        /// The link.
        of: Option<Name>,
        /// What stands there instead.
        by: Expression,
    },
    /// `replace s of l by 1.2 * s rolling 1.3 * s;`: what the law of a link takes for its stretch.
    ReplaceStretch {
        /// The link.
        of: Name,
        /// What stands for `s`.
        by: Expression,
        /// The same while a tyre rolls; nothing changes there where there is none.
        rolling: Option<Expression>,
    },
    /// `sensor front of l.lower at l.lower + arm * pitch;`: where the sensor at an end of a mass stands, as the point `sf_front`;
    /// without an end, where its other sensors stand, as `sf_sensor`.
    PlaceSensor {
        /// `front` or `rear`.
        end: Option<Name>,
        /// The mass.
        of: Dotted,
        /// What moves the sensor.
        at: Expression,
    },
    /// `remove l;`
    Remove(Name),
    /// `direction x without sf { … }`: changes that are made where the place moves along this direction as well.
    Direction {
        /// The direction.
        name: Name,
        /// Nothing is changed where the direction has one of these.
        without: Vec<Name>,
        /// The changes.
        body: Vec<Change>,
    },
    /// `delay m by delay;`: the signal of a location comes late.
    Delay(Name, Name),
    /// `scale m by gain;`: the signal of a location is too large or too small.
    Scale(Name, Name),
}

/// A parameter of an effect.
#[derive(Clone, Debug, PartialEq)]
pub struct EffectParameter {
    /// `shared param`: the model's own parameter of this name, where it has one.
    pub shared: bool,
    /// `known param`
    pub known: bool,
    /// `strength param`, `shape param` or `clock param`
    pub role: Role,
    /// The name.
    pub name: Name,
    /// The declared unit.
    pub unit: UnitText,
    /// Where a search begins, of the model's parameters and coefficients.
    pub start: Expression,
    /// What is plausible.
    pub range: (Expression, Expression),
    /// The sentence.
    pub doc: String,
}

/// What a parameter is to its effect.
#[derive(Clone, Debug, PartialEq)]
pub enum Role {
    /// `strength param`: as it goes to a value, the model becomes what it was before the patch.
    Strength(VanishesAt),
    /// `shape param`: it says where the effect acts, over travel, speed or frequency.
    Shape,
    /// `clock param`: the time since a run began, in s or, without a unit, in parts of the run.
    Clock,
    /// None of these.
    Other,
}

/// Where a strength leaves nothing of its effect.
#[derive(Clone, Debug, PartialEq)]
pub enum VanishesAt {
    /// At 0, unless something else is said.
    Zero,
    /// `vanishes at infinity`
    Infinity,
    /// `vanishes at 1`: of the model's parameters and coefficients.
    Value(Expression),
}
