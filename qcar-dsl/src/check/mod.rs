//! The structure: what is held, what is solvable, what can be seen. Each rule is a function; [`check`] lists them.

use std::ops::Deref;

use crate::diagnostic::{Diagnostic, Report, Severity, structure, visibility};
use crate::expr::{Differential, Expr, Graph, Symbol};
use crate::hash::HashMap;
use crate::model::{CoordinateKind, Model};
use crate::source::Span;

// Numbers to try a model with.
mod sample;
// What parameters can make of an expression.
mod extremes;
// Small dense matrices.
mod dual;
mod rank;
// Laws about a point.
mod slopes;
mod stiffness;
// The model about a point.
mod response;
// The rules.
mod duplicates;
mod held;
mod inertia;
mod kinetic;
mod nodes;
mod passive;
mod pushed;
mod visible;
// The rule of passive links, for several that use each other.
mod coupled;
// Text or tokens to a checked model.
mod text;

use slopes::{Slopes, slopes};
pub use text::{Member, check_members, check_text, check_tokens};
pub use visible::Unseen;

/// A model that has passed every rule. Every later stage takes one, and none of them fails.
#[derive(Clone, Debug)]
pub struct Checked {
    model: Model,
    text: String,
    warnings: Report,
    unseen: Vec<Unseen>,
}

impl Checked {
    /// Takes a model on trust.
    ///
    /// For models that a program built and knows to be sound. Later stages do not panic on an unsound one, but what
    /// they compute from it means nothing.
    pub fn trust(model: Model) -> Self {
        Checked {
            model,
            text: String::new(),
            warnings: Report::default(),
            unseen: Vec::new(),
        }
    }

    /// The model as a file of its own, options taken; empty for a model taken on trust.
    pub fn text(&self) -> &str {
        &self.text
    }

    /// The same model with its text.
    pub(crate) fn with_text(self, text: String) -> Self {
        Checked { text, ..self }
    }

    /// Parameters that no measurement can tell from each other, or at all.
    pub fn unseen(&self) -> &[Unseen] {
        &self.unseen
    }

    /// What is likely not meant, though it compiles.
    pub fn warnings(&self) -> &Report {
        &self.warnings
    }

    /// The same model with warnings about its text.
    pub(crate) fn with_warnings(self, warnings: Report) -> Self {
        Checked { warnings, ..self }
    }
}

impl Deref for Checked {
    type Target = Model;

    fn deref(&self) -> &Model {
        &self.model
    }
}

/// Holds a model against every rule. Warnings come with the checked model; an error refuses it.
///
/// # Errors
/// Every mistake that is found. What can be seen is asked only of a model that is sound otherwise.
pub fn check(model: Model) -> Result<(Checked, Vec<Diagnostic>), Vec<Diagnostic>> {
    let scratch = Scratch::new(&model);
    let mut found = something_is_seen(&model);
    found.extend(motions_are_used(&model));
    found.extend(gravities_pull(&model));
    found.extend(forces_are_used(&model));
    found.extend(duplicates::links_are_distinct(&model, &scratch.graph));
    found.extend(inertia::inertias_are_positive(&scratch));
    found.extend(passive::links_are_passive(&scratch));
    found.extend(coupled::couplings_are_sound(&scratch));
    found.extend(nodes::nodes_are_solvable(&scratch));
    found.extend(pushed::rates_of_forces_are_not_needed(&scratch));
    found.extend(held::masses_are_held(&scratch));
    if refuses(&found) {
        return Err(found);
    }
    let (unseen, warnings): (Vec<_>, Vec<_>) = visible::parameters_are_seen(&scratch).into_iter().unzip();
    found.extend(warnings);
    let checked = Checked::trust(model);
    Ok((Checked { unseen, ..checked }, found))
}

fn refuses(found: &[Diagnostic]) -> bool {
    found.iter().any(|diagnostic| diagnostic.severity == Severity::Error)
}

/// A model shows something, and something moves it.
fn something_is_seen(model: &Model) -> Vec<Diagnostic> {
    let prescribed = |kind: &CoordinateKind| matches!(kind, CoordinateKind::Road | CoordinateKind::Motion);
    if model.outputs.is_empty() && model.channels.is_empty() {
        vec![visibility::nothing_to_see(Span::default())]
    } else if model.forces.is_empty() && !model.coordinates.iter().any(|c| prescribed(&c.kind)) {
        vec![visibility::nothing_moves(Span::default())]
    } else {
        vec![]
    }
}

/// Every road and motion moves something.
fn motions_are_used(model: &Model) -> Vec<Diagnostic> {
    let mut found = Vec::new();
    for (index, coordinate) in model.coordinates.iter().enumerate() {
        let prescribed = matches!(coordinate.kind, CoordinateKind::Road | CoordinateKind::Motion);
        let touched = model
            .links
            .iter()
            .any(|link| link.stretch.iter().any(|(id, _)| usize::from(id.0) == index));
        if prescribed && !touched {
            found.push(structure::motion_not_used(coordinate.declared.span, &coordinate.name));
        }
    }
    found
}

/// Every gravity pulls a mass.
fn gravities_pull(model: &Model) -> Vec<Diagnostic> {
    let idle = model.gravities.iter().filter(|gravity| {
        let pulled = |c: &&crate::model::Coordinate| c.direction == gravity.direction && !c.angle;
        !model
            .coordinates
            .iter()
            .filter(pulled)
            .any(|c| matches!(c.kind, CoordinateKind::Mass(_)))
    });
    idle.map(|g| structure::gravity_pulls_nothing(g.declared.span, &g.name, &g.direction.0))
        .collect()
}

/// Every force input has a point, or a law that uses it.
fn forces_are_used(model: &Model) -> Vec<Diagnostic> {
    let laws = model.links.iter().flat_map(|link| link.law.force_inputs(&model.graph));
    let used: Vec<u16> = laws.collect();
    let inputs = (0..).zip(&model.forces);
    let idle = inputs.filter(|(place, force)| force.on.is_empty() && !used.contains(place));
    idle.map(|(_, force)| structure::force_not_used(force.declared.span, &force.name))
        .collect()
}

/// A model with what the rules derive from it.
struct Scratch<'a> {
    model: &'a Model,
    /// The model's graph, with the derivatives added.
    graph: Graph,
    /// Of each link.
    slopes: Vec<Slopes>,
    /// The derivatives by the parameters of everything that a response depends on.
    gradients: HashMap<Expr, Vec<(u16, Expr)>>,
}

impl<'a> Scratch<'a> {
    fn new(model: &'a Model) -> Scratch<'a> {
        let mut graph = model.graph.clone();
        let slopes = slopes(model, &mut graph);
        let gradients = gradients(&mut graph, &expressions(model, &slopes), model.parameters.len() as u16);
        Scratch {
            model,
            graph,
            slopes,
            gradients,
        }
    }

    /// The derivatives of an expression by the parameters in it.
    fn gradient(&self, e: Expr) -> &[(u16, Expr)] {
        self.gradients.get(&e).map(Vec::as_slice).unwrap_or_default()
    }
}

/// Everything that a response depends on.
fn expressions(model: &Model, slopes: &[Slopes]) -> Vec<Expr> {
    let laws = slopes.iter().flat_map(Slopes::all);
    let rates = model
        .links
        .iter()
        .flat_map(|link| link.law.inner.iter().map(|inner| inner.rate));
    let stretches = model.links.iter().map(|link| &link.stretch);
    let stretches = stretches.chain(model.forces.iter().map(|force| &force.on));
    let stretches = stretches.chain(model.points.iter().map(|point| &point.combination));
    let stretches = stretches.flatten().map(|(_, coefficient)| *coefficient);
    let inertias = model.coordinates.iter().filter_map(|coordinate| match coordinate.kind {
        CoordinateKind::Mass(inertia) => Some(inertia),
        _ => None,
    });
    laws.chain(rates).chain(stretches).chain(inertias).collect()
}

fn gradients(graph: &mut Graph, expressions: &[Expr], parameters: u16) -> HashMap<Expr, Vec<(u16, Expr)>> {
    let by = |graph: &mut Graph, index| Differential::by(graph, Symbol::Parameter(index));
    let mut by_each: Vec<Differential> = (0..parameters).map(|index| by(graph, index)).collect();
    let mut gradients = HashMap::default();
    for &e in expressions {
        let mut gradient = Vec::new();
        for symbol in graph.symbols([e]) {
            if let Symbol::Parameter(index) = symbol {
                gradient.push((index, by_each[usize::from(index)].of(graph, e)));
            }
        }
        gradients.insert(e, gradient);
    }
    gradients
}
