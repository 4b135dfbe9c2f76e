//! The parameters of both sides, and their differences.

use serde::Serialize;

use super::sides::Side;

/// A parameter of either model; what only one of them has is `None` of the other.
#[derive(Serialize)]
pub(super) struct Parameter {
    pub name: String,
    pub unit: String,
    doc: String,
    pub a: Option<f64>,
    pub b: Option<f64>,
    /// B less A, in the unit.
    pub difference: Option<f64>,
    /// Over A.
    pub relative: Option<f64>,
    pub stderr_a: Option<f64>,
    pub stderr_b: Option<f64>,
    /// The difference over the root of the sum of both squared standard errors, where both are known.
    pub standard_errors: Option<f64>,
    /// Both have it, each with a value of its own.
    pub moved: bool,
    /// The parameter that it takes its value from on both sides.
    pub tied_to: Option<String>,
}

/// Relative differences below this are the rounding of a file.
const SAME: f64 = 1e-9;

/// All parameters of both models, in the order of A and then of B.
pub(super) fn parameters([a, b]: &[Side; 2]) -> Vec<Parameter> {
    let of = |side: &Side| side.model.about().parameters.to_vec();
    let (first, second) = (of(a), of(b));
    let added = second
        .iter()
        .filter(|own| first.iter().all(|other| other.name != own.name));
    let all = first.iter().chain(added);
    all.map(|own| parameter(&own.name, &own.unit, &own.doc, a, b)).collect()
}

fn parameter(name: &str, unit: &str, doc: &str, a: &Side, b: &Side) -> Parameter {
    let (first, second) = (value(a, name), value(b, name));
    let both = first.zip(second);
    let [leader_a, leader_b] = [a, b].map(|side| leader(side, name));
    let tied_to = leader_a.filter(|leader| Some(leader) == leader_b.as_ref() && *leader != name);
    let difference = both.map(|(a, b)| b - a);
    let [stderr_a, stderr_b] = [a, b].map(|side| side.errors.get(name).copied());
    let combined = stderr_a
        .zip(stderr_b)
        .map(|(a, b)| a.hypot(b))
        .filter(|error| *error > 0.0);
    Parameter {
        name: name.into(),
        unit: unit.into(),
        doc: doc.into(),
        a: first,
        b: second,
        difference,
        relative: both.map(|(a, b)| (b - a) / a).filter(|share| share.is_finite()),
        stderr_a,
        stderr_b,
        standard_errors: difference.zip(combined).map(|(difference, error)| difference / error),
        moved: tied_to.is_none() && both.is_some_and(|(a, b)| (b - a).abs() > SAME * a.abs().max(b.abs())),
        tied_to,
    }
}

fn place(of: &Side, name: &str) -> Option<usize> {
    let mut parameters = of.model.about().parameters.iter();
    parameters.position(|parameter| parameter.name == *name)
}

fn value(of: &Side, name: &str) -> Option<f64> {
    Some(of.values.as_slice()[place(of, name)?])
}

/// The parameter whose value this one has; itself, unless it is tied.
fn leader(of: &Side, name: &str) -> Option<String> {
    let leader = of.values.leader(place(of, name)?);
    Some(of.model.about().parameters[leader].name.to_string())
}

impl Parameter {
    /// Moved, or of one side alone.
    pub(super) fn differs(&self) -> bool {
        self.moved || self.a.is_none() || self.b.is_none()
    }
}
