//! Identifiability: a parameter that changes no response, or only in combination with others, cannot be estimated from
//! any measurement. It is decided by the rank of the derivatives of all responses at pseudo-random points.

// Values with their derivatives by parameters.
mod observable;
// Identifiability of laws whose parameters need not change a slope.
mod forces;
// Responses of a model, with their derivatives by the parameters.
mod responses;
// Changes of parameters that responses do not show.
mod hidden;

use std::collections::BTreeSet;

use crate::check::rank::support;
use crate::check::sample::{Kind, Point};
use crate::check::{Checked, Unseen};
use crate::derive::linear::{Linear, linearise};
use crate::derive::motion::{self, Motion};
use crate::diagnostic::{Diagnostic, outputs};
use crate::expr::{Expr, Graph, Symbol};
use crate::model::{Model, Quantity, Signal, Term};

use forces::Forces;
use hidden::{Shown, within};
use responses::Derived;

/// Number of motions at which a nonlinear model is evaluated first, and if that leaves parameters undetermined: few
/// motions reach each piece of a curve.
const FEW_MOTIONS: u64 = 4;
const MANY_MOTIONS: u64 = 64;

/// A parameter set, and a basis of the changes of the parameters, relative to them, that no response shows there.
struct ParameterSet {
    parameters: Vec<f64>,
    hidden: Vec<Vec<f64>>,
}

/// A model with its undetermined parameters and warnings about them; unchanged if they are known.
pub fn with_identifiability(model: Checked) -> Checked {
    if model.has_identifiability() {
        return model;
    }
    let (graph, motion, linear) = equations(&model);
    with_derived_identifiability(model, graph, &motion, &linear)
}

/// The same with given equations, and their graph.
pub fn with_derived_identifiability(model: Checked, graph: Graph, motion: &Motion, linear: &Linear) -> Checked {
    if model.has_identifiability() {
        return model;
    }
    let found = with_responses(&model, graph, motion, linear, |derived, constant| {
        let mut found = unseen_by_responses(derived);
        found.extend(alike_constants(derived, constant));
        found
    });
    let (unseen, warnings) = found.into_iter().unzip();
    model.with_unseen(unseen, warnings)
}

/// The undetermined groups at a single parameter set, which costs a fraction of [`with_identifiability`]. Each of the
/// groups that this finds consists of some of these and hides as many combinations at most. `None` if that is not
/// certain, since a group hides more than one combination.
pub fn unseen_at_one_set(model: &Checked) -> Option<Vec<Unseen>> {
    let (graph, motion, linear) = equations(model);
    let found = with_responses(model, graph, &motion, &linear, |derived, constant| {
        let mut found = described(model, derived.estimated, &[first_set(derived)]);
        found.extend(alike_constants(derived, constant));
        found
    });
    let groups: Vec<Unseen> = found.into_iter().map(|(group, _)| group).collect();
    let hides_one = |group: &Unseen| group.parameters.len() - group.seen == 1;
    groups.iter().all(hides_one).then_some(groups)
}

fn equations(model: &Checked) -> (Graph, Motion, Linear) {
    let mut graph = model.graph.clone();
    let motion = motion::derive(model, &mut graph);
    let linear = linearise(model, &motion, &mut graph);
    (graph, motion, linear)
}

/// Looks at the responses of a model with given equations; also given the parameters of constant forces whose mean is
/// seen.
fn with_responses<T>(
    model: &Checked,
    mut graph: Graph,
    motion: &Motion,
    linear: &Linear,
    look: impl FnOnce(&Derived, &BTreeSet<Symbol>) -> T,
) -> T {
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
    look(&derived, &constant)
}

/// Parameters, of those estimated, that no output depends on, and groups that outputs determine only in combination,
/// each with a warning: such a model has a response, but cannot be fitted.
fn unseen_by_responses(derived: &Derived) -> Vec<(Unseen, Diagnostic)> {
    let first = first_set(derived);
    if first.hidden.is_empty() {
        return vec![];
    }
    // Parameters must be undetermined at all sets, since a law may be out of its range at one of them.
    let others = [(Kind::Plain, 2), (Kind::Declared, 3)];
    let others = others.map(|(kind, seed)| set(derived, Point::new(derived.model, kind, seed), MANY_MOTIONS));
    let sets: Vec<ParameterSet> = [first].into_iter().chain(others).collect();
    described(derived.model, derived.estimated, &sets)
}

/// The first parameter set. Without any finite response, nothing can be said, and it hides nothing. The same holds for a
/// model that nothing excites: what its free decays show depends on how they begin.
fn first_set(derived: &Derived) -> ParameterSet {
    let first = set(derived, Point::new(derived.model, Kind::Plain, 1), FEW_MOTIONS);
    let is_blind = first.hidden.len() == derived.estimated.len() || !derived.model.is_excited();
    let hidden = if is_blind { vec![] } else { first.hidden };
    ParameterSet { hidden, ..first }
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
        let mut shown = Shown::nothing(forces.len());
        (0..FEW_MOTIONS).any(|motion| shown.add(derived.changes_by(&forces, point.moved(motion))));
        ParameterSet {
            parameters: values(&forces, point),
            hidden: shown.hidden(),
        }
    };
    let sets = [(Kind::Plain, 1), (Kind::Plain, 2), (Kind::Declared, 3)].map(set);
    described(model, &forces, &sets)
}

/// The groups of these parameters that are undetermined at all sets, each with a warning.
fn described(model: &Model, parameters: &[u16], sets: &[ParameterSet]) -> Vec<(Unseen, Diagnostic)> {
    let groups = sets[0]
        .hidden
        .iter()
        .map(|change| support(std::slice::from_ref(change)));
    let groups = groups.filter(|group| sets.iter().all(|set| !within(&set.hidden, group).is_empty()));
    let groups = merged(groups.collect());
    groups
        .iter()
        .map(|group| describe(model, parameters, group, sets))
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

/// The values of parameters.
fn values(parameters: &[u16], point: Point) -> Vec<f64> {
    let value = |&index: &u16| point.leaf(Symbol::Parameter(index));
    parameters.iter().map(value).collect()
}

/// A parameter set in up to this number of motions.
fn set(derived: &Derived, point: Point, motions: u64) -> ParameterSet {
    let parameters = values(derived.estimated, point);
    let mut shown = Shown::nothing(parameters.len());
    derived.see(point, motions, |seen| {
        let rows = seen.into_iter().flat_map(|response| response.relative_to(&parameters));
        shown.add(rows.filter(|row| is_usable(row)).collect())
    });
    let hidden = shown.hidden();
    ParameterSet { parameters, hidden }
}

/// True for a row of numbers that are not all zero.
fn is_usable(row: &[f64]) -> bool {
    row.iter().all(|entry| entry.is_finite()) && row.iter().any(|entry| *entry != 0.0)
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

fn describe(model: &Model, estimated: &[u16], group: &[usize], sets: &[ParameterSet]) -> (Unseen, Diagnostic) {
    let parameter = |column: &usize| &model.parameters[usize::from(estimated[*column])];
    let named: Vec<_> = group
        .iter()
        .map(parameter)
        .map(|p| (p.declared.span, p.name.as_str()))
        .collect();
    let hidden = sets.iter().map(|set| within(&set.hidden, group).len()).min();
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
        let hidden = within(&set.hidden, group);
        let change = hidden
            .first()
            .map_or([0.0; 2], |change| [change[group[0]], change[group[1]]]);
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
