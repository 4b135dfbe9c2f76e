//! The roles of the parts of a model, which follow from its structure and not from names.
//!
//! The tyre joins a mass to a road; that direction is the axle's own. Each tyre of that direction has its corner: a wheel
//! and the body that rests on it. In a model without a road, every direction is the axle's own, and there is no wheel.
//! Masses are compared at the known values of the parameters.

use std::collections::{BTreeMap, BTreeSet};

use super::graph::{Graph, Joint};
use super::model_tree::{ModelTree, coordinates};
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
    /// The direction of the tyres.
    along: Option<String>,
    /// One for each wheel, in the order of the text.
    corners: Vec<Corner>,
    /// The heaviest mass of each direction except the wheels; in the direction of the tyres, the body of the first
    /// corner. Other directions take the mass of the same name, if there is one.
    body: BTreeMap<String, String>,
    /// Each link of the axle's own directions with its role.
    links: BTreeMap<(String, String), &'static str>,
    /// The corner of each link that belongs to one.
    corner_of: BTreeMap<(String, String), usize>,
    /// Parts that are connected to the rest by one mount only.
    hanging: BTreeSet<String>,
}

/// A tyre, and what is above it.
#[derive(Clone, Debug)]
struct Corner {
    /// The mass on the tyre. If that is a belt, connected only to one heavier mass, the wheel is the heavier mass.
    wheel: String,
    /// The heaviest mass that rests on the wheel: the part of a body above another axle is not.
    body: Option<String>,
    /// The mass, other than the body, about which levers of the suspension turn.
    pivot: Option<String>,
    /// The named point on a mass about which they turn.
    pivot_point: Option<String>,
}

impl Corner {
    /// The points that are connected to the wheel without the body.
    fn reached<'g>(&'g self, graph: &'g Graph) -> BTreeSet<&'g str> {
        let is_below = |other: &Joint| self.body.as_ref().is_none_or(|body| !other.ends.contains(body));
        graph.reached(&self.wheel, is_below)
    }
}

impl Roles {
    /// Determines the roles.
    pub fn of(base: &ModelTree, values: Values) -> Roles {
        let mut roles = Roles::default();
        let graphs: Vec<Graph> = base.directions().map(|direction| Graph::of(base, direction)).collect();
        let masses = Masses::of(base, values);
        if let Some(graph) = graphs
            .iter()
            .find(|graph| graph.joints.iter().any(|joint| joint.is_tyre))
        {
            roles.along = Some(graph.along().to_string());
            roles.corners = corners(base, graph, &masses);
        }
        let wheels: Vec<&str> = roles.corners.iter().map(|corner| corner.wheel.as_str()).collect();
        let own = roles.corners.first().and_then(|corner| corner.body.clone());
        let bodies = graphs.iter().filter_map(|graph| {
            let name = graph.along();
            let same = own.clone().filter(|own| base.coordinate(name, own).is_some());
            let body = same.or_else(|| masses.heaviest(name, &wheels, &|_| true));
            Some((name.to_string(), body?))
        });
        roles.body = bodies.collect();
        for graph in &graphs {
            roles.sort_links(base, graph);
        }
        roles
    }

    /// The name of the part with a role along a direction, as an effect means it at a place: a link or mass of a
    /// direction. At a part that belongs to no corner, it is that of the first.
    pub fn meant(&self, base: &ModelTree, place: (&str, &str), direction: &str, word: &str) -> Option<String> {
        let corner = self.corner(place);
        let wheel = corner.map(|corner| corner.wheel.clone());
        let own_body = corner.filter(|_| self.along.as_deref() == Some(direction));
        match word {
            "body" => own_body
                .and_then(|corner| corner.body.clone())
                .or_else(|| self.body.get(direction).cloned()),
            "wheel" => wheel.filter(|name| base.coordinate(direction, name).is_some()),
            "pivot" => corner?.pivot_point.clone().filter(|_| self.is_own(direction)),
            "hanger" => {
                let graph = Graph::of(base, base.direction(direction)?);
                let hangs = |ends: &BTreeSet<String>| ends.len() == 2 && !ends.is_disjoint(&self.hanging);
                let own = graph.joints.iter().find(|joint| hangs(&joint.ends))?;
                Some(own.link.name.text.clone())
            }
            "wheel_bushing" => {
                let graph = Graph::of(base, base.direction(direction)?);
                let is_here = |joint: &&Joint| {
                    let is_own = wheel.as_ref().is_none_or(|wheel| joint.ends.contains(wheel));
                    is_own && self.is_link(direction, &joint.link.name.text, word)
                };
                let own = graph.joints.iter().find(is_here)?;
                Some(own.link.name.text.clone())
            }
            _ => None,
        }
    }

    /// The names of wheel, body and pivot in the corner to which a place belongs; empty for one that it lacks.
    pub fn of_corner(&self, place: (&str, &str)) -> [&str; 4] {
        let corner = self.corner(place);
        let name = |part: fn(&Corner) -> Option<&String>| corner.and_then(part).map_or("", String::as_str);
        [
            name(|corner| Some(&corner.wheel)),
            name(|corner| corner.body.as_ref()),
            name(|corner| corner.pivot.as_ref()),
            name(|corner| corner.pivot_point.as_ref()),
        ]
    }

    /// True if a link has a role.
    pub fn is_link(&self, direction: &str, link: &str, role: &str) -> bool {
        let own = self.links.get(&(direction.to_string(), link.to_string()));
        // A hanger and the mount of a pivot are also mounts. Without a wheel, nothing shows whether a link is a
        // suspension or a mount.
        let is_either = |own: &str| match role {
            "mount" => ["hanger", "pivot_mount"].contains(&own) || self.corners.is_empty(),
            "hanger" => self.corners.is_empty(),
            // Of a machine.
            "part" => self.corners.is_empty(),
            _ => false,
        };
        own.is_some_and(|own| *own == role || is_either(own))
    }

    /// True if a mass has a role in the axle's own direction.
    pub fn is_mass(&self, direction: &str, mass: &str, role: &str) -> bool {
        let is = |own: Option<&String>| own.is_some_and(|own| own == mass);
        let in_a_corner = |part: fn(&Corner) -> Option<&String>| self.corners.iter().any(|corner| is(part(corner)));
        let is_body = || is(self.body.get(direction)) || in_a_corner(|corner| corner.body.as_ref());
        self.is_own(direction)
            && match role {
                "body" => is_body(),
                // As with links: without a wheel, any other mass may have its part.
                "wheel" => in_a_corner(|corner| Some(&corner.wheel)) || self.corners.is_empty() && !is_body(),
                // A car is weighed, but what hangs on a part of a machine may be missing from its stated mass.
                "part" => self.corners.is_empty(),
                _ => in_a_corner(|corner| corner.pivot.as_ref()),
            }
    }

    fn is_own(&self, direction: &str) -> bool {
        self.along.as_ref().is_none_or(|along| along == direction)
    }

    /// The corner to which a place belongs, otherwise the first.
    fn corner(&self, (direction, name): (&str, &str)) -> Option<&Corner> {
        let link = self.corner_of.get(&(direction.to_string(), name.to_string()));
        let is_part = |corner: &&Corner| {
            corner.wheel == name
                || [&corner.pivot, &corner.body]
                    .into_iter()
                    .flatten()
                    .any(|part| part == name)
        };
        let own = link.and_then(|&at| self.corners.get(at));
        own.or_else(|| self.corners.iter().find(is_part))
            .or_else(|| self.corners.first())
    }

    fn sort_links(&mut self, base: &ModelTree, graph: &Graph) {
        let corners = self.corners.clone();
        let above: Vec<_> = corners.iter().map(|corner| corner.reached(graph)).collect();
        for joint in &graph.joints {
            let name = (graph.along().to_string(), joint.link.name.text.clone());
            // A link at a wheel, or a mount above a strut.
            let at_wheel = self
                .corners
                .iter()
                .position(|corner| joint.ends.contains(&corner.wheel));
            let is_reached = |above: &BTreeSet<&str>| joint.ends.iter().any(|end| above.contains(end.as_str()));
            let corner = at_wheel.or_else(|| above.iter().position(is_reached));
            let role = match (self.is_own(graph.along()), at_wheel) {
                (true, _) => self.role_along(base, graph, joint, corner),
                (false, at_wheel) => at_wheel.map(|_| "wheel_bushing"),
            };
            self.corner_of.extend(corner.map(|at| (name.clone(), at)));
            self.links.extend(role.map(|role| (name, role)));
        }
    }

    fn role_along(
        &mut self,
        base: &ModelTree,
        graph: &Graph,
        joint: &Joint,
        corner: Option<usize>,
    ) -> Option<&'static str> {
        let along = graph.along();
        let Some(Corner { wheel, body, pivot, .. }) = self.corners.get(corner.unwrap_or(0)) else {
            return Some("suspension");
        };
        let (body, ends) = (body.as_ref()?, &joint.ends);
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
        let carries = lower(base, along, joint.link).map(|name| base.pointed_at(along, &name)) == *pivot;
        Some(if carries && pivot.is_some() {
            "pivot_mount"
        } else {
            "mount"
        })
    }
}

/// The corners of a direction, one for each wheel.
fn corners(base: &ModelTree, graph: &Graph, masses: &Masses) -> Vec<Corner> {
    let along = graph.along();
    let tyres = graph.joints.iter().filter(|joint| joint.is_tyre);
    let upper = tyres.filter_map(|tyre| Some(base.pointed_at(along, &upper(base, along, tyre.link)?)));
    let mut on_tyres: Vec<String> = Vec::new();
    for mass in upper {
        if !on_tyres.contains(&mass) {
            on_tyres.push(mass);
        }
    }
    let but: Vec<&str> = on_tyres.iter().map(String::as_str).collect();
    let corner = |on_tyre: &String| {
        let resting = graph.reached(on_tyre, |joint| carries(joint.link));
        let heaviest = masses.heaviest(along, &but, &|mass| resting.contains(mass));
        let body = heaviest.or_else(|| masses.heaviest(along, &but, &|_| true));
        let wheel = carried(graph, on_tyre.clone(), masses, body.as_ref());
        let (pivot, pivot_point) = pivot(base, graph, &wheel, body.as_ref());
        Corner {
            wheel,
            body,
            pivot,
            pivot_point,
        }
    };
    on_tyres.iter().map(corner).collect()
}

/// The mass about which levers of the suspension of a wheel turn, if it is a separate mass, and the named point on that
/// mass or on the body about which they turn.
fn pivot(base: &ModelTree, graph: &Graph, wheel: &str, body: Option<&String>) -> (Option<String>, Option<String>) {
    let along = graph.along();
    let suspending = graph.joints.iter().filter(|joint| joint.ends.contains(wheel));
    let points: Vec<(String, String)> = suspending
        .flat_map(|joint| levered(base, along, joint.link))
        .map(|point| (base.pointed_at(along, &point), point))
        .filter(|(mass, _)| mass != wheel && is_mass(base, along, mass))
        .collect();
    let mass = points.iter().find(|(mass, _)| Some(mass) != body);
    let point = points.iter().find(|(mass, point)| mass != point);
    (
        mass.map(|(mass, _)| mass.clone()),
        point.map(|(_, point)| point.clone()),
    )
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

    /// The heaviest mass of a direction that `counts`, except those of `but`; of equal or unknown masses, the first.
    fn heaviest(&self, direction: &str, but: &[&str], counts: &dyn Fn(&str) -> bool) -> Option<String> {
        let others = self
            .0
            .iter()
            .filter(|(along, name, _)| along == direction && !but.contains(&name.as_str()) && counts(name));
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
