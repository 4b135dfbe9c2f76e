//! Laws of several stretches: links that use each other's stretch or rate form one element with several travels.
//! Together they must dissipate energy, and their elastic forces must have one potential, otherwise a closed path of
//! the travels would supply energy.

use super::Scratch;
use super::passive::{SPEED, TRAVEL, TRIALS, centred, drawn};
use super::sample::tag;
use crate::diagnostic::{Diagnostic, structure};
use crate::expr::{CoordinateId, Expr, LinkId, Symbol};
use crate::model::{CoordinateKind, Link};

/// Checks that coupled links supply no energy, unless they are declared active, and that none of them ends at a
/// massless node.
pub fn couplings_are_sound(scratch: &Scratch) -> Vec<Diagnostic> {
    let groups = groups(scratch);
    let judge = |group: &Vec<LinkId>| pushes_along(scratch, group).or_else(|| has_no_potential(scratch, group));
    let passive = groups.iter().filter(|group| is_judged(scratch, group));
    at_nodes(scratch).into_iter().chain(passive.filter_map(judge)).collect()
}

fn link<'a>(scratch: &Scratch<'a>, id: LinkId) -> &'a Link {
    &scratch.model.links[usize::from(id.0)]
}

/// Links without states. The stored energy of laws with states cannot be separated from the supplied one, so such links
/// are judged individually.
fn is_judged(scratch: &Scratch, group: &[LinkId]) -> bool {
    let laws = || group.iter().map(|&id| &link(scratch, id).law);
    !laws().any(|law| law.active) && laws().all(|law| law.inner.is_empty())
}

/// Groups of links whose laws use each other.
fn groups(scratch: &Scratch) -> Vec<Vec<LinkId>> {
    let mut groups: Vec<Vec<LinkId>> = Vec::new();
    for (id, slopes) in (0..).map(LinkId).zip(&scratch.slopes) {
        for &(other, _) in &slopes.others {
            let joined = |group: &Vec<LinkId>| group.contains(&id) || group.contains(&other);
            let (touched, apart): (Vec<_>, Vec<_>) = groups.into_iter().partition(joined);
            let mut group = touched.concat();
            group.extend([id, other].into_iter().filter(|new| !touched.concat().contains(new)));
            group.sort();
            groups = apart;
            groups.push(group);
        }
    }
    groups
}

/// The first law of several stretches at each massless node: the balance of the node would need all of the links at
/// once.
fn at_nodes(scratch: &Scratch) -> Vec<Diagnostic> {
    let is_node = |c: &CoordinateId| scratch.model.coordinates[usize::from(c.0)].kind == CoordinateKind::Node;
    let ids = (0..).map(LinkId).zip(&scratch.slopes);
    let coupled = ids
        .filter(|(_, slopes)| !slopes.others.is_empty())
        .map(|(id, _)| link(scratch, id));
    let mistake = |link: &Link| {
        let (node, _) = link.stretch.iter().find(|(c, _)| is_node(c))?;
        let node = &scratch.model.coordinates[usize::from(node.0)];
        let place = (link.declared.span, link.name.as_str());
        Some(structure::coupled_at_node(place, (node.declared.span, &node.name)))
    };
    coupled.filter_map(mistake).collect()
}

/// A motion in whose direction the links together push.
fn pushes_along(scratch: &Scratch, group: &[LinkId]) -> Option<Diagnostic> {
    let forces = forces(scratch, group);
    (0..TRIALS).find_map(|trial| {
        let at = |moving: f64| -> Option<Vec<f64>> { values(scratch, &forces, trial, group, moving) };
        let (moving, still) = (at(1.0)?, at(0.0)?);
        let speeds = group.iter().map(|&id| speed(trial, id));
        let parts = speeds.zip(moving.iter().zip(&still));
        let (power, size) = parts.fold((0.0, 0.0), |(power, size), (v, (moving, still))| {
            (
                power + (moving - still) * v,
                size + (moving.abs() + still.abs()) * v.abs(),
            )
        });
        let first = link(scratch, group[0]);
        (power < -1e-9 * size).then(|| structure::links_give_energy(&named(scratch, group), first.declared.span))
    })
}

/// Two links whose forces have no common potential: the derivatives by each other's stretch differ.
fn has_no_potential(scratch: &Scratch, group: &[LinkId]) -> Option<Diagnostic> {
    let pairs = group
        .iter()
        .flat_map(|&a| group.iter().map(move |&b| (a, b)))
        .filter(|(a, b)| a < b);
    let mut pairs = pairs.map(|(a, b)| ([a, b], [slope(scratch, a, b), slope(scratch, b, a)]));
    let differ = |slopes: [Option<Expr>; 2]| {
        (0..TRIALS).any(|trial| {
            let known: Vec<Expr> = slopes.into_iter().flatten().collect();
            let Some(values) = values(scratch, &known, trial, group, 0.0) else {
                return false;
            };
            // Only one of the two laws uses the other link.
            let [a, b] = [values[0], values.get(1).copied().unwrap_or_default()];
            (a - b).abs() > 1e-6 * (a.abs() + b.abs())
        })
    };
    let (pair, _) = pairs.find(|(_, slopes)| slopes.iter().any(Option::is_some) && differ(*slopes))?;
    Some(structure::no_potential(&named(scratch, &pair)))
}

fn forces(scratch: &Scratch, group: &[LinkId]) -> Vec<Expr> {
    group.iter().map(|id| scratch.slopes[usize::from(id.0)].force).collect()
}

/// Derivative of the force of a link by the stretch of another; `None` if its law does not use that.
fn slope(scratch: &Scratch, of: LinkId, by: LinkId) -> Option<Expr> {
    let mut others = scratch.slopes[usize::from(of.0)].others.iter();
    others.find(|(link, _)| *link == by).map(|&(_, stiffness)| stiffness)
}

fn named<'a>(scratch: &Scratch<'a>, group: &[LinkId]) -> Vec<(crate::source::Span, &'a str)> {
    let links = group.iter().map(|&id| link(scratch, id));
    links.map(|link| (link.declared.span, link.name.as_str())).collect()
}

fn speed(trial: u64, id: LinkId) -> f64 {
    SPEED * centred(trial, tag(Symbol::Rate(id)))
}

/// Expressions at a trial, with the links of a group stretched, and their speeds multiplied by `moving`; `None` if a
/// parameter has neither range nor default.
fn values(scratch: &Scratch, of: &[Expr], trial: u64, group: &[LinkId], moving: f64) -> Option<Vec<f64>> {
    let parameters = drawn(scratch, of, trial)?;
    let leaf = |symbol| {
        parameters(symbol).unwrap_or_else(|| match symbol {
            Symbol::Stretch(id) if group.contains(&id) => TRAVEL * centred(trial, tag(symbol)),
            Symbol::Rate(id) if group.contains(&id) => moving * speed(trial, id),
            _ => 0.0,
        })
    };
    Some(of.iter().map(|&e| scratch.graph.evaluate(e, &leaf)).collect())
}
