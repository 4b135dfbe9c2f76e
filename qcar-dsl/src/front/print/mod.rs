//! Prints the tree as canonical model text, which parses to the same tree. Comments of the file are not part of the
//! tree.

use std::fmt::{self, Display, Formatter};

use crate::front::syntax::{
    Axle, AxleKind, Choice, Coordinate, CoordinateKind, Element, ElementUse, File, If, Item, LawStatement, Let, Link,
    Parameter, ParameterDefault, Requirement, Statement,
};

// Effects.
mod effect;
// Expressions, conditions, numbers and units.
mod expression;

impl Display for File {
    fn fmt(&self, f: &mut Formatter) -> fmt::Result {
        for (index, item) in self.items.iter().enumerate() {
            let lines = match item {
                Item::Axle(axle) => axle_lines(axle),
                Item::Element(element) => element_lines(element),
                Item::Effect(effect) => effect::effect_lines(effect),
            };
            f.write_str(if index > 0 { "\n" } else { "" })?;
            lines.iter().try_for_each(|line| writeln!(f, "{line}"))?;
        }
        Ok(())
    }
}

/// A declaration on one line, as `model::Declaration` stores it.
pub fn one_line(statement: &Statement) -> String {
    let lines = statement_lines(statement);
    let words: Vec<&str> = lines.iter().map(|line| line.trim()).collect();
    words.join(" ")
}

fn axle_lines(axle: &Axle) -> Vec<String> {
    let name = &axle.name.text;
    let head = match &axle.kind {
        AxleKind::Plain => format!("axle {name}"),
        AxleKind::Family => format!("family {name}"),
        AxleKind::From(path) => format!("axle {name} from {:?}", path.text),
    };
    block(&head, &axle.doc, axle.body.iter().flat_map(statement_lines).collect())
}

fn element_lines(element: &Element) -> Vec<String> {
    let argument = |(name, unit): &(crate::front::syntax::Name, _)| format!("{}: {unit}", name.text);
    let arguments: Vec<String> = element.arguments.iter().map(argument).collect();
    let head = format!("element {}({})", element.name.text, arguments.join(", "));
    block(&head, &element.doc, element.body.iter().flat_map(law_lines).collect())
}

/// A head, then a description and lines in braces.
fn block(head: &str, doc: &str, body: Vec<String>) -> Vec<String> {
    let doc = (!doc.is_empty()).then(|| format!("{doc:?}"));
    let inside = doc.into_iter().chain(body).map(|line| format!("    {line}"));
    std::iter::once(format!("{head} {{"))
        .chain(inside)
        .chain(["}".to_string()])
        .collect()
}

fn statement_lines(statement: &Statement) -> Vec<String> {
    match statement {
        Statement::Option(choice) => vec![option(choice)],
        Statement::Require(Requirement { condition, message, .. }) => vec![format!("require {condition} {message:?};")],
        Statement::Choose(option, value) => vec![format!("{} = {};", option.text, value.text)],
        Statement::Parameter(parameter) => vec![parameter_line(parameter)],
        Statement::Let(definition) => vec![let_line(definition)],
        Statement::If(choice) => if_lines(choice, statement_lines),
        Statement::Direction(direction) => {
            let body = direction.body.iter().flat_map(statement_lines).collect();
            block(&format!("direction {}", direction.name.text), "", body)
        }
        Statement::Coordinate(coordinate) => vec![coordinate_line(coordinate)],
        Statement::Gravity(name) => vec![format!("gravity {};", name.text)],
        Statement::Force(name, Some(on)) => vec![format!("force {} on {on};", name.text)],
        Statement::Force(name, None) => vec![format!("force {};", name.text)],
        Statement::Point(name, target) => vec![format!("point {} = {target};", name.text)],
        Statement::Link(link) => link_lines(link),
        Statement::Output(Some(name), signal) => vec![format!("output {} = {signal};", name.text)],
        Statement::Output(None, signal) => vec![format!("output {signal};")],
        Statement::Channel(name, above, below) => vec![format!("channel {} = {above} / {below};", name.text)],
    }
}

fn option(choice: &Choice) -> String {
    let values: Vec<&str> = choice.values.iter().map(|value| value.text.as_str()).collect();
    let default = choice
        .default
        .as_ref()
        .map_or(String::new(), |default| format!(" = {}", default.text));
    format!(
        "option {}: {}{default}{};",
        choice.name.text,
        values.join(" | "),
        sentence(&choice.doc)
    )
}

fn parameter_line(parameter: &Parameter) -> String {
    let known = match (parameter.clock, parameter.known) {
        (true, _) => "clock ",
        (false, true) => "known ",
        (false, false) => "",
    };
    let default = match &parameter.default {
        None => String::new(),
        Some(ParameterDefault::Number(number)) => format!(" = {number}"),
        Some(ParameterDefault::Same(name)) => format!(" = {}", name.text),
    };
    let range = parameter
        .range
        .as_ref()
        .map_or(String::new(), |(low, high)| format!(" in {low}..{high}"));
    let doc = sentence(&parameter.doc);
    format!(
        "{known}param {}: {}{default}{range}{doc};",
        parameter.name.text, parameter.unit
    )
}

fn let_line(definition: &Let) -> String {
    format!(
        "let {} = {}{};",
        definition.name.text,
        definition.value,
        sentence(&definition.doc)
    )
}

fn sentence(doc: &str) -> String {
    if doc.is_empty() {
        String::new()
    } else {
        format!(" {doc:?}")
    }
}

fn coordinate_line(coordinate: &Coordinate) -> String {
    let name = &coordinate.name.text;
    let angle = if coordinate.angle { ": angle" } else { "" };
    let head = match &coordinate.kind {
        CoordinateKind::Mass(mass) => format!("mass {name}{angle} = {mass}"),
        CoordinateKind::Inertia(inertia) => format!("inertia {name} = {inertia}"),
        CoordinateKind::Node => format!("node {name}{angle}"),
        CoordinateKind::Road => format!("road {name}{angle}"),
        CoordinateKind::Motion => format!("motion {name}{angle}"),
    };
    format!("{head}{};", sentence(&coordinate.doc))
}

fn link_lines(link: &Link) -> Vec<String> {
    let head = format!("link {}: {}", link.name.text, link.stretch);
    block(&head, &link.doc, link.body.iter().flat_map(law_lines).collect())
}

fn if_lines<Part>(choice: &If<Part>, lines: impl Fn(&Part) -> Vec<String>) -> Vec<String> {
    let mut all: Vec<String> = Vec::new();
    let mut append = |head: &str, parts: &[Part]| {
        let mut next = block(head, "", parts.iter().flat_map(&lines).collect());
        if let Some(last) = all.pop() {
            next[0] = format!("{last} else {}", next[0]);
        }
        all.append(&mut next);
    };
    for (condition, parts) in &choice.branches {
        append(&format!("if {condition}"), parts);
    }
    if !choice.otherwise.is_empty() {
        append("", &choice.otherwise);
    }
    all.iter().map(|line| line.replace("else  {", "else {")).collect()
}

fn law_lines(statement: &LawStatement) -> Vec<String> {
    match statement {
        LawStatement::Spring(k) => vec![format!("spring {k};")],
        LawStatement::Damper(c) => vec![format!("damper {c};")],
        LawStatement::Inerter(b) => vec![format!("inerter {b};")],
        LawStatement::Force(force) => vec![format!("force = {force};")],
        LawStatement::State(name, unit) => vec![format!("state {}: {unit};", name.text)],
        LawStatement::Rate(name, rate) => vec![format!("rate {} = {rate};", name.text)],
        LawStatement::Let(definition) => vec![let_line(definition)],
        LawStatement::Use(element) => vec![use_line(element)],
        LawStatement::Active => vec!["active;".to_string()],
        LawStatement::Rolling(_, body) => block("rolling", "", body.iter().flat_map(law_lines).collect()),
        LawStatement::If(choice) => if_lines(choice, law_lines),
    }
}

fn use_line(element: &ElementUse) -> String {
    let label = element
        .label
        .as_ref()
        .map_or(String::new(), |label| format!("{}: ", label.text));
    let arguments: Vec<String> = element.arguments.iter().map(ToString::to_string).collect();
    format!("{label}{}({});", element.element.text, arguments.join(", "))
}
