//! Effects as canonical text.

use super::{block, law_lines, sentence, statement_lines};
use crate::front::syntax::{Change, Effect, EffectParameter, Form, LawStatement, Name, Pattern, Role, VanishesAt};

/// The lines of an effect.
pub fn effect_lines(effect: &Effect) -> Vec<String> {
    let head = format!("effect {} {}", effect.name.text, pattern(&effect.pattern));
    let sentences = [("source", &effect.source), ("shows", &effect.shows)];
    let sentences = sentences.into_iter().filter(|(_, text)| !text.is_empty());
    let sentences = sentences.map(|(word, text)| format!("{word} {text:?};"));
    let nuisance = effect.nuisance.then(|| "nuisance;".to_string());
    let body = effect.body.iter().flat_map(change_lines);
    let forms = effect.forms.iter().flat_map(form_lines);
    let lines = sentences.chain(nuisance).chain(body).chain(forms);
    block(&head, &effect.doc, lines.collect())
}

fn form_lines(form: &Form) -> Vec<String> {
    let body = form.body.iter().flat_map(change_lines).collect();
    let role: Vec<String> = form.role.iter().map(|role| role.text.clone()).collect();
    let conditions = worded(" role ", &role, " | ") + &worded(" with ", &texts(&form.terms), ", ");
    block(&format!("form {}{conditions}", form.name.text), &form.doc, body)
}

fn pattern(pattern: &Pattern) -> String {
    let mut text = format!("at {} {}", pattern.kind.word(), pattern.variable.text);
    if let Some(direction) = &pattern.direction {
        text += &format!(" in {}", direction.text);
    }
    let names: Vec<String> = pattern.names.iter().map(place_name).collect();
    text += &worded(" named ", &names, " | ");
    let roles: Vec<String> = pattern.roles.iter().map(place_name).collect();
    text += &worded(" role ", &roles, " | ");
    if let Some(point) = &pattern.on {
        text += &format!(" on {}", point.text);
    }
    text += &worded(" with ", &texts(&pattern.terms), ", ");
    text += &worded(" given ", &texts(&pattern.given), ", ");
    if let Some(point) = &pattern.seen_from {
        text += &format!(" seen from {}", point.text);
    }
    text
}

fn place_name((name, called): &(Name, Option<Name>)) -> String {
    match called {
        Some(called) => format!("{} as {}", name.text, called.text),
        None => name.text.clone(),
    }
}

fn texts(names: &[Name]) -> Vec<String> {
    names.iter().map(|name| name.text.clone()).collect()
}

/// A word followed by a list; empty if the list is empty.
fn worded(word: &str, list: &[String], between: &str) -> String {
    if list.is_empty() {
        String::new()
    } else {
        format!("{word}{}", list.join(between))
    }
}

fn change_lines(change: &Change) -> Vec<String> {
    match change {
        Change::Parameter(parameter) => vec![parameter_line(parameter)],
        Change::Declare(statement) => statement_lines(statement),
        Change::Take(part, mass) => vec![format!("take {part} from {mass};")],
        Change::Add(link, law) => law_block(&format!("add to {}", link.text), law),
        Change::ReplaceTerm(term, link, law) => law_block(&format!("replace {} of {}", term.text, link.text), law),
        Change::ReplacePoint { point, of, by } => {
            let of = of.as_ref().map_or(String::new(), |link| format!(" of {}", link.text));
            vec![format!("replace {point}{of} by {by};")]
        }
        Change::ReplaceStretch { of, by, rolling } => {
            let rolling = rolling.as_ref().map_or(String::new(), |by| format!(" rolling {by}"));
            vec![format!("replace s of {} by {by}{rolling};", of.text)]
        }
        Change::PlaceSensor { end, of, at } => {
            let end = end.as_ref().map_or(String::new(), |end| format!("{} ", end.text));
            vec![format!("sensor {end}of {of} at {at};")]
        }
        Change::Remove(link) => vec![format!("remove {};", link.text)],
        Change::Direction { name, without, body } => {
            let without = worded(" without ", &texts(without), ", ");
            let body = body.iter().flat_map(change_lines).collect();
            block(&format!("direction {}{without}", name.text), "", body)
        }
        Change::Delay(place, by) => vec![format!("delay {} by {};", place.text, by.text)],
        Change::Scale(place, by) => vec![format!("scale {} by {};", place.text, by.text)],
    }
}

fn law_block(head: &str, law: &[LawStatement]) -> Vec<String> {
    block(head, "", law.iter().flat_map(law_lines).collect())
}

fn parameter_line(parameter: &EffectParameter) -> String {
    let shared = if parameter.shared { "shared " } else { "" };
    let known = parameter.known && parameter.role != Role::Clock;
    let known = if known { "known " } else { "" };
    let (low, high) = &parameter.range;
    let (role, vanishes) = match &parameter.role {
        Role::Strength(VanishesAt::Zero) => ("strength ", String::new()),
        Role::Strength(VanishesAt::Infinity) => ("strength ", " vanishes at infinity".to_string()),
        Role::Strength(VanishesAt::Value(value)) => ("strength ", format!(" vanishes at {value}")),
        Role::Shape => ("shape ", String::new()),
        Role::Clock => ("clock ", String::new()),
        Role::Other => ("", String::new()),
    };
    format!(
        "{role}{shared}{known}param {}: {} = {} in {low}..{high}{vanishes}{};",
        parameter.name.text,
        parameter.unit,
        parameter.start,
        sentence(&parameter.doc)
    )
}
