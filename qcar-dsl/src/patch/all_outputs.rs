//! A model that outputs the motion of all its parts, with a force input at each mass.

use super::model_tree::{ModelTree, coordinates, links};
use super::rewrite::named;
use crate::check::Checked;
use crate::check::check_text;
use crate::diagnostic::Report;
use crate::front::syntax::{CoordinateKind, Direction, Dotted, Name, Statement};
use crate::source::Source;

/// Beginning of the names of the force inputs at masses.
const PUSH: &str = "watched_push";

/// Name of the force input at a mass along a direction.
pub fn push(direction: &str, mass: &str) -> String {
    format!("{PUSH}_{direction}_{mass}")
}

/// True for the name of a force input of [`with_all_outputs`].
pub fn is_push(input: &str) -> bool {
    input.starts_with(PUSH)
}

/// The model with the stretch and the force of every link and the acceleration of every mass among its outputs, and with
/// a force input at every mass, named by [`push`].
///
/// # Errors
/// Fails only through a mistake in this function, since every part of a checked model can be an output.
pub fn with_all_outputs(model: &Checked) -> Result<Checked, Report> {
    let mut tree = ModelTree::of(model);
    for statement in &mut tree.axle.body {
        if let Statement::Direction(direction) = statement {
            let shown: Vec<Statement> = shown(direction);
            direction.body.extend(shown);
        }
    }
    let source = Source {
        name: format!("{}.axle", model.name),
        text: tree.file().to_string(),
    };
    check_text(source, &|_, path| Err(format!("{path} is not part of a plain model")))
}

fn shown(direction: &Direction) -> Vec<Statement> {
    let of_links = links(direction).flat_map(|link| ["stretch", "force"].map(|what| (&link.name, what)));
    let is_mass = |kind: &CoordinateKind| matches!(kind, CoordinateKind::Mass(_) | CoordinateKind::Inertia(_));
    let masses = coordinates(direction).filter(|own| is_mass(&own.kind));
    let masses: Vec<&Name> = masses.map(|mass| &mass.name).collect();
    let of_masses = masses.iter().map(|mass| (*mass, "acceleration"));
    let outputs = of_links.chain(of_masses);
    let outputs = outputs.map(|(place, what)| output(&direction.name, place, what));
    let pushes = masses.iter().map(|mass| {
        let name = Name::new(push(&direction.name.text, &mass.text));
        Statement::Force(name, Some(named(&mass.text)))
    });
    outputs.chain(pushes).collect()
}

fn output(direction: &Name, place: &Name, what: &str) -> Statement {
    let name = format!("watched_{}_{}_{what}", direction.text, place.text);
    let signal = Dotted {
        names: vec![Name::new(&place.text), Name::new(what)],
    };
    Statement::Output(Some(Name::new(name)), signal)
}
