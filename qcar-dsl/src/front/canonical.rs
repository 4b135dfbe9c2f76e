//! One member of a family as a file of its own: its options are chosen, and the elements that it uses are included. The
//! file gives the same model again.

use std::collections::BTreeSet;

use crate::front::resolve::options::Member;
use crate::front::syntax::{Axle, AxleKind, Element, File, Item, LawStatement, Statement};

/// The text of an axle whose options are chosen.
pub fn canonical(axle: &Axle, member: &Member, elements: &[&Element]) -> String {
    let mut used = BTreeSet::new();
    member
        .body
        .iter()
        .for_each(|statement| of_statement(statement, elements, &mut used));
    let elements = elements.iter().filter(|element| used.contains(&element.name.text));
    let elements = elements.map(|&element| Item::Element(element.clone()));
    let plain = Axle {
        kind: AxleKind::Plain,
        body: member.body.clone(),
        ..axle.clone()
    };
    let file = File {
        items: elements.chain([Item::Axle(plain)]).collect(),
    };
    let choices: Vec<String> = member
        .choices
        .iter()
        .map(|(option, value)| format!("{option} = {value}"))
        .collect();
    match choices.is_empty() {
        true => file.to_string(),
        false => format!("// {}\n{file}", choices.join(", ")),
    }
}

fn of_statement(statement: &Statement, elements: &[&Element], used: &mut BTreeSet<String>) {
    match statement {
        Statement::Direction(direction) => direction
            .body
            .iter()
            .for_each(|inner| of_statement(inner, elements, used)),
        Statement::Link(link) => of_law(&link.body, elements, used),
        _ => {}
    }
}

/// The elements that a law uses, and those that they use.
fn of_law(law: &[LawStatement], elements: &[&Element], used: &mut BTreeSet<String>) {
    for statement in law {
        match statement {
            LawStatement::Rolling(_, law) => of_law(law, elements, used),
            LawStatement::Use(element_use) if used.insert(element_use.element.text.clone()) => {
                let element = elements.iter().find(|element| element.name == element_use.element);
                element.iter().for_each(|element| of_law(&element.body, elements, used));
            }
            _ => {}
        }
    }
}
