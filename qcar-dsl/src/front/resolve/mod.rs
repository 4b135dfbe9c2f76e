//! The tree to the model graph: options taken, elements written out, names resolved, units checked.

use std::collections::BTreeMap;

use crate::diagnostic::{Diagnostic, names as mistakes};
use crate::expr::Graph;
use crate::front::syntax::{Axle, Element, Statement};
use crate::model::Model;
use crate::source::Span;

// First the options.
pub mod options;
// Then values and their units.
mod quantity;
mod value;
// Curves through points.
mod table;
// What names mean.
mod names;
// Then what is made of them, in the order in which it is resolved.
mod declare;
// Linear combinations of coordinates.
mod stretch;
// Terms and inner states.
mod law;
// Points, forces and links.
mod connect;
// Outputs and channels.
mod see;

use names::Names;
use options::Member;
use value::Value;

/// A mistake has been reported; nothing more is to be said about it. Only [`Resolver::report`] and names whose own
/// declaration is mistaken give one.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Reported;

/// A thing, or the knowledge that its mistake has been reported.
pub(crate) type Known<Thing> = Result<Thing, Reported>;

/// A statement with the direction that it stands in; empty outside of all.
type Placed<'a> = (&'a str, &'a Statement);

/// Resolves one member of a family, or a plain axle. There is a model only where nothing but warnings is found.
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
fn placed(body: &[Statement]) -> Vec<Placed<'_>> {
    body.iter().flat_map(placed_of).collect()
}

fn placed_of(statement: &Statement) -> Vec<Placed<'_>> {
    match statement {
        Statement::Direction(direction) => direction
            .body
            .iter()
            .map(|inner| (direction.name.text.as_str(), inner))
            .collect(),
        other => vec![("", other)],
    }
}

/// A model under way.
struct Resolver<'a> {
    model: Model,
    names: Names,
    elements: BTreeMap<&'a str, &'a Element>,
    /// The values of `Model::definitions`.
    definitions: Vec<Value>,
    /// Where derived quantities are declared, whether they have been reached or not.
    later: Vec<(Span, String)>,
    /// The text says what is to be seen, even if mistakenly.
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

    /// Adds a mistake; that of an element once, however often it is written out.
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

    /// What nothing uses. A member of a family may leave derived quantities to others.
    fn unused(&mut self, plain: bool) {
        // What is mistaken may be what would have used them.
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
