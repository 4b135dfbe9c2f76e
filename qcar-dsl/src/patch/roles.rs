//! The roles of the parts of a model, which follow from its structure and not from names.
//!
//! The tyre joins a mass to a road; that direction is the axle's own. In a model without a road, every direction is the
//! axle's own, and there is no wheel. Masses are compared at the known values of the parameters.

use std::collections::{BTreeMap, BTreeSet};

use super::graph::{Graph, Joint};
use super::model_tree::{ModelTree, coordinates, links};
use super::query::{Values, numbers};
use super::stretch::{levered, lower, upper};
use crate::front::syntax::{Coordinate, CoordinateKind, Expression, LawStatement, Link};

/// The words for links, as `role tire` has them.
pub const OF_LINKS: [&str; 7] = [
    "tire",
    "suspension",
    "mount",
    "hanger",
    "pivot_mount",
    "wheel_bushing",
    "part",
];

/// The words for masses.
pub const OF_MASSES: [&str; 4] = ["body", "wheel", "pivot", "part"];

/// The parts of a model by their roles.
#[derive(Clone, Debug, Default)]
pub struct Roles {
    /// The direction of the tyre.
    along: Option<String>,
    /// The mass on the tyre. If that is a belt, connected only to one heavier mass, the wheel is the heavier mass.
    wheel: Option<String>,
    /// The heaviest mass of each direction except the wheel. In the direction of the tyre, it is the heaviest that
    /// rests on the wheel: the part of a body above the other axle is not. Other directions take the mass of the same
    /// name, if there is one.
    body: BTreeMap<String, String>,
    /// The mass, other than the body, about which levers of the suspension turn.
    pivot: Option<String>,
    /// The named point on a mass about which they turn.
    pivot_point: Option<String>,
    /// Each link of the axle's own directions with its role.
    links: BTreeMap<(String, String), &'static str>,
    /// Parts that are connected to the rest by one mount only.
    hanging: BTreeSet<String>,
}

impl Roles {
    /// Determines the roles.
    pub fn of(base: &ModelTree, values: Values) -> Roles {
        let mut roles = Roles::default();
        let graphs: Vec<Graph> = base.directions().map(|direction| Graph::of(base, direction)).collect();
        let tyre = graphs.iter().find_map(|graph| {
            let tyre = graph.joints.iter().find(|joint| joint.is_tyre)?;
            Some((graph, tyre.link))
        });
        let masses = Masses::of(base, values);
        if let Some((graph, tyre)) = tyre {
            let along = graph.along().to_string();
            let on_tyre = upper(base, &along, tyre).map(|name| base.pointed_at(&along, &name));
            roles.along = Some(along.clone());
            let carried_by = |mass| graph.reached(mass, |joint| carries(joint.link));
            let resting = on_tyre.as_deref().map_or_else(BTreeSet::new, carried_by);
            let heaviest = masses.heaviest(&along, on_tyre.as_deref(), &|mass| resting.contains(mass));
            let body = heaviest.or_else(|| masses.heaviest(&along, on_tyre.as_deref(), &|_| true));
            roles.body.extend(body.map(|body| (along.clone(), body)));
            roles.wheel = on_tyre
                .clone()
                .map(|mass| carried(graph, mass, &masses, roles.body.get(&along)));
        }
        for graph in &graphs {
            let name = graph.along();
            let own = roles.along.as_ref().and_then(|along| roles.body.get(along));
            let same = own.filter(|own| base.coordinate(name, own).is_some()).cloned();
            let body = same.or_else(|| masses.heaviest(name, roles.wheel.as_deref(), &|_| true));
            roles.body.extend(body.map(|body| (name.to_string(), body)));
        }
        (roles.pivot, roles.pivot_point) = roles.found_pivot(base, &graphs);
        for graph in &graphs {
            roles.sort_links(base, graph);
        }
        roles
    }

    /// The name of the part with a role along a direction.
    pub fn meant(&self, base: &ModelTree, direction: &str, word: &str) -> Option<String> {
        let moves = |name: &&String| base.coordinate(direction, name).is_some();
        match word {
            "body" => self.body.get(direction).cloned(),
            "wheel" => self.wheel.as_ref().filter(moves).cloned(),
            "pivot" => self.pivot_point.clone().filter(|_| self.is_own(direction)),
            "hanger" => {
                let graph = Graph::of(base, base.direction(direction)?);
                let hangs = |ends: &BTreeSet<String>| ends.len() == 2 && !ends.is_disjoint(&self.hanging);
                let own = graph.joints.iter().find(|joint| hangs(&joint.ends))?;
                Some(own.link.name.text.clone())
            }
            "wheel_bushing" => {
                let mut own = links(base.direction(direction)?).map(|link| &link.name.text);
                own.find(|link| self.is_link(direction, link, word)).cloned()
            }
            _ => None,
        }
    }

    /// True if a link has a role.
    pub fn is_link(&self, direction: &str, link: &str, role: &str) -> bool {
        let own = self.links.get(&(direction.to_string(), link.to_string()));
        // A hanger and the mount of a pivot are also mounts. Without a wheel, nothing shows whether a link is a
        // suspension or a mount.
        let is_either = |own: &str| match role {
            "mount" => ["hanger", "pivot_mount"].contains(&own) || self.wheel.is_none(),
            "hanger" => self.wheel.is_none(),
            // Of a machine.
            "part" => self.wheel.is_none(),
            _ => false,
        };
        own.is_some_and(|own| *own == role || is_either(own))
    }

    /// True if a mass has a role in the axle's own direction.
    pub fn is_mass(&self, direction: &str, mass: &str, role: &str) -> bool {
        let is = |own: Option<&String>| own.is_some_and(|own| own == mass);
        let body = self.body.get(direction);
        self.is_own(direction)
            && match role {
                "body" => is(body),
                // As with links: without a wheel, any other mass may have its part.
                "wheel" => is(self.wheel.as_ref()) || self.wheel.is_none() && !is(body),
                // A car is weighed, but what hangs on a part of a machine may be missing from its stated mass.
                "part" => self.wheel.is_none(),
                _ => is(self.pivot.as_ref()),
            }
    }

    fn is_own(&self, direction: &str) -> bool {
        self.along.as_ref().is_none_or(|along| along == direction)
    }

    /// The mass about which levers of the suspension turn, if it is a separate mass, and the named point on that mass or
    /// on the body about which they turn.
    fn found_pivot(&self, base: &ModelTree, graphs: &[Graph]) -> (Option<String>, Option<String>) {
        let (Some(along), Some(wheel)) = (&self.along, &self.wheel) else {
            return (None, None);
        };
        let suspending = graphs.iter().filter(|graph| graph.along() == along).flat_map(|graph| {
            let joints = graph.joints.iter();
            joints.filter(|joint| joint.ends.contains(wheel))
        });
        let points: Vec<(String, String)> = suspending
            .flat_map(|joint| levered(base, along, joint.link))
            .map(|point| (base.pointed_at(along, &point), point))
            .filter(|(mass, _)| mass != wheel && is_mass(base, along, mass))
            .collect();
        let mass = points.iter().find(|(mass, _)| Some(mass) != self.body.get(along));
        let point = points.iter().find(|(mass, point)| mass != point);
        (
            mass.map(|(mass, _)| mass.clone()),
            point.map(|(_, point)| point.clone()),
        )
    }

    fn sort_links(&mut self, base: &ModelTree, graph: &Graph) {
        for joint in &graph.joints {
            let role = match (self.is_own(graph.along()), &self.wheel) {
                (true, _) => self.role_along(base, graph, joint),
                (false, Some(wheel)) => joint.ends.contains(wheel).then_some("wheel_bushing"),
                (false, None) => None,
            };
            if let Some(role) = role {
                let name = (graph.along().to_string(), joint.link.name.text.clone());
                self.links.insert(name, role);
            }
        }
    }

    fn role_along(&mut self, base: &ModelTree, graph: &Graph, joint: &Joint) -> Option<&'static str> {
        let along = graph.along();
        let Some(wheel) = &self.wheel else {
            return Some("suspension");
        };
        let body = self.body.get(along)?;
        let ends = &joint.ends;
        if joint.is_tyre {
            return Some("tire");
        }
        if ends.contains(wheel) {
            let reached = graph.reached(body, |other| !other.ends.contains(wheel));
            return ends
                .iter()
                .any(|end| end != wheel && reached.contains(end.as_str()))
                .then_some("suspension");
        }
        if ends.len() < 2 {
            return None;
        }
        let without = graph.reached(body, |other| !std::ptr::eq(other, joint));
        if let Some(loose) = ends.iter().find(|end| !without.contains(end.as_str())) {
            self.hanging.insert(loose.clone());
            return Some("hanger");
        }
        let carries = lower(base, along, joint.link).map(|name| base.pointed_at(along, &name)) == self.pivot;
        Some(if carries && self.pivot.is_some() {
            "pivot_mount"
        } else {
            "mount"
        })
    }
}

/// The masses of every direction with their values, kg; in a direction where all parts turn, their inertias, kg m².
struct Masses(Vec<(String, String, f64)>);

impl Masses {
    fn of(base: &ModelTree, values: Values) -> Masses {
        let mut all = Vec::new();
        for direction in base.directions() {
            let is_mass = |own: &&Coordinate| matches!(own.kind, CoordinateKind::Mass(_));
            let has_masses = coordinates(direction).any(|own| is_mass(&own));
            for coordinate in coordinates(direction) {
                if let CoordinateKind::Mass(mass) | CoordinateKind::Inertia(mass) = &coordinate.kind
                    && (is_mass(&coordinate) || !has_masses)
                {
                    all.push((direction.name.text.clone(), coordinate.name.text.clone(), mass.clone()));
                }
            }
        }
        let expressions: Vec<Expression> = all.iter().map(|(.., mass)| mass.clone()).collect();
        let weights = numbers(base, &expressions, values);
        let weighed = all.into_iter().zip(weights);
        Masses(
            weighed
                .map(|((direction, name, _), weight)| (direction, name, weight))
                .collect(),
        )
    }

    fn weight(&self, direction: &str, name: &str) -> Option<f64> {
        let own = self
            .0
            .iter()
            .find(|(along, own, _)| along == direction && own == name)?;
        Some(own.2)
    }

    /// The heaviest mass of a direction that `counts`, except `but`; of equal or unknown masses, the first.
    fn heaviest(&self, direction: &str, but: Option<&str>, counts: &dyn Fn(&str) -> bool) -> Option<String> {
        let others = self
            .0
            .iter()
            .filter(|(along, name, _)| along == direction && Some(name.as_str()) != but && counts(name));
        let heavier = |best: Option<&'_ (String, String, f64)>, own: &(String, String, f64)| {
            best.is_none_or(|best| own.2 > best.2 || best.2.is_nan() && !own.2.is_nan())
        };
        let mut best = None;
        for own in others {
            if heavier(best, own) {
                best = Some(own);
            }
        }
        best.map(|(_, name, _)| name.clone())
    }
}

/// The wheel, given the mass on the tyre: a belt is connected only to one heavier mass, which is then the wheel.
fn carried(graph: &Graph, mass: String, masses: &Masses, body: Option<&String>) -> String {
    let beside = graph
        .joints
        .iter()
        .filter(|joint| !joint.is_tyre && joint.ends.contains(&mass));
    let others: BTreeSet<&String> = beside
        .flat_map(|joint| &joint.ends)
        .filter(|end| **end != mass)
        .collect();
    let [only] = others.iter().copied().collect::<Vec<_>>()[..] else {
        return mass;
    };
    let heavier = masses.weight(graph.along(), only) > masses.weight(graph.along(), &mass);
    if heavier && Some(only) != body {
        only.clone()
    } else {
        mass
    }
}

fn is_mass(base: &ModelTree, direction: &str, point: &str) -> bool {
    let own = base.coordinate(direction, point);
    own.is_some_and(|own| matches!(own.kind, CoordinateKind::Mass(_)))
}

/// True if a link can carry a static load: its law has more than inerters.
fn carries(link: &Link) -> bool {
    link.body
        .iter()
        .any(|statement| !matches!(statement, LawStatement::Inerter(_) | LawStatement::Active))
}
