//! The places of a model that an effect's pattern fits.

use super::base::{Base, coordinates, links};
use crate::syntax::{Coordinate, CoordinateKind, Direction, LawStatement, Link, Pattern, PlaceKind};

/// A place of a model where an effect may apply.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Place {
    /// What the catalogue calls it: the name, or `x.body` where the name is of another direction first.
    pub label: String,
    /// The direction.
    pub direction: String,
    /// The name of the link, mass or location in that direction.
    pub name: String,
}

/// Every place that a pattern fits, in the order of the text.
pub fn fitting(base: &Base, pattern: &Pattern) -> Vec<Place> {
    let mut places: Vec<Place> = Vec::new();
    for direction in base.directions() {
        let along = &direction.name.text;
        if pattern.direction.as_ref().is_some_and(|only| only.text != *along) {
            continue;
        }
        for name in candidates(direction, pattern) {
            let Some(called) = called(pattern, &name) else { continue };
            let known = places.iter().any(|place| place.label == called);
            let label = if known { format!("{along}.{called}") } else { called };
            let direction = along.clone();
            places.push(Place { label, direction, name });
        }
    }
    places.retain(|place| pattern.given.iter().all(|given| has(base, place, &given.text)));
    places
}

fn candidates(direction: &Direction, pattern: &Pattern) -> Vec<String> {
    match pattern.kind {
        PlaceKind::Link => links(direction)
            .filter(|link| has_terms(link, pattern))
            .map(|link| link.name.text.clone())
            .collect(),
        PlaceKind::Mass => named(direction, |kind| {
            matches!(kind, CoordinateKind::Mass(_) | CoordinateKind::Inertia(_))
        }),
        PlaceKind::Sensor => named(direction, |kind| !matches!(kind, CoordinateKind::Node)),
    }
}

fn named(direction: &Direction, fits: fn(&CoordinateKind) -> bool) -> Vec<String> {
    let fitting = coordinates(direction).filter(|Coordinate { kind, .. }| fits(kind));
    fitting.map(|coordinate| coordinate.name.text.clone()).collect()
}

fn has_terms(link: &Link, pattern: &Pattern) -> bool {
    pattern
        .terms
        .iter()
        .all(|term| link.body.iter().any(|statement| is_term(statement, &term.text)))
}

/// Whether a statement of a law is a linear term of a kind.
pub fn is_term(statement: &LawStatement, kind: &str) -> bool {
    match statement {
        LawStatement::Spring(_) => kind == "spring",
        LawStatement::Damper(_) => kind == "damper",
        LawStatement::Inerter(_) => kind == "inerter",
        _ => false,
    }
}

/// What the catalogue calls a place of this name, if it may be one.
fn called(pattern: &Pattern, name: &str) -> Option<String> {
    if pattern.names.is_empty() {
        return Some(name.to_string());
    }
    let (_, called) = pattern.names.iter().find(|(own, _)| own.text == name)?;
    Some(called.as_ref().map_or(name, |called| called.text.as_str()).to_string())
}

fn has(base: &Base, place: &Place, name: &str) -> bool {
    base.global(name).is_some() || base.declares(&place.direction, name)
}
