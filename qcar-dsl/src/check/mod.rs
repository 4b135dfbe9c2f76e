//! Rules of the structure: support, solvability, passivity. Each rule is a function; [`check`] lists them.

use std::ops::Deref;
use std::sync::{Arc, OnceLock};

use crate::diagnostic::{Diagnostic, Report, Severity, outputs, structure};
use crate::expr::Graph;
use crate::front::parse::parse_text;
use crate::front::syntax::File;
use crate::model::{CoordinateKind, Model};
use crate::source::{Source, Span};

// Parameter sets at which a model is tried.
pub(crate) mod sample;
// The range of an expression over the parameters' ranges.
mod extremes;
// Ranks of small dense matrices.
pub(crate) mod rank;
pub(crate) mod solve;
// Derivatives of laws at a point.
pub(crate) mod slopes;
mod stiffness;
// The rules.
mod duplicates;
mod held;
mod inertia;
mod kinetic;
mod nodes;
// Force inputs on massless nodes.
mod force_rates;
mod passive;
// Passivity of links whose laws use each other.
mod coupled;
// From text or tokens to a checked model.
mod text;

use slopes::{Slopes, slopes};
pub use text::{Member, check_members, check_text, check_tokens};

/// A model that has passed every rule. Later stages take one and cannot fail.
#[derive(Clone, Debug)]
pub struct Checked {
    model: Model,
    text: String,
    /// Its syntax tree, parsed on first use and shared by copies.
    tree: Arc<OnceLock<File>>,
    warnings: Report,
    /// Undetermined parameters; unknown before the equations are derived.
    unseen: Option<Vec<Unseen>>,
}

/// Parameters that outputs determine only in combination, or not at all.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Unseen {
    /// Their names.
    pub parameters: Vec<String>,
    /// Number of combinations that the outputs determine.
    pub seen: usize,
}

impl Checked {
    /// Accepts a model without checks.
    ///
    /// For models that a program built and knows to be valid. Later stages do not panic on an invalid one, but their
    /// results are meaningless.
    pub fn trust(model: Model) -> Self {
        Checked {
            model,
            text: String::new(),
            tree: Arc::default(),
            warnings: Report::default(),
            unseen: None,
        }
    }

    /// The model as a separate file, with resolved options; empty for an unchecked model.
    pub fn text(&self) -> &str {
        &self.text
    }

    /// The same model with its text.
    pub(crate) fn with_text(self, text: String) -> Self {
        Checked {
            text,
            tree: Arc::default(),
            ..self
        }
    }

    /// The syntax tree of that file.
    pub(crate) fn tree(&self) -> &File {
        let read = || {
            let source = Source {
                name: self.name.clone(),
                text: self.text.clone(),
            };
            parse_text(&source, 0).file
        };
        self.tree.get_or_init(read)
    }

    /// Parameters that outputs determine only in combination, or not at all; empty before that check
    /// ([`crate::derive::identifiability`]).
    pub fn unseen(&self) -> &[Unseen] {
        self.unseen.as_deref().unwrap_or_default()
    }

    /// The same model, in which parameters are estimated although some are declared `known`, as a campaign may ask.
    pub fn estimating<'a>(mut self, names: impl IntoIterator<Item = &'a str>) -> Self {
        for name in names {
            let own = self
                .model
                .parameters
                .iter_mut()
                .find(|own| own.known && own.name == name);
            if let Some(own) = own {
                own.known = false;
                self.unseen = None;
            }
        }
        self
    }

    /// True if that check is done.
    pub(crate) fn has_identifiability(&self) -> bool {
        self.unseen.is_some()
    }

    /// The same model with these parameters, and warnings about them.
    pub(crate) fn with_unseen(mut self, unseen: Vec<Unseen>, warnings: Vec<Diagnostic>) -> Self {
        self.unseen = Some(unseen);
        self.warnings.add(warnings);
        self
    }

    /// Warnings: text that compiles but is probably a mistake.
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

/// Checks a model against every rule. Warnings are part of the checked model; an error refuses it.
///
/// # Errors
/// Fails with every mistake.
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
    found.extend(force_rates::rates_of_forces_are_not_needed(&scratch));
    found.extend(held::masses_are_held(&scratch));
    if refuses(&found) {
        return Err(found);
    }
    Ok((Checked::trust(model), found))
}

fn refuses(found: &[Diagnostic]) -> bool {
    found.iter().any(|diagnostic| diagnostic.severity == Severity::Error)
}

/// Checks that a model has outputs, and an input that moves it.
fn something_is_seen(model: &Model) -> Vec<Diagnostic> {
    if model.outputs.is_empty() && model.channels.is_empty() {
        vec![outputs::no_outputs(Span::default())]
    } else if !model.is_excited() {
        vec![outputs::no_excitation(Span::default())]
    } else {
        vec![]
    }
}

/// Checks that every road and motion moves something.
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

/// Checks that every gravity acts on a mass.
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

/// Checks that every force input acts on a point, or is used by a law.
fn forces_are_used(model: &Model) -> Vec<Diagnostic> {
    let laws = model.links.iter().flat_map(|link| link.law.force_inputs(&model.graph));
    let used: Vec<u16> = laws.collect();
    let inputs = (0..).zip(&model.forces);
    let idle = inputs.filter(|(place, force)| force.on.is_empty() && !used.contains(place));
    idle.map(|(_, force)| structure::force_not_used(force.declared.span, &force.name))
        .collect()
}

/// A model with derived data for the rules.
struct Scratch<'a> {
    model: &'a Model,
    /// The model's graph, with the derivatives added.
    graph: Graph,
    /// Slopes of the law of each link.
    slopes: Vec<Slopes>,
}

impl<'a> Scratch<'a> {
    fn new(model: &'a Model) -> Scratch<'a> {
        let mut graph = model.graph.clone();
        let slopes = slopes(model, &mut graph);
        Scratch { model, graph, slopes }
    }
}
