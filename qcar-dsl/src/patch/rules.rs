//! Rules for an effect's file that hold for any model.

use super::PatchResult;
use super::roles::{OF_LINKS, OF_MASSES};
use super::terms::{LINEAR, WORDS};
use crate::diagnostic::{Diagnostic, Severity, effects, names, reading};
use crate::front::parse::parse_text;
use crate::front::syntax::{Change, Effect, EffectParameter, Item, Name, PlaceKind, Role};
use crate::source::{Source, Span};

/// The only effect of a file.
pub fn effect_of(source: &Source) -> PatchResult<Effect> {
    let reading = parse_text(source, 0);
    let mut found = reading.mistakes;
    let effects: Vec<Effect> = reading
        .file
        .items
        .into_iter()
        .filter_map(|item| match item {
            Item::Effect(effect) => Some(*effect),
            _ => None,
        })
        .collect();
    if found.is_empty() {
        match effects.as_slice() {
            [effect] => found.extend(mistakes(effect)),
            others => found.push(effects::not_one_effect(second(others), others.len())),
        }
    }
    let is_well = found.iter().all(|diagnostic| diagnostic.severity != Severity::Error);
    effects.into_iter().next().filter(|_| is_well).ok_or(found)
}

fn second(effects: &[Effect]) -> Span {
    effects.get(1).map_or(Span::default(), |second| second.name.span)
}

fn mistakes(effect: &Effect) -> Vec<Diagnostic> {
    let mut found = undescribed(effect);
    found.extend(forms_are_told_apart(effect));
    found.extend(second_strengths(effect));
    let pattern = &effect.pattern;
    let of_forms = effect.forms.iter().flat_map(|form| &form.terms);
    for term in pattern.terms.iter().chain(of_forms) {
        found.extend(no_term(term, &WORDS));
    }
    let roles = pattern.roles.iter().map(|(role, _)| role);
    let roles = roles.chain(effect.forms.iter().filter_map(|form| form.role.as_ref()));
    found.extend(roles.filter_map(|role| no_role(role, pattern.kind)));
    for change in effect
        .body
        .iter()
        .chain(effect.forms.iter().flat_map(|form| &form.body))
    {
        match change {
            Change::ReplaceTerm(term, ..) => found.extend(no_term(term, &LINEAR)),
            Change::Delay(place, _) if pattern.kind != PlaceKind::Sensor => {
                found.push(reading::misplaced_statement(
                    place.span,
                    "delay",
                    "an effect `at sensor m`",
                ));
            }
            Change::Scale(place, _) if !matches!(pattern.kind, PlaceKind::Sensor | PlaceKind::Force) => {
                found.push(reading::misplaced_statement(
                    place.span,
                    "scale",
                    "an effect `at sensor m` or `at force f`",
                ));
            }
            Change::Parameter(_) | Change::Delay(..) | Change::Scale(..) => {}
            _ if pattern.kind == PlaceKind::Sensor => found.push(effects::sensor_changes_model(pattern.variable.span)),
            _ => {}
        }
    }
    found
}

/// Each form has a unique name and a description.
fn forms_are_told_apart(effect: &Effect) -> Vec<Diagnostic> {
    let mut found = Vec::new();
    for (place, form) in effect.forms.iter().enumerate() {
        let (span, name) = (form.name.span, &form.name.text);
        if let Some(first) = effect.forms[..place].iter().find(|other| other.name.text == *name) {
            let place = format!("effect `{}`", effect.name.text);
            found.push(names::duplicate_name(span, first.name.span, name, &place));
        }
        if form.doc.is_empty() {
            let what = format!("sentence that says what its form `{name}` is");
            found.push(effects::not_described(span, &effect.name.text, &what, "\"what it is\""));
        }
    }
    found
}

/// Each form has at most one strength.
fn second_strengths(effect: &Effect) -> Vec<Diagnostic> {
    let shared = strengths(effect.parameters());
    let mut found = beyond_first(effect, &shared);
    for form in &effect.forms {
        let first = shared.iter().copied().take(1);
        let all: Vec<&Name> = first.chain(strengths(form.parameters())).collect();
        found.extend(beyond_first(effect, &all));
    }
    found
}

fn strengths(declared: Vec<&EffectParameter>) -> Vec<&Name> {
    let strengths = declared.into_iter().filter(|own| matches!(own.role, Role::Strength(_)));
    strengths.map(|own| &own.name).collect()
}

fn beyond_first(effect: &Effect, strengths: &[&Name]) -> Vec<Diagnostic> {
    let Some((first, more)) = strengths.split_first() else {
        return vec![];
    };
    more.iter()
        .map(|own| effects::second_strength(own.span, first.span, &effect.name.text, &own.text))
        .collect()
}

/// An effect needs a description, the source of its law and how it shows, so that a person can judge it.
fn undescribed(effect: &Effect) -> Vec<Diagnostic> {
    let span = effect.name.span;
    let told = [
        (&effect.doc, "sentence that says what it is", "\"what it is\""),
        (&effect.source, "source of its law", "source \"Author: Title, year\";"),
        (
            &effect.shows,
            "sentence that says how it shows",
            "shows \"how it shows in measurements\";",
        ),
    ];
    let missing = told.into_iter().filter(|(text, ..)| text.is_empty());
    missing
        .map(|(_, what, example)| effects::not_described(span, &effect.name.text, what, example))
        .collect()
}

fn no_term(term: &Name, known: &[&str]) -> Option<Diagnostic> {
    (!known.contains(&term.text.as_str())).then(|| effects::unknown_term(term.span, &term.text, known))
}

fn no_role(role: &Name, kind: PlaceKind) -> Option<Diagnostic> {
    let known: &[&str] = match kind {
        PlaceKind::Link => &OF_LINKS,
        PlaceKind::Mass | PlaceKind::Sensor => &OF_MASSES,
        PlaceKind::Force => &[],
    };
    (!known.contains(&role.text.as_str())).then(|| effects::unknown_role(role.span, &role.text, known))
}
