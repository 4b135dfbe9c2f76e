//! Mistakes of effects, and of places where they do not apply.

use super::{Code, Diagnostic, nearest, one_of};
use crate::source::Span;

/// A file without an effect, or with more than one.
pub fn not_one_effect(span: Span, found: usize) -> Diagnostic {
    let message = match found {
        0 => "this file contains no effect".to_string(),
        _ => format!("this file contains {found} effects"),
    };
    Diagnostic::error(Code::NotOneEffect, message)
        .label(span, "one `effect` per file")
        .hint("write one `effect name at link l { … }` in a file of its own")
}

/// An effect that does not say what it is, where it comes from or how it shows.
pub fn not_described(span: Span, effect: &str, what: &str, example: &str) -> Diagnostic {
    Diagnostic::error(Code::EffectNotDescribed, format!("effect `{effect}` has no {what}"))
        .label(span, "an effect needs it")
        .hint(format!("write `{example}` into the effect"))
}

/// A linear term that the language does not have.
pub fn unknown_term(span: Span, term: &str, known: &[&str]) -> Diagnostic {
    Diagnostic::error(Code::UnknownTerm, format!("`{term}` is no kind of linear term"))
        .label(span, "unknown")
        .hint(match nearest(term, known) {
            Some(near) => format!("write `{near}`"),
            None => format!("write {}", one_of(known)),
        })
}

/// A role that no part of a model has.
pub fn unknown_role(span: Span, role: &str, known: &[&str]) -> Diagnostic {
    Diagnostic::error(Code::UnknownRole, format!("`{role}` is no role of such a place"))
        .label(span, "unknown")
        .hint(match nearest(role, known) {
            Some(near) => format!("write `{near}`"),
            None => format!("write {}", one_of(known)),
        })
}

/// An effect of a sensor that changes the model.
pub fn sensor_changes_model(span: Span) -> Diagnostic {
    Diagnostic::error(
        Code::SensorChangesModel,
        "an effect of a sensor cannot change the model",
    )
    .label(span, "the place is a sensor")
    .hint("write `delay m by …;` or `scale m by …;` alone, or an effect `at link l` or `at mass m`")
}

/// A place of a model that the pattern of an effect does not fit, and `why`; without a reason, the model lacks it.
pub fn no_such_place(
    span: Span,
    effect: &str,
    (place, model): (&str, &str),
    why: Option<String>,
    places: &[&str],
) -> Diagnostic {
    let why = why.map_or(String::new(), |why| format!(": {why}"));
    let message = format!("effect `{effect}` does not apply at `{place}` of {model}{why}");
    let hint = match places {
        [] => format!("choose another effect: {model} has no place for this one"),
        _ => format!("write {}", one_of(places)),
    };
    Diagnostic::error(Code::NoSuchPlace, message)
        .label(span, "the pattern of this effect")
        .hint(hint)
}

/// A property that an effect uses and that its place does not have.
pub fn place_lacks(span: Span, wanted: &str, name: &str) -> Diagnostic {
    Diagnostic::error(
        Code::PlaceLacks,
        format!("there is no `{wanted}`: `{name}` does not exist, or has none"),
    )
    .label(span, "asked for here")
    .hint("state in the head of the effect what the place must have: `with damper`, `given body`")
}

/// A place without the role that a form requires.
pub fn place_has_no_role(span: Span, role: &str, name: &str) -> Diagnostic {
    Diagnostic::error(Code::PlaceLacks, format!("`{name}` does not have the role `{role}`"))
        .label(span, "required by this form")
        .hint("choose a form that applies there with `--form`: `qcar effects EFFECT` lists them")
}

/// A name that the model has already.
pub fn already_in_model(span: Span, name: &str, model: &str) -> Diagnostic {
    Diagnostic::error(Code::AlreadyInModel, format!("{model} already has `{name}`"))
        .label(span, "declared by the effect")
        .hint("apply each effect to a model once; for a second part of this kind, write an effect with other names")
}

/// A state that the law of the link has already.
pub fn already_in_link(span: Span, name: &str, link: &str) -> Diagnostic {
    Diagnostic::error(
        Code::AlreadyInLink,
        format!("link `{link}` already has the state `{name}`"),
    )
    .label(span, "declared by the effect")
    .hint("apply each effect to a link once; for a second law of this kind, write an effect with other names")
}

/// A start or bound in a unit other than that of its parameter.
pub fn start_of_other_unit(span: Span, what: &str, expected: &str, found: &str) -> Diagnostic {
    Diagnostic::error(
        Code::StartOfOtherUnit,
        format!("{what} is in {found}, not in {expected}"),
    )
    .label(span, format!("in {found}"))
    .hint(format!(
        "write an expression in {expected}, such as a part of the model's own parameter"
    ))
}

/// A start that is not between its bounds, or has no value.
pub fn start_outside_range(span: Span, name: &str, start: f64, low: f64, high: f64) -> Diagnostic {
    Diagnostic::error(
        Code::StartOutsideRange,
        format!("`{name}` starts at {start:?}, which is not between {low:?} and {high:?}"),
    )
    .label(span, "declared here")
    .hint("write `= start in low..high` with low <= start <= high; a value that is not a number needs a default or range of the model's parameter")
}

/// A second strength of a form.
pub fn second_strength(span: Span, first: Span, effect: &str, name: &str) -> Diagnostic {
    let message = format!("effect `{effect}` has `{name}` as a second strength");
    Diagnostic::error(Code::SecondStrength, message)
        .label(span, "the effect would vanish with this parameter too")
        .label(first, "its strength")
        .hint("write `strength` before the one parameter with which all of the effect vanishes; leave it out elsewhere")
}

/// A strength whose vanishing value is outside of its range.
pub fn vanishes_outside_range(span: Span, name: &str, value: f64, low: f64, high: f64) -> Diagnostic {
    let message = format!("`{name}` vanishes at {value:?}, which is not between {low:?} and {high:?}");
    Diagnostic::error(Code::VanishesOutsideRange, message)
        .label(span, "never reached")
        .hint(
            "write a range that holds the value, `vanishes at infinity`, or nothing for a strength that vanishes at 0",
        )
}

/// True if the mistake is an unused name.
pub fn is_about_use(diagnostic: &Diagnostic) -> bool {
    matches!(
        diagnostic.code,
        Code::UnusedParameter | Code::UnusedLet | Code::UnusedElement
    )
}
