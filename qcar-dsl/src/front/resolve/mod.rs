//! From the tree to the model graph: options are chosen, elements expanded, names resolved and units checked.

use std::collections::BTreeMap;

use crate::diagnostic::{Diagnostic, names as mistakes};
use crate::expr::Graph;
use crate::front::syntax::{Axle, Element, Statement};
use crate::model::Model;
use crate::source::Span;

// Options of a family.
pub mod options;
// Values and their units.
mod quantity;
mod value;
// Curves through points.
mod table;
// The meaning of names.
mod names;
// Parameters, derived quantities and coordinates.
mod declare;
// Linear combinations of coordinates.
mod stretch;
// Terms and inner states.
mod law;
// Points, forces and links.
mod connect;
// Outputs and channels.
mod outputs;

use names::Names;
use options::Member;
use value::Value;

/// The error of a value whose mistake has been reported already. It comes from [`Resolver::report`], and from names
/// whose declaration has a mistake.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Reported;

/// A resolved value, or the fact that its mistake has been reported.
pub(crate) type Resolved<T> = Result<T, Reported>;

/// A statement with the name of its direction, which is empty outside of directions.
type StatementOfDirection<'a> = (&'a str, &'a Statement);

/// Resolves one member of a family, or a plain axle. The model is complete only if all diagnostics are warnings.
pub fn resolve(axle: &Axle, member: &Member, elements: &[&Element]) -> (Model, Vec<Diagnostic>) {
    let mut resolver = Resolver::new(axle, member);
    resolver.declare_elements(elements);
    let placed = placed(&member.body);
    resolver.parameters(&placed);
    resolver.definitions(&placed);
    resolver.coordinates(&placed);
    resolver.gravities(&placed);
    resolver.points(&placed);
    resolver.forces(&placed);
    resolver.links(&placed);
    resolver.outputs(&placed);
    resolver.channels(&placed);
    resolver.unused(matches!(axle.kind, crate::front::syntax::AxleKind::Plain));
    (resolver.model, resolver.found)
}

/// Every statement with its direction, in the order of the text.
fn placed(body: &[Statement]) -> Vec<StatementOfDirection<'_>> {
    body.iter().flat_map(placed_of).collect()
}

fn placed_of(statement: &Statement) -> Vec<StatementOfDirection<'_>> {
    match statement {
        Statement::Direction(direction) => direction
            .body
            .iter()
            .map(|inner| (direction.name.text.as_str(), inner))
            .collect(),
        other => vec![("", other)],
    }
}

/// A model that is being resolved.
struct Resolver<'a> {
    model: Model,
    names: Names,
    elements: BTreeMap<&'a str, &'a Element>,
    /// The values of `Model::definitions`.
    definitions: Vec<Value>,
    /// Positions and names of all derived quantities, including those that are not resolved yet.
    later: Vec<(Span, String)>,
    /// True if the text declares outputs, even with mistakes.
    declares_outputs: bool,
    found: Vec<Diagnostic>,
}

impl<'a> Resolver<'a> {
    fn new(axle: &Axle, member: &Member) -> Resolver<'a> {
        let model = Model {
            name: axle.name.text.clone(),
            doc: axle.doc.clone(),
            choices: member.choices.clone(),
            graph: Graph::default(),
            parameters: vec![],
            definitions: vec![],
            coordinates: vec![],
            points: vec![],
            forces: vec![],
            gravities: vec![],
            links: vec![],
            outputs: vec![],
            channels: vec![],
        };
        let names = Names {
            off: member.off.clone(),
            ..Names::default()
        };
        let (elements, definitions, later) = (BTreeMap::new(), vec![], vec![]);
        Resolver {
            model,
            names,
            elements,
            definitions,
            later,
            declares_outputs: false,
            found: vec![],
        }
    }

    /// Adds a mistake. A mistake in an element is added once, however often the element is used.
    fn report(&mut self, mistake: Diagnostic) -> Reported {
        if !self.found.iter().any(|known| known.repeats(&mistake)) {
            self.found.push(mistake);
        }
        Reported
    }

    fn declare_elements(&mut self, elements: &[&'a Element]) {
        for element in elements {
            let name = &element.name;
            if let Some(first) = self.elements.insert(&name.text, element) {
                self.report(mistakes::duplicate_name(
                    name.span,
                    first.name.span,
                    &name.text,
                    "the elements",
                ));
            }
        }
    }

    /// Reports unused names. A derived quantity of a family may be used by other members only.
    fn unused(&mut self, plain: bool) {
        // A statement with a mistake may be the one that uses them.
        if !self.found.is_empty() {
            return;
        }
        let unused = |name: &str| !self.names.used.contains(name);
        let elements = self.elements.values().filter(|element| unused(&element.name.text));
        let elements = elements.map(|element| mistakes::unused_element(element.name.span, &element.name.text));
        let lets = self
            .model
            .definitions
            .iter()
            .filter(|definition| plain && unused(&definition.name));
        let lets = lets.map(|definition| mistakes::unused_let(definition.declared.span, &definition.name));
        let parameters = self.model.parameters.iter().filter(|parameter| unused(&parameter.name));
        let parameters = parameters.map(|p| mistakes::unused_parameter(p.declared.span, &p.name));
        let found: Vec<Diagnostic> = parameters.chain(lets).chain(elements).collect();
        self.found.extend(found);
    }
}
