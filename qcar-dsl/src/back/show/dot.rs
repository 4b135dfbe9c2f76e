//! The graph of masses and links, for Graphviz.

use std::fmt::Write;

use crate::back::equations::directions;
use crate::back::notation::{Notation, Writer};
use crate::expr::CoordinateId;
use crate::model::{CoordinateKind, Direction, Link, Model, Term};

/// A drawing: masses are boxes, nodes are points, roads and motions are trapezia, links are edges.
pub fn dot(model: &Model) -> String {
    let mut text = format!(
        "graph {} {{\n    rankdir = TB;\n    node [fontname = sans];\n",
        model.name
    );
    for direction in directions(model) {
        write!(
            text,
            "    subgraph cluster_{0} {{\n        label = {0:?};\n",
            direction.0
        )
        .expect("a string takes all");
        for statement in statements(model, direction) {
            writeln!(text, "        {statement};").expect("a string takes all");
        }
        text += "    }\n";
    }
    text + "}\n"
}

fn statements(model: &Model, direction: &Direction) -> Vec<String> {
    let coordinates = model
        .coordinates
        .iter()
        .enumerate()
        .filter(|(_, c)| c.direction == *direction);
    let coordinates = coordinates.map(|(place, coordinate)| {
        let shape = match coordinate.kind {
            CoordinateKind::Mass(_) if coordinate.angle => "ellipse",
            CoordinateKind::Mass(_) => "box",
            CoordinateKind::Node => "point",
            CoordinateKind::Road | CoordinateKind::Motion => "invtrapezium",
        };
        format!(
            "{} [label = {:?}, shape = {shape}]",
            node(model, CoordinateId(place as u16)),
            coordinate.name
        )
    });
    let forces = model.forces.iter().filter(|force| force.direction == *direction);
    let forces = forces.flat_map(|force| {
        let name = &force.name;
        let pushed = force.on.iter().map(|&(coordinate, _)| node(model, coordinate));
        let edges = pushed.map(move |pushed| format!("{name} -- {pushed} [dir = forward, style = dashed]"));
        std::iter::once(format!("{name} [shape = plaintext]")).chain(edges)
    });
    let links = model
        .links
        .iter()
        .filter(|link| link.direction == *direction)
        .flat_map(|link| edges(model, link));
    coordinates.chain(forces).chain(links).collect()
}

fn node(model: &Model, coordinate: CoordinateId) -> String {
    let coordinate = &model.coordinates[coordinate.0 as usize];
    format!("{}_{}", coordinate.direction.0, coordinate.name)
}

/// One edge for a link between two points; a star with the coefficients for a lever.
fn edges(model: &Model, link: &Link) -> Vec<String> {
    let label = format!("{}\\n{}", link.name, law(model, link));
    if let [(upper, _), (lower, _)] = link.stretch[..] {
        return vec![format!(
            "{} -- {} [label = \"{label}\"]",
            node(model, upper),
            node(model, lower)
        )];
    }
    let star = format!("link_{}_{}", link.direction.0, link.name);
    let writer = Writer::new(model, &model.graph, Notation::Text);
    let mut edges = vec![format!("{star} [label = \"{label}\", shape = plaintext]")];
    edges.extend(link.stretch.iter().map(|&(coordinate, coefficient)| {
        format!(
            "{star} -- {} [label = \"{}\"]",
            node(model, coordinate),
            writer.write(coefficient)
        )
    }));
    edges
}

fn law(model: &Model, link: &Link) -> String {
    let mut writer = Writer::new(model, &model.graph, Notation::Text);
    model
        .definitions
        .iter()
        .for_each(|definition| writer.name(definition.value, &definition.name));
    let term = |term: &Term| match *term {
        Term::Spring(k) => format!("spring {}", writer.write(k)),
        Term::Damper(c) => format!("damper {}", writer.write(c)),
        Term::Inerter(b) => format!("inerter {}", writer.write(b)),
        Term::Force(f) => writer.write(f),
    };
    link.law.terms.iter().map(term).collect::<Vec<_>>().join("\\n")
}
