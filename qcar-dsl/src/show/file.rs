//! The model as a file again: options taken, elements expanded, names resolved. It reads back as the same model.

use std::fmt::Write;

use crate::equations::directions;
use crate::model::{Coordinate, Direction, Link, Model, Quantity, Signal, Term};
use crate::notation::{Notation, Writer};

/// One axle without options that says what the model says.
pub fn model(model: &Model) -> String {
    let mut text = format!("axle {} {{\n", model.name);
    if !model.doc.is_empty() {
        line(&mut text, 1, &format!("{:?}", model.doc));
    }
    if !model.choices.is_empty() {
        let choices = model
            .choices
            .iter()
            .map(|(option, choice)| format!("{option} = {choice}"));
        line(&mut text, 1, &format!("// {}", choices.collect::<Vec<_>>().join(", ")));
    }
    for parameter in &model.parameters {
        line(&mut text, 1, &parameter.declared.line);
    }
    for definition in &model.definitions {
        line(&mut text, 1, &definition.declared.line);
    }
    for direction in directions(model) {
        line(&mut text, 1, &format!("direction {} {{", direction.0));
        for statement in statements(model, direction) {
            line(&mut text, 2, &statement);
        }
        line(&mut text, 1, "}");
    }
    for channel in &model.channels {
        let [above, below] = [&channel.numerator, &channel.denominator].map(|s| signal(model, s, None));
        line(&mut text, 1, &format!("channel {} = {above} / {below};", channel.name));
    }
    text + "}\n"
}

fn line(text: &mut String, depth: usize, statement: &str) {
    writeln!(text, "{:indent$}{statement}", "", indent = 4 * depth).expect("writing to a string cannot fail");
}

fn statements(model: &Model, direction: &Direction) -> Vec<String> {
    let coordinates = model
        .coordinates
        .iter()
        .filter(|c| c.direction == *direction)
        .map(|c| c.declared.line.clone());
    let gravities = model
        .gravities
        .iter()
        .filter(|g| g.direction == *direction)
        .map(|g| g.declared.line.clone());
    let forces = model.forces.iter().filter_map(|force| {
        let on = &model.coordinates[force.on.0 as usize];
        (on.direction == *direction).then(|| format!("force {} on {};", force.name, on.name))
    });
    let links = model
        .links
        .iter()
        .filter(|l| l.direction == *direction)
        .map(|l| link(model, l));
    let outputs = model
        .outputs
        .iter()
        .filter(|o| signal_direction(model, &o.signal) == direction)
        .map(|output| {
            let seen = signal(model, &output.signal, Some(direction));
            format!("output {} = {seen};", output.name)
        });
    coordinates
        .chain(gravities)
        .chain(forces)
        .chain(links)
        .chain(outputs)
        .collect()
}

fn link(model: &Model, link: &Link) -> String {
    let mut writer = Writer::new(model, &model.graph, Notation::File);
    model
        .definitions
        .iter()
        .for_each(|definition| writer.name(definition.value, &definition.name));
    let states = link.law.inner.iter().map(|inner| {
        let name = inner.name.replace('.', "_");
        format!(
            "state {name}: {}; rate {name} = {};",
            inner.unit,
            writer.write(inner.rate)
        )
    });
    let terms = link.law.terms.iter().map(|t| term(&writer, t));
    let rolling = link.rolling.iter().map(|terms| {
        let terms: Vec<_> = terms.iter().map(|t| term(&writer, t)).collect();
        format!("rolling {{ {} }}", terms.join(" "))
    });
    let body: Vec<String> = states.chain(terms).chain(rolling).collect();
    format!(
        "link {}: {} {{ {} }}",
        link.name,
        stretch(model, link, &writer),
        body.join(" ")
    )
}

fn term(writer: &Writer, term: &Term) -> String {
    match *term {
        Term::Spring(k) => format!("spring {};", writer.write(k)),
        Term::Damper(c) => format!("damper {};", writer.write(c)),
        Term::Inerter(b) => format!("inerter {};", writer.write(b)),
        Term::Force(f) => format!("force = {};", writer.write(f)),
    }
}

/// The stretch of a link in the names of the file: `body - (1 - mr)*sf - mr*wheel`.
fn stretch(model: &Model, link: &Link, writer: &Writer) -> String {
    let mut text = String::new();
    for &(coordinate, coefficient) in &link.stretch {
        let name = place(&model.coordinates[coordinate.0 as usize], Some(&link.direction));
        let (negative, magnitude) = writer.coefficient(coefficient);
        text += match (negative, text.is_empty()) {
            (true, true) => "-",
            (true, false) => " - ",
            (false, true) => "",
            (false, false) => " + ",
        };
        text += &match magnitude.as_str() {
            "1" => name,
            _ => format!("{magnitude}*{name}"),
        };
    }
    text
}

/// The name of a coordinate as a statement of `within` calls it: bare there, with its direction elsewhere.
fn place(coordinate: &Coordinate, within: Option<&Direction>) -> String {
    match within {
        Some(direction) if coordinate.direction == *direction => coordinate.name.clone(),
        _ => format!("{}.{}", coordinate.direction.0, coordinate.name),
    }
}

fn signal(model: &Model, signal: &Signal, within: Option<&Direction>) -> String {
    let link = |l: &crate::expr::LinkId| {
        let link = &model.links[l.0 as usize];
        match within {
            Some(direction) if link.direction == *direction => link.name.clone(),
            _ => format!("{}.{}", link.direction.0, link.name),
        }
    };
    match signal {
        Signal::Motion(c, quantity) => {
            format!(
                "{}.{}",
                place(&model.coordinates[c.0 as usize], within),
                quantity_name(*quantity)
            )
        }
        Signal::LinkForce(l) => format!("{}.force", link(l)),
        Signal::LinkStretch(l) => format!("{}.stretch", link(l)),
    }
}

fn signal_direction<'a>(model: &'a Model, signal: &Signal) -> &'a Direction {
    match signal {
        Signal::Motion(c, _) => &model.coordinates[c.0 as usize].direction,
        Signal::LinkForce(l) | Signal::LinkStretch(l) => &model.links[l.0 as usize].direction,
    }
}

fn quantity_name(quantity: Quantity) -> &'static str {
    match quantity {
        Quantity::Position => "position",
        Quantity::Velocity => "velocity",
        Quantity::Acceleration => "acceleration",
    }
}
