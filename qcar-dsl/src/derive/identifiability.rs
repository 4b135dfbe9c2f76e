//! Identifiability: a parameter that changes no response, or only in combination with others, cannot be estimated from
//! any measurement. It is decided by the rank of the derivatives of all responses at pseudo-random points.

// Values with their derivatives by parameters.
mod observable;
// Identifiability of laws whose parameters need not change a slope.
mod forces;
// Responses of a model, with their derivatives by the parameters.
mod responses;

use std::collections::BTreeSet;

use num_complex::Complex64;

use crate::check::rank::{null_space_of_scale, support};
use crate::check::sample::{Kind, Point};
use crate::check::{Checked, Unseen};
use crate::derive::linear::{Linear, linearise};
use crate::derive::motion::{self, Motion};
use crate::diagnostic::{Diagnostic, outputs};
use crate::expr::{Expr, Graph, Symbol};
use crate::model::{Model, Quantity, Signal, Term};

use forces::Forces;
use observable::Observable;
use responses::Derived;

/// Number of motions at which a nonlinear model is evaluated first, and if that leaves parameters undetermined: few
/// motions reach each piece of a curve.
const FEW_MOTIONS: u64 = 4;
const MANY_MOTIONS: u64 = 64;

/// Factor on the smallest pivot if only some of the rows are known, since the largest entry of all is unknown then.
const CLEARLY: f64 = 1e3;

/// A parameter set, and the derivatives there: a row for each response, relative to the response and the parameter.
struct ParameterSet {
    parameters: Vec<f64>,
    rows: Vec<Vec<f64>>,
    scale: f64,
}

/// A model with its undetermined parameters and warnings about them; unchanged if they are known.
pub fn with_identifiability(model: Checked) -> Checked {
    if model.has_identifiability() {
        return model;
    }
    let mut graph = model.graph.clone();
    let motion = motion::derive(&model, &mut graph);
    let linear = linearise(&model, &motion, &mut graph);
    with_derived_identifiability(model, graph, &motion, &linear)
}

/// The same with given equations, and their graph.
pub fn with_derived_identifiability(model: Checked, graph: Graph, motion: &Motion, linear: &Linear) -> Checked {
    if model.has_identifiability() {
        return model;
    }
    let (unseen, warnings) = parameters_are_seen(&model, graph, motion, linear).into_iter().unzip();
    model.with_unseen(unseen, warnings)
}

/// Parameters that no output depends on, and groups that outputs determine only in combination, each with a warning:
/// such a model has a response, but cannot be fitted.
fn parameters_are_seen(
    model: &Checked,
    mut graph: Graph,
    motion: &Motion,
    linear: &Linear,
) -> Vec<(Unseen, Diagnostic)> {
    let constant = constant_forces(model);
    let estimated = estimated(model, &constant);
    let forces = Forces::of(model, motion, &mut graph, &estimated);
    let derived = Derived {
        model,
        graph: &graph,
        motion,
        linear,
        forces,
        estimated: &estimated,
    };
    let responses = unseen_by_responses(&derived);
    responses
        .into_iter()
        .chain(alike_constants(&derived, &constant))
        .collect()
}

/// The parameters, of those estimated, that the responses do not determine.
fn unseen_by_responses(derived: &Derived) -> Vec<(Unseen, Diagnostic)> {
    let (model, estimated) = (derived.model, derived.estimated);
    let set = |kind, seed, motions, enough| set(derived, Point::new(model, kind, seed), motions, enough);
    if sees_all(&set(Kind::Plain, 1, FEW_MOTIONS, estimated.len()), estimated.len()) {
        return vec![];
    }
    let first = set(Kind::Plain, 1, FEW_MOTIONS, usize::MAX);
    if first.rows.is_empty() {
        return vec![];
    }
    // Parameters must be undetermined at all sets, since a law may be out of its range at one of them.
    let others = [(Kind::Plain, 2), (Kind::Declared, 3)].map(|(kind, seed)| set(kind, seed, MANY_MOTIONS, usize::MAX));
    described(model, estimated, [first].into_iter().chain(others).collect())
}

/// The constant forces that act alike, so that a mean shows their sum alone.
fn alike_constants(derived: &Derived, constant: &BTreeSet<Symbol>) -> Vec<(Unseen, Diagnostic)> {
    let model = derived.model;
    let own = |index: &u16| constant.contains(&Symbol::Parameter(*index));
    let unknown = |index: &u16| !model.parameters[usize::from(*index)].known;
    let forces: Vec<u16> = (0..model.parameters.len() as u16).filter(own).filter(unknown).collect();
    if forces.len() < 2 {
        return vec![];
    }
    let set = |(kind, seed)| {
        let point = Point::new(model, kind, seed);
        let value = |&index: &u16| point.leaf(Symbol::Parameter(index));
        ParameterSet {
            parameters: forces.iter().map(value).collect(),
            rows: (0..FEW_MOTIONS)
                .flat_map(|motion| derived.changes_by(&forces, point.moved(motion)))
                .collect(),
            scale: 1.0,
        }
    };
    let sets = [(Kind::Plain, 1), (Kind::Plain, 2), (Kind::Declared, 3)].map(set);
    described(model, &forces, sets.into())
}

/// The groups of these parameters that are undetermined at all sets, each with a warning.
fn described(model: &Model, parameters: &[u16], sets: Vec<ParameterSet>) -> Vec<(Unseen, Diagnostic)> {
    let hidden = null_space_of_scale(sets[0].rows.clone(), parameters.len(), sets[0].scale);
    let groups = hidden.iter().map(|change| support(std::slice::from_ref(change)));
    let groups = groups.filter(|group| sets.iter().all(|set| hidden_changes(set, group) > 0));
    let groups = merged(groups.collect());
    groups
        .iter()
        .map(|group| describe(model, parameters, group, &sets))
        .collect()
}

/// The parameters that a measurement should determine. Known ones are left out, and those in the law or the states of a
/// rolling tyre, since rolling over a profile shows more than these responses; also those of a constant force if a
/// position or a force is an output, whose mean shows them.
fn estimated(model: &Model, constant: &BTreeSet<Symbol>) -> Vec<u16> {
    let tyres = || model.links.iter().filter(|link| link.rolling.is_some());
    let rolling = tyres().flat_map(|link| link.rolling.iter().flatten());
    let rates = tyres().flat_map(|link| link.law.inner.iter().map(|inner| inner.rate));
    let value = |term: &Term| match *term {
        Term::Spring(e) | Term::Damper(e) | Term::Inerter(e) | Term::Force(e) => e,
    };
    let expressions: Vec<Expr> = rolling.map(value).chain(rates).collect();
    let rolls: BTreeSet<Symbol> = model.graph.symbols(expressions);
    let counts = |index: &u16| {
        let known = model.parameters[usize::from(*index)].known;
        !known && !rolls.contains(&Symbol::Parameter(*index)) && !constant.contains(&Symbol::Parameter(*index))
    };
    (0..model.parameters.len() as u16).filter(counts).collect()
}

/// Parameters in constant forces, if an output shows a mean.
fn constant_forces(model: &Model) -> BTreeSet<Symbol> {
    let shows_mean = |signal: &Signal| match signal {
        Signal::Motion(_, quantity) | Signal::Point(_, quantity) => *quantity == Quantity::Position,
        Signal::LinkForce(_) | Signal::LinkStretch(_) => true,
    };
    if !model.outputs.iter().any(|output| shows_mean(&output.signal)) {
        return BTreeSet::new();
    }
    let terms = model.links.iter().flat_map(|link| &link.law.terms);
    let contents = terms.filter_map(|term| match *term {
        Term::Force(force) => Some(model.graph.symbols([force])),
        _ => None,
    });
    let is_constant = |symbols: &BTreeSet<Symbol>| symbols.iter().all(|symbol| matches!(symbol, Symbol::Parameter(_)));
    contents.filter(is_constant).flatten().collect()
}

/// True if rows determine all parameters with a wide margin, so that further rows are not needed.
fn sees_all(some: &ParameterSet, parameters: usize) -> bool {
    null_space_of_scale(some.rows.clone(), parameters, CLEARLY * some.scale).is_empty()
}

/// The rows of this number of motions; fewer if `enough` responses suffice.
fn set(derived: &Derived, point: Point, motions: u64, enough: usize) -> ParameterSet {
    let parameters: Vec<f64> = derived
        .estimated
        .iter()
        .map(|&index| point.leaf(Symbol::Parameter(index)))
        .collect();
    let rows: Vec<Vec<f64>> = derived
        .seen(point, motions, enough)
        .into_iter()
        .flat_map(|Observable { value, gradient }| {
            let size = value.norm().max(f64::MIN_POSITIVE);
            let changes = || gradient.iter().zip(&parameters);
            let relative =
                |part: fn(&Complex64) -> f64| -> Vec<f64> { changes().map(|(by, p)| part(by) * p / size).collect() };
            [relative(|z| z.re), relative(|z| z.im)]
        })
        .filter(|row| row.iter().all(|entry| entry.is_finite()) && row.iter().any(|entry| *entry != 0.0))
        .collect();
    let scale = rows
        .iter()
        .flatten()
        .fold(0.0_f64, |scale, entry| scale.max(entry.abs()));
    ParameterSet {
        parameters,
        rows,
        scale,
    }
}

/// Merges groups with a common parameter.
fn merged(groups: Vec<Vec<usize>>) -> Vec<Vec<usize>> {
    let mut merged: Vec<Vec<usize>> = Vec::new();
    for group in groups {
        let shares = |other: &Vec<usize>| other.iter().any(|column| group.contains(column));
        let (mut one, others): (Vec<_>, Vec<_>) = merged.into_iter().partition(shares);
        one.push(group);
        let columns: BTreeSet<usize> = one.into_iter().flatten().collect();
        merged = others;
        merged.push(columns.into_iter().collect());
    }
    merged
}

/// Number of independent changes of a group that the responses at a set do not show.
fn hidden_changes(set: &ParameterSet, group: &[usize]) -> usize {
    let rows: Vec<Vec<f64>> = set
        .rows
        .iter()
        .map(|row| group.iter().map(|&column| row[column]).collect())
        .collect();
    null_space_of_scale(rows, group.len(), set.scale).len()
}

fn describe(model: &Model, estimated: &[u16], group: &[usize], sets: &[ParameterSet]) -> (Unseen, Diagnostic) {
    let parameter = |column: &usize| &model.parameters[usize::from(estimated[*column])];
    let named: Vec<_> = group
        .iter()
        .map(parameter)
        .map(|p| (p.declared.span, p.name.as_str()))
        .collect();
    let hidden = sets.iter().map(|set| hidden_changes(set, group)).min();
    let unseen = Unseen {
        parameters: named.iter().map(|(_, name)| name.to_string()).collect(),
        seen: group.len() - hidden.unwrap_or_default(),
    };
    let warning = match named.as_slice() {
        [(span, name)] => outputs::parameter_undetermined(*span, name),
        _ => outputs::only_in_combination(&named, unseen.seen, combination(group, sets, &named).as_deref()),
    };
    (unseen, warning)
}

/// The combination of two parameters that is constant along the undetermined change, at every set.
fn combination(group: &[usize], sets: &[ParameterSet], named: &[(crate::source::Span, &str)]) -> Option<String> {
    let [(_, a), (_, b)] = named else { return None };
    let unseen = |set: &ParameterSet| {
        let rows = set
            .rows
            .iter()
            .map(|row| group.iter().map(|&column| row[column]).collect())
            .collect();
        let null = null_space_of_scale(rows, 2, set.scale);
        let change = null.first().map_or([0.0; 2], |change| [change[0], change[1]]);
        let absolute = [
            change[0] * set.parameters[group[0]],
            change[1] * set.parameters[group[1]],
        ];
        (change[0] / change[1], absolute[0] / absolute[1])
    };
    let ratios: Vec<(f64, f64)> = sets.iter().map(unseen).collect();
    let always = |of: fn(&(f64, f64)) -> f64, ratio: f64| ratios.iter().all(|pair| (of(pair) - ratio).abs() < 1e-5);
    let (relative, absolute) = (|pair: &(f64, f64)| pair.0, |pair: &(f64, f64)| pair.1);
    match () {
        _ if always(relative, -1.0) => Some(format!("{a}*{b}")),
        _ if always(relative, 1.0) => Some(format!("{a}/{b}")),
        _ if always(absolute, -1.0) => Some(format!("{a} + {b}")),
        _ if always(absolute, 1.0) => Some(format!("{a} - {b}")),
        _ => None,
    }
}
