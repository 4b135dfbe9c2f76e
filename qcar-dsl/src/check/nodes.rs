//! Massless nodes: their force balance is solved for their position or velocity, so it must be solvable.

use super::Scratch;
use super::rank::{null_space, support};
use super::sample::{Kind, Point, Values};
use crate::diagnostic::{Diagnostic, structure};
use crate::expr::{CoordinateId, Expr, Symbol};
use crate::model::{CoordinateKind, Link};

/// Unknown of the force balance of a node.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Balance {
    /// Its acceleration: an inerter holds it.
    Acceleration,
    /// Its velocity: a damper holds it.
    Velocity,
    /// Its position: only springs hold it.
    Position,
}

/// Nodes that move together.
type Group = Vec<CoordinateId>;

/// Checks that the balance of every node is solvable.
pub fn nodes_are_solvable(scratch: &Scratch) -> Vec<Diagnostic> {
    let nodes = nodes(scratch);
    let of_one: Vec<Diagnostic> = nodes
        .iter()
        .filter_map(|&(id, balance)| mistake(scratch, id, balance))
        .collect();
    if of_one.is_empty() {
        together(scratch, &nodes)
    } else {
        of_one
    }
}

/// Fault of the balance of one node.
fn mistake(scratch: &Scratch, id: CoordinateId, balance: Option<Balance>) -> Option<Diagnostic> {
    let coordinate = &scratch.model.coordinates[usize::from(id.0)];
    let (span, name) = (coordinate.declared.span, coordinate.name.as_str());
    let Some(balance) = balance else {
        return Some(structure::node_not_attached(span, name));
    };
    let (link, what) = nonlinear(scratch, id, balance)?;
    let place = (link.declared.span, link.name.as_str());
    Some(structure::node_nonlinear(span, name, place, what))
}

/// Faults of the balances of several nodes. Dampers do not resist the common motion of the nodes between them; springs
/// then determine the position of the group, as of single nodes.
fn together(scratch: &Scratch, nodes: &[(CoordinateId, Option<Balance>)]) -> Vec<Diagnostic> {
    let single = |balance: Balance| -> Vec<Group> {
        let own = nodes.iter().filter(|(_, own)| *own == Some(balance));
        own.map(|(id, _)| vec![*id]).collect()
    };
    let mut found = Vec::new();
    let mut placed = single(Balance::Position);
    let damped = single(Balance::Velocity);
    match common_motions(scratch, &damped) {
        Some(groups) => {
            let members = groups.iter().flatten();
            found.extend(members.filter_map(|&id| mistake(scratch, id, Some(Balance::Position))));
            placed.extend(groups);
        }
        None => found.extend(floating(scratch, &damped, Balance::Velocity)),
    }
    if found.is_empty() {
        found.extend(floating(scratch, &placed, Balance::Position));
        found.extend(floating(scratch, &single(Balance::Acceleration), Balance::Acceleration));
    }
    found
}

/// The massless nodes.
pub fn nodes(scratch: &Scratch) -> Vec<(CoordinateId, Option<Balance>)> {
    let ids = (0..scratch.model.coordinates.len() as u16).map(CoordinateId);
    let is_node = |id: &CoordinateId| scratch.model.coordinates[usize::from(id.0)].kind == CoordinateKind::Node;
    ids.filter(is_node).map(|id| (id, balance(scratch, id))).collect()
}

/// Determined by the first of inerter, damper and spring at the node.
fn balance(scratch: &Scratch, id: CoordinateId) -> Option<Balance> {
    let all = [Balance::Acceleration, Balance::Velocity, Balance::Position];
    let held = |balance: &Balance| {
        links_of(scratch, id).any(|(index, _)| scratch.graph.as_constant(slope(scratch, index, *balance)) != Some(0.0))
    };
    all.into_iter().find(held)
}

fn links_of<'a>(scratch: &'a Scratch, id: CoordinateId) -> impl Iterator<Item = (usize, &'a Link)> {
    let links = scratch.model.links.iter().enumerate();
    links.filter(move |(_, link)| link.stretch.iter().any(|(other, _)| *other == id))
}

fn slope(scratch: &Scratch, link: usize, balance: Balance) -> Expr {
    let slopes = &scratch.slopes[link];
    match balance {
        Balance::Acceleration => slopes.inertance,
        Balance::Velocity => slopes.damping,
        Balance::Position => slopes.stiffness,
    }
}

/// A law at a node whose slope depends on the unknown of the balance.
fn nonlinear<'a>(scratch: &'a Scratch, id: CoordinateId, balance: Balance) -> Option<(&'a Link, &'static str)> {
    let depends = |(index, link): (usize, &'a Link)| {
        let symbols = scratch.graph.symbols([slope(scratch, index, balance)]);
        let has = |kind: fn(&Symbol) -> bool| symbols.iter().any(kind);
        match balance {
            Balance::Velocity if has(|s| matches!(s, Symbol::Rate(_))) => Some((link, "rate")),
            Balance::Position if has(|s| matches!(s, Symbol::Stretch(_))) => Some((link, "stretch")),
            _ => None,
        }
    };
    links_of(scratch, id).find_map(depends)
}

/// Groups of damped nodes whose common motion no damper resists. `None` if dampers leave another motion free, such as
/// that of a lever.
fn common_motions(scratch: &Scratch, damped: &[Group]) -> Option<Vec<Group>> {
    let motions = unresisted(scratch, damped, Balance::Velocity);
    let moves = |entry: f64| entry.abs() > 1e-6;
    let is_common = |motion: &Vec<f64>| motion.iter().all(|&entry| !moves(entry) || !moves(entry - 1.0));
    let member = |(group, &entry): (&Group, &f64)| moves(entry).then_some(group[0]);
    let groups: Vec<Group> = motions
        .iter()
        .map(|motion| damped.iter().zip(motion).filter_map(member).collect())
        .collect();
    let joins_two = |index: usize| {
        let stretch = &scratch.model.links[index].stretch;
        let touches = |group: &&Group| stretch.iter().any(|(id, _)| group.contains(id));
        groups.iter().filter(touches).count() > 1
    };
    let apart = !acting(scratch, Balance::Velocity).any(joins_two);
    (motions.iter().all(is_common) && apart).then_some(groups)
}

/// Groups that move together without any force of the kind that determines their position.
fn floating(scratch: &Scratch, groups: &[Group], balance: Balance) -> Option<Diagnostic> {
    let loose = support(&unresisted(scratch, groups, balance));
    let named = loose.iter().flat_map(|&column| &groups[column]);
    let named = named.map(|id| &scratch.model.coordinates[usize::from(id.0)]);
    let named: Vec<_> = named.map(|node| (node.declared.span, node.name.as_str())).collect();
    let what = match balance {
        Balance::Acceleration => "an inerter",
        Balance::Velocity => "a damper",
        Balance::Position => "a spring or damper",
    };
    (!named.is_empty()).then(|| structure::nodes_float(&named, what))
}

/// Motions of groups that stretch no link of a kind: vectors with an entry for each group.
fn unresisted(scratch: &Scratch, groups: &[Group], balance: Balance) -> Vec<Vec<f64>> {
    let point = Point::new(scratch.model, Kind::Plain, 1);
    let leaf = |symbol| point.leaf(symbol);
    let values = Values::new(&scratch.graph, &leaf);
    let row = |index: usize| -> Vec<f64> {
        let stretch = &scratch.model.links[index].stretch;
        let along = |group: &Group| {
            let held = stretch.iter().filter(|(id, _)| group.contains(id));
            held.map(|(_, coefficient)| values.of(*coefficient)).sum()
        };
        groups.iter().map(along).collect()
    };
    null_space(acting(scratch, balance).map(row).collect(), groups.len())
}

/// The links with a force of a kind.
fn acting<'a>(scratch: &'a Scratch, balance: Balance) -> impl Iterator<Item = usize> + use<'a> {
    let links = 0..scratch.model.links.len();
    links.filter(move |&index| scratch.graph.as_constant(slope(scratch, index, balance)) != Some(0.0))
}
