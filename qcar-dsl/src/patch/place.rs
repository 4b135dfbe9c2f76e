//! The places of a model that an effect's pattern fits.

use super::model_tree::{ModelTree, coordinates, links};
use super::roles::Roles;
use super::stretch::upper;
use super::terms::has_terms;
use crate::diagnostic::one_of;
use crate::front::syntax::{Coordinate, CoordinateKind, Direction, Name, Pattern, PlaceKind, Statement};

/// A place of a model where an effect may apply.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Place {
    /// Its label: the name, or `x.body` if an earlier direction has the same name.
    pub label: String,
    /// The direction.
    pub direction: String,
    /// The name of the link, mass or location in that direction.
    pub name: String,
}

impl Place {
    /// Its direction and its name there.
    pub fn key(&self) -> (&str, &str) {
        (&self.direction, &self.name)
    }
}

/// Every place that a pattern fits, in the order of the text.
pub fn fitting(base: &ModelTree, roles: &Roles, pattern: &Pattern) -> Vec<Place> {
    let mut places: Vec<Place> = Vec::new();
    for direction in base.directions() {
        let along = &direction.name.text;
        if pattern.direction.as_ref().is_some_and(|only| only.text != *along) {
            continue;
        }
        for name in candidates(direction, pattern) {
            let Some(called) = called(roles, along, pattern, &name) else {
                continue;
            };
            if !is_on(base, roles, along, pattern, &name) {
                continue;
            }
            let known = places.iter().any(|place| place.label == called);
            let label = if known { format!("{along}.{called}") } else { called };
            let direction = along.clone();
            places.push(Place { label, direction, name });
        }
    }
    places.retain(|place| {
        let mut given = pattern.given.iter();
        given.all(|given| has(base, roles, (pattern.kind, place), &given.text))
    });
    places
}

/// What a part of the model lacks for a pattern that does not fit it; `None` if the model has no such part.
pub fn lacks(base: &ModelTree, roles: &Roles, pattern: &Pattern, label: &str) -> Option<String> {
    let (home, name) = label
        .split_once('.')
        .map_or((None, label), |(home, name)| (Some(home), name));
    let is_home = |direction: &&Direction| home.is_none_or(|home| direction.name.text == home);
    let own_kind = |direction: &Direction| match pattern.kind {
        PlaceKind::Link => base.link(&direction.name.text, name).is_some(),
        PlaceKind::Mass | PlaceKind::Sensor => base.coordinate(&direction.name.text, name).is_some(),
        PlaceKind::Force => acting(direction).any(|force| force.text == name),
    };
    let direction = base
        .directions()
        .filter(is_home)
        .find(|direction| own_kind(direction))?;
    let along = &direction.name.text;
    let listed = |all: &[(Name, Option<Name>)]| {
        let words: Vec<&str> = all.iter().map(|(word, _)| word.text.as_str()).collect();
        one_of(&words)
    };
    let term = base.link(along, name).and_then(|link| {
        let mut terms = pattern.terms.iter();
        terms.find(|term| !has_terms(&link.body, std::slice::from_ref(term)))
    });
    let has_role = |role: &str| has_role(roles, pattern.kind, along, name, role);
    Some(match term {
        Some(term) => format!("it has no {}", term.text),
        None if matching(&pattern.roles, has_role).is_none() => {
            format!("it does not have the role {}", listed(&pattern.roles))
        }
        None if matching(&pattern.names, |own| own == name).is_none() => {
            format!("the effect is only for {}", listed(&pattern.names))
        }
        None => "it lacks what the head of the effect requires with `in`, `on` or `given`".into(),
    })
}

fn candidates(direction: &Direction, pattern: &Pattern) -> Vec<String> {
    match pattern.kind {
        PlaceKind::Link => links(direction)
            .filter(|link| has_terms(&link.body, &pattern.terms))
            .map(|link| link.name.text.clone())
            .collect(),
        PlaceKind::Mass => named(direction, |kind| {
            matches!(kind, CoordinateKind::Mass(_) | CoordinateKind::Inertia(_))
        }),
        PlaceKind::Sensor => named(direction, |kind| !matches!(kind, CoordinateKind::Node)),
        PlaceKind::Force => acting(direction).map(|name| name.text.clone()).collect(),
    }
}

/// The force inputs that act on something, other than through laws alone.
fn acting(direction: &Direction) -> impl Iterator<Item = &Name> {
    direction.body.iter().filter_map(|statement| match statement {
        Statement::Force(name, Some(_)) => Some(name),
        _ => None,
    })
}

fn named(direction: &Direction, fits: fn(&CoordinateKind) -> bool) -> Vec<String> {
    let fitting = coordinates(direction).filter(|Coordinate { kind, .. }| fits(kind));
    fitting.map(|coordinate| coordinate.name.text.clone()).collect()
}

/// The label of a place of this name; `None` if the pattern does not fit.
fn called(roles: &Roles, along: &str, pattern: &Pattern, name: &str) -> Option<String> {
    let by_name = matching(&pattern.names, |own| own == name)?;
    let by_role = matching(&pattern.roles, |role| has_role(roles, pattern.kind, along, name, role))?;
    Some(by_name.or(by_role).unwrap_or(name).to_string())
}

/// True if a place of this kind and name has a role.
pub fn has_role(roles: &Roles, kind: PlaceKind, along: &str, name: &str, role: &str) -> bool {
    match kind {
        PlaceKind::Link => roles.is_link(along, name, role),
        PlaceKind::Mass | PlaceKind::Sensor => roles.is_mass(along, name, role),
        PlaceKind::Force => false,
    }
}

/// The label that the first fitting alternative gives a place; `None` if none fits.
fn matching(all: &[(Name, Option<Name>)], fits: impl Fn(&str) -> bool) -> Option<Option<&str>> {
    if all.is_empty() {
        return Some(None);
    }
    let (_, called) = all.iter().find(|(own, _)| fits(&own.text))?;
    Some(called.as_ref().map(|called| called.text.as_str()))
}

/// True if the upper end of a link is at the point that the pattern requires.
fn is_on(base: &ModelTree, roles: &Roles, along: &str, pattern: &Pattern, name: &str) -> bool {
    let Some(wanted) = &pattern.on else { return true };
    let end = base.link(along, name).and_then(|link| upper(base, along, link));
    let meant = roles.meant(base, (along, name), along, &wanted.text);
    let wanted = meant.unwrap_or(wanted.text.clone());
    end.is_some_and(|end| base.pointed_at(along, &end) == base.pointed_at(along, &wanted))
}

/// True if the model has what this name means. A pivot that a mass is to have must be a point on that mass.
fn has(base: &ModelTree, roles: &Roles, (kind, place): (PlaceKind, &Place), name: &str) -> bool {
    let along = &place.direction;
    match roles.meant(base, place.key(), along, name) {
        Some(point) if name == "pivot" && kind == PlaceKind::Mass => base.pointed_at(along, &point) == place.name,
        Some(_) => true,
        None => base.global(name).is_some() || base.declares(along, name),
    }
}
