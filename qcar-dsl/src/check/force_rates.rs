//! Force inputs on massless nodes: a node between springs follows a force immediately, and its velocity depends on the
//! rate of the force, which is not an input.

use std::collections::BTreeMap;

use super::Scratch;
use super::nodes::{Balance, nodes};
use crate::diagnostic::{Diagnostic, structure};
use crate::expr::{CoordinateId, LinkId, Symbol};
use crate::model::{Link, Quantity, Signal};

/// A force input for each node on which it acts, by its position in `Model::forces`.
type ForcedNodes = BTreeMap<CoordinateId, u16>;

/// Checks that no motion is needed that depends on the rate of a force input.
pub fn rates_of_forces_are_not_needed(scratch: &Scratch) -> Vec<Diagnostic> {
    let model = scratch.model;
    let balances: BTreeMap<CoordinateId, Option<Balance>> = nodes(scratch).into_iter().collect();
    let mistake = |(&node, &force): (&CoordinateId, &u16)| {
        let motion = match balances[&node]? {
            Balance::Position if needs_velocity(scratch, node) => "velocity",
            Balance::Position | Balance::Velocity if shows(scratch, node, Quantity::Acceleration) => "acceleration",
            _ => return None,
        };
        let (node, force) = (
            &model.coordinates[usize::from(node.0)],
            &model.forces[usize::from(force)],
        );
        let force = (force.declared.span, force.name.as_str());
        Some(structure::force_rate_needed(
            (node.declared.span, &node.name),
            force,
            motion,
        ))
    };
    let massless =
        |node: &CoordinateId| matches!(balances.get(node), Some(Some(Balance::Position | Balance::Velocity)));
    forced_nodes(scratch, massless).iter().filter_map(mistake).collect()
}

/// Nodes on which force inputs act directly, through a law, or through links between massless nodes.
fn forced_nodes(scratch: &Scratch, massless: impl Fn(&CoordinateId) -> bool) -> ForcedNodes {
    let model = scratch.model;
    let mut forced_nodes = ForcedNodes::new();
    for (force, input) in (0..).zip(&model.forces) {
        let own = input.on.iter().map(|(c, _)| *c);
        forced_nodes.extend(own.filter(&massless).map(|node| (node, force)));
    }
    for link in &model.links {
        if let Some(&force) = link.law.force_inputs(&scratch.graph).first() {
            forced_nodes.extend(ends(link).filter(&massless).map(|node| (node, force)));
        }
    }
    loop {
        let known = forced_nodes.len();
        for link in &model.links {
            let force = ends(link).find_map(|end| forced_nodes.get(&end).copied());
            let Some(force) = force else { continue };
            for node in ends(link).filter(&massless) {
                forced_nodes.entry(node).or_insert(force);
            }
        }
        if forced_nodes.len() == known {
            return forced_nodes;
        }
    }
}

fn ends(link: &Link) -> impl Iterator<Item = CoordinateId> {
    link.stretch.iter().map(|(c, _)| *c)
}

/// True if an output is the velocity, or if a state of a law depends on it.
fn needs_velocity(scratch: &Scratch, node: CoordinateId) -> bool {
    let links = (0..).map(LinkId).zip(&scratch.model.links);
    let mut held = links.filter(|(_, link)| ends(link).any(|end| end == node));
    let mut grows = |(id, link): (LinkId, &Link)| {
        let rates = link.law.inner.iter().map(|inner| inner.rate);
        scratch.graph.symbols(rates).contains(&Symbol::Rate(id))
    };
    shows(scratch, node, Quantity::Velocity) || held.any(&mut grows)
}

fn shows(scratch: &Scratch, node: CoordinateId, quantity: Quantity) -> bool {
    let moves = |point: u16| {
        let mut combination = scratch.model.points[usize::from(point)].combination.iter();
        combination.any(|(c, _)| *c == node)
    };
    scratch.model.outputs.iter().any(|output| match output.signal {
        Signal::Motion(c, own) => c == node && own == quantity,
        Signal::Point(point, own) => own == quantity && moves(point),
        Signal::LinkForce(_) | Signal::LinkStretch(_) => false,
    })
}
