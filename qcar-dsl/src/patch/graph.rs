//! The links of a direction as a graph of the points that they connect.

use std::collections::{BTreeMap, BTreeSet};

use super::model_tree::{ModelTree, coordinates, links};
use super::rewrite::names_in;
use crate::front::syntax::{CoordinateKind, Direction, Dotted, Expression, Link};

/// A link with the points of its own direction that it connects.
pub struct Joint<'a> {
    pub link: &'a Link,
    pub ends: BTreeSet<String>,
    /// True if it connects to a road.
    pub is_tyre: bool,
}

/// The links of a direction.
pub struct Graph<'a> {
    direction: &'a Direction,
    /// In the order of the text.
    pub joints: Vec<Joint<'a>>,
    /// The positions of the joints at each point.
    at: BTreeMap<String, Vec<usize>>,
}

impl<'a> Graph<'a> {
    pub fn of(base: &ModelTree, direction: &'a Direction) -> Graph<'a> {
        let joint = |link| Joint {
            link,
            ends: ends(base, &direction.name.text, link),
            is_tyre: is_tyre(direction, link),
        };
        let joints: Vec<Joint> = links(direction).map(joint).collect();
        let mut at = BTreeMap::<String, Vec<usize>>::new();
        for (place, joint) in joints.iter().enumerate() {
            for end in &joint.ends {
                at.entry(end.clone()).or_default().push(place);
            }
        }
        Graph { direction, joints, at }
    }

    /// The name of the direction.
    pub fn along(&self) -> &'a str {
        &self.direction.name.text
    }

    /// The points that are connected to a point by links that are no tyres and that `count`.
    pub fn reached<'g>(&'g self, from: &'g str, counts: impl Fn(&Joint) -> bool) -> BTreeSet<&'g str> {
        let mut found = BTreeSet::from([from]);
        let mut open = vec![from];
        while let Some(point) = open.pop() {
            let joints = self
                .at
                .get(point)
                .into_iter()
                .flatten()
                .map(|&place| &self.joints[place]);
            for joint in joints.filter(|joint| !joint.is_tyre && counts(joint)) {
                let ends = joint.ends.iter().map(String::as_str);
                open.extend(ends.filter(|end| found.insert(end)));
            }
        }
        found
    }
}

/// The coordinates of the link's own direction in its stretch. A point stands for the coordinates that it is made of.
fn ends(base: &ModelTree, direction: &str, link: &Link) -> BTreeSet<String> {
    let mut found = BTreeSet::new();
    add_coordinates(base, direction, &link.stretch, &mut found);
    found
}

fn add_coordinates(base: &ModelTree, direction: &str, of: &Expression, found: &mut BTreeSet<String>) {
    names_in(of, &mut |name| {
        let Some(point) = own_point(direction, name) else {
            return;
        };
        match (base.coordinate(direction, point), base.point(direction, point)) {
            (Some(coordinate), _) => drop(found.insert(coordinate.name.text.clone())),
            (None, Some(target)) => add_coordinates(base, direction, target, found),
            (None, None) => (),
        }
    });
}

fn own_point<'n>(direction: &str, name: &'n Dotted) -> Option<&'n str> {
    match name.names.as_slice() {
        [point] => Some(&point.text),
        [home, point] if home.text == direction => Some(&point.text),
        _ => None,
    }
}

fn is_tyre(direction: &Direction, link: &Link) -> bool {
    let mut found = false;
    names_in(&link.stretch, &mut |name| {
        let Some(last) = name.names.last() else { return };
        let mut roads = coordinates(direction).filter(|own| matches!(own.kind, CoordinateKind::Road));
        found |= roads.any(|own| own.name.text == last.text);
    });
    found
}
