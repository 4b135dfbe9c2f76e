//! The parameters of both sides, and their differences.

use serde::Serialize;

use super::sides::Side;

/// A parameter of either model; `None` for the side without it.
#[derive(Serialize)]
pub(super) struct Parameter {
    pub name: String,
    pub unit: String,
    doc: String,
    pub a: Option<f64>,
    pub b: Option<f64>,
    /// Difference B - A, in the unit.
    pub difference: Option<f64>,
    /// Difference relative to A.
    pub relative: Option<f64>,
    pub stderr_a: Option<f64>,
    pub stderr_b: Option<f64>,
    /// Difference over the root of the sum of both squared standard errors; `None` if an error is unknown.
    pub standard_errors: Option<f64>,
    /// True if both sides have a value that is not tied.
    pub moved: bool,
    /// The parameter that it is tied to on both sides.
    pub tied_to: Option<String>,
}

/// Relative differences below this come from rounding in files.
const SAME: f64 = 1e-9;

/// All parameters of both models: those of A, then those of B alone.
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

/// The parameter that determines the value of this one; itself if it is not tied.
fn leader(of: &Side, name: &str) -> Option<String> {
    let leader = of.values.leader(place(of, name)?);
    Some(of.model.about().parameters[leader].name.to_string())
}

impl Parameter {
    /// True if it differs or belongs to one side alone.
    pub(super) fn differs(&self) -> bool {
        self.moved || self.a.is_none() || self.b.is_none()
    }
}
