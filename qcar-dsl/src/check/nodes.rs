//! Massless nodes: their balance of forces is solved for their position or velocity, so it must be solvable.

use super::Scratch;
use super::rank::{null_space, support};
use super::sample::{Kind, Point, Values};
use crate::diagnostic::{Diagnostic, structure};
use crate::expr::{CoordinateId, Expr, Symbol};
use crate::model::{CoordinateKind, Link};

/// What the balance of a node is solved for.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Balance {
    /// Its acceleration: an inerter holds it.
    Acceleration,
    /// Its velocity: a damper holds it.
    Velocity,
    /// Its position: only springs hold it.
    Position,
}

/// Every node can be solved for.
pub fn nodes_are_solvable(scratch: &Scratch) -> Vec<Diagnostic> {
    let mut found = Vec::new();
    let nodes: Vec<(CoordinateId, Option<Balance>)> = nodes(scratch);
    for &(id, balance) in &nodes {
        let coordinate = &scratch.model.coordinates[usize::from(id.0)];
        let (span, name) = (coordinate.declared.span, coordinate.name.as_str());
        match balance {
            None => found.push(structure::node_not_attached(span, name)),
            Some(balance) => {
                if let Some((link, what)) = nonlinear(scratch, id, balance) {
                    found.push(structure::node_nonlinear(
                        span,
                        name,
                        (link.declared.span, &link.name),
                        what,
                    ));
                }
            }
        }
    }
    if found.is_empty() {
        for balance in [Balance::Position, Balance::Velocity, Balance::Acceleration] {
            found.extend(singular(scratch, &nodes, balance));
        }
    }
    found
}

fn nodes(scratch: &Scratch) -> Vec<(CoordinateId, Option<Balance>)> {
    let ids = (0..scratch.model.coordinates.len() as u16).map(CoordinateId);
    let is_node = |id: &CoordinateId| scratch.model.coordinates[usize::from(id.0)].kind == CoordinateKind::Node;
    ids.filter(is_node).map(|id| (id, balance(scratch, id))).collect()
}

/// The first of inerter, damper and spring that holds a node decides.
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

/// A law at a node whose slope depends on what the balance is solved for.
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

/// Nodes of one kind that move together without any force of that kind.
fn singular(scratch: &Scratch, nodes: &[(CoordinateId, Option<Balance>)], balance: Balance) -> Option<Diagnostic> {
    let own: Vec<CoordinateId> = nodes
        .iter()
        .filter(|(_, b)| *b == Some(balance))
        .map(|(id, _)| *id)
        .collect();
    let point = Point::new(scratch.model, Kind::Plain, 1);
    let leaf = |symbol| point.leaf(symbol);
    let values = Values::new(&scratch.graph, &leaf);
    let acts = |index: &usize| scratch.graph.as_constant(slope(scratch, *index, balance)) != Some(0.0);
    let row = |index: usize| -> Vec<f64> {
        let stretch = &scratch.model.links[index].stretch;
        let coefficient = |id: &CoordinateId| stretch.iter().find(|(other, _)| other == id);
        own.iter()
            .map(|id| coefficient(id).map_or(0.0, |(_, c)| values.of(*c)))
            .collect()
    };
    let rows: Vec<Vec<f64>> = (0..scratch.model.links.len()).filter(acts).map(row).collect();
    let loose = support(&null_space(rows, own.len()));
    let named = loose
        .iter()
        .map(|&column| &scratch.model.coordinates[usize::from(own[column].0)]);
    let named: Vec<_> = named.map(|node| (node.declared.span, node.name.as_str())).collect();
    let what = match balance {
        Balance::Acceleration => "inerters",
        Balance::Velocity => "dampers",
        Balance::Position => "springs",
    };
    (!named.is_empty()).then(|| structure::nodes_float(&named, what))
}
