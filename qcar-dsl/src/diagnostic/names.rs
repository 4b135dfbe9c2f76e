//! Mistakes of options, names and elements.

use super::{Code, Diagnostic, all_of, nearest, one_of};
use crate::source::Span;

/// A family's file that cannot be read.
pub fn family_not_loaded(span: Span, path: &str, reason: &str) -> Diagnostic {
    Diagnostic::error(
        Code::FamilyNotLoaded,
        format!("the family \"{path}\" cannot be read: {reason}"),
    )
    .label(span, "named here")
    .hint("write the family's path relative to this file, such as `\"../families/corner.axle\"`")
}

/// `from` with a file that contains no family.
pub fn not_a_family(span: Span, path: &str) -> Diagnostic {
    Diagnostic::error(Code::NotAFamily, format!("\"{path}\" contains no family"))
        .label(span, "an axle is chosen from a family")
        .hint("write `family name { … }` in that file, or name another file")
}

/// A choice or condition of an option that the family does not have.
pub fn unknown_option(span: Span, name: &str, options: &[String]) -> Diagnostic {
    let hint = match (nearest(name, options), options) {
        (Some(near), _) => format!("write `{near}`"),
        (None, []) => "write an `option` into a family; a plain axle has none".to_string(),
        (None, _) => format!("write one of {}", one_of(options)),
    };
    Diagnostic::error(Code::UnknownOption, format!("there is no option `{name}`"))
        .label(span, "unknown")
        .hint(hint)
}

/// A value that an option cannot have.
pub fn unknown_value(span: Span, option: &str, value: &str, values: &[String]) -> Diagnostic {
    Diagnostic::error(Code::UnknownValue, format!("option `{option}` cannot be `{value}`"))
        .label(span, "not one of its values")
        .hint(format!("write {}", one_of(values)))
}

/// An option without default that an axle does not choose.
pub fn option_not_chosen(span: Span, option: &str, values: &[String]) -> Diagnostic {
    Diagnostic::error(
        Code::OptionNotChosen,
        format!("option `{option}` is not chosen and has no default"),
    )
    .label(span, "chosen by this axle")
    .hint(format!("write `{option} = …;` with {}", one_of(values)))
}

/// A `require` that the chosen options break.
pub fn requirement_failed(axle: Span, rule: Span, message: &str, condition: &str, state: &[String]) -> Diagnostic {
    Diagnostic::error(
        Code::RequirementFailed,
        format!("these options cannot be combined: {message}"),
    )
    .label(axle, format!("chosen here: {}", state.join(", ")))
    .label(rule, "required here")
    .hint(format!("write choices for which `{condition}` holds"))
}

/// An option that no condition asks about.
pub fn unused_option(span: Span, option: &str) -> Diagnostic {
    Diagnostic::warning(Code::UnusedOption, format!("option `{option}` changes nothing"))
        .label(span, "no `if` and no `require` uses it")
        .hint(format!("write `if {option} == … {{ … }}`, or remove the option"))
}

/// A name that is declared twice.
pub fn duplicate_name(span: Span, first: Span, name: &str, place: &str) -> Diagnostic {
    Diagnostic::error(Code::DuplicateName, format!("`{name}` is declared twice in {place}"))
        .label(span, "again here")
        .label(first, "first here")
        .hint("write another name for one of them")
}

/// A name that is not declared.
pub fn unknown_name(span: Span, name: &str, place: &str, known: &[String]) -> Diagnostic {
    let hint = match nearest(name, known) {
        Some(near) => format!("write `{near}`"),
        None if known.is_empty() => "declare it first".to_string(),
        None => format!("write one of {}, or declare it", one_of(known)),
    };
    Diagnostic::error(Code::UnknownName, format!("{place} has no `{name}`"))
        .label(span, "unknown")
        .hint(hint)
}

/// A name whose declaration is switched off by an option.
pub fn switched_off(span: Span, name: &str, options: &str) -> Diagnostic {
    Diagnostic::error(Code::SwitchedOff, format!("`{name}` is switched off by {options}"))
        .label(span, "not part of this member of the family")
        .hint(format!(
            "write other options, or use `{name}` only inside the `if` that declares it"
        ))
}

/// A derived quantity used above its declaration.
pub fn used_before_declared(span: Span, declared: Span, name: &str) -> Diagnostic {
    Diagnostic::error(
        Code::UsedBeforeDeclared,
        format!("`{name}` is used before it is derived"),
    )
    .label(span, "used here")
    .label(declared, "derived here")
    .hint(format!("write `let {name} = …;` above this line"))
}

/// A parameter or derived quantity of the model, used inside an element.
pub fn element_is_closed(span: Span, name: &str, unit: &str) -> Diagnostic {
    Diagnostic::error(
        Code::ElementIsClosed,
        format!("an element can use its arguments only, not `{name}`"),
    )
    .label(span, "declared outside of the element")
    .hint(format!(
        "write `{name}: {unit}` into the element's arguments, and give it where the element is used"
    ))
}

/// `s` or `v` outside of a law.
pub fn law_variable_outside(span: Span, name: &str) -> Diagnostic {
    let meaning = if name == "s" {
        "the stretch of a link"
    } else {
        "the rate of a link's stretch"
    };
    Diagnostic::error(
        Code::LawVariableOutside,
        format!("`{name}` is {meaning}, which only a law can use"),
    )
    .label(span, "outside of a law")
    .hint("write it inside `link … { force = …; }`, or use a parameter here")
}

/// A coordinate where only parameters are known.
pub fn coordinate_in_expression(span: Span, name: &str) -> Diagnostic {
    Diagnostic::error(
        Code::CoordinateInExpression,
        format!("`{name}` moves, so it cannot be used in this expression"),
    )
    .label(span, "a coordinate")
    .hint("write it in the stretch of a link, `link name: a - b { … }`, whose law uses `s` and `v`")
}

/// A name that exists in several directions, used without its direction.
pub fn ambiguous_direction(span: Span, name: &str, directions: &[String]) -> Diagnostic {
    let full: Vec<String> = directions
        .iter()
        .map(|direction| format!("{direction}.{name}"))
        .collect();
    Diagnostic::error(Code::AmbiguousDirection, format!("`{name}` is in several directions"))
        .label(span, "which one?")
        .hint(format!("write {}", one_of(&full)))
}

/// A direction that the model does not have.
pub fn unknown_direction(span: Span, name: &str, known: &[String]) -> Diagnostic {
    Diagnostic::error(Code::UnknownDirection, format!("the model has no direction `{name}`"))
        .label(span, "unknown")
        .hint(if known.is_empty() {
            format!("write `direction {name} {{ … }}`")
        } else {
            format!("write one of {}", one_of(known))
        })
}

/// A function that the language does not have.
pub fn unknown_function(span: Span, name: &str, known: &[&str]) -> Diagnostic {
    let hint = match nearest(name, known) {
        Some(near) => format!("write `{near}(…)`"),
        None => format!(
            "write one of {}; elements are used as statements of a law",
            one_of(known)
        ),
    };
    Diagnostic::error(Code::UnknownFunction, format!("there is no function `{name}`"))
        .label(span, "unknown")
        .hint(hint)
}

/// A function or element with the wrong number of arguments.
pub fn wrong_arguments(span: Span, name: &str, expected: &[String], found: usize) -> Diagnostic {
    let message = format!(
        "`{name}` takes {} {}, not {found}",
        expected.len(),
        plural(expected.len(), "argument")
    );
    Diagnostic::error(Code::WrongArguments, message)
        .label(span, format!("given {found}"))
        .hint(format!("write `{name}({})`", expected.join(", ")))
}

fn plural(count: usize, word: &str) -> String {
    if count == 1 {
        word.to_string()
    } else {
        format!("{word}s")
    }
}

/// An element that the file does not have.
pub fn unknown_element(span: Span, name: &str, known: &[String]) -> Diagnostic {
    let hint = match nearest(name, known) {
        Some(near) => format!("write `{near}(…);`"),
        None => format!(
            "write `element {name}(…) {{ … }}` beside the axle, or a term: `spring`, `damper`, `inerter`, `force = …;`"
        ),
    };
    Diagnostic::error(Code::UnknownElement, format!("there is no element `{name}`"))
        .label(span, "unknown")
        .hint(hint)
}

/// An element that contains itself.
pub fn recursive_element(span: Span, chain: &[String]) -> Diagnostic {
    Diagnostic::error(
        Code::RecursiveElement,
        format!("an element contains itself: {}", chain.join(" in ")),
    )
    .label(span, "used inside itself")
    .hint("write its law out instead")
}

/// An element that no law uses.
pub fn unused_element(span: Span, name: &str) -> Diagnostic {
    Diagnostic::warning(Code::UnusedElement, format!("element `{name}` is never used"))
        .label(span, "no law contains it")
        .hint(format!("write `{name}(…);` into a link, or remove the element"))
}

/// A parameter that nothing uses.
pub fn unused_parameter(span: Span, name: &str) -> Diagnostic {
    Diagnostic::error(Code::UnusedParameter, format!("parameter `{name}` is never used"))
        .label(span, "changes nothing")
        .hint("use it in a mass, link or derived quantity, or remove the line")
}

/// A derived quantity that nothing uses.
pub fn unused_let(span: Span, name: &str) -> Diagnostic {
    Diagnostic::warning(Code::UnusedLet, format!("`{name}` is never used"))
        .label(span, "no expression uses it")
        .hint("use it, or remove the line")
}

/// A second gravity in one direction.
pub fn second_gravity(span: Span, first: Span, direction: &str) -> Diagnostic {
    Diagnostic::error(Code::SecondGravity, format!("direction {direction} has two gravities"))
        .label(span, "again here")
        .label(first, "first here")
        .hint("write one `gravity g;` for each direction that is vertical")
}

/// A force or gravity that is used like a coordinate, a link that is used like a mass, and so on.
pub fn wrong_kind(span: Span, name: &str, kind: &str, expected: &str, example: &str) -> Diagnostic {
    Diagnostic::error(Code::WrongKind, format!("`{name}` is {kind}, not {expected}"))
        .label(span, kind)
        .hint(format!("write `{example}`"))
}

/// A force input on a prescribed motion.
pub fn force_on_prescribed(span: Span, name: &str) -> Diagnostic {
    Diagnostic::error(
        Code::ForceOnPrescribed,
        format!("a force on `{name}` does nothing: its motion is prescribed"),
    )
    .label(span, "a road or motion")
    .hint("write a mass or node, such as `force f_wheel_z on wheel;`")
}

/// A quantity that the point or link does not have.
pub fn unknown_quantity(span: Span, found: &str, owner: &str, quantities: &[&str]) -> Diagnostic {
    let hint = format!(
        "write {}",
        one_of(&quantities.iter().map(|q| format!("{owner}.{q}")).collect::<Vec<_>>())
    );
    Diagnostic::error(Code::UnknownQuantity, format!("`{owner}` has no {found}"))
        .label(span, "unknown")
        .hint(hint)
}

/// A parameter whose default refers to itself, directly or through other parameters.
pub fn circular_default(span: Span, chain: &[String]) -> Diagnostic {
    Diagnostic::error(
        Code::CircularDefault,
        format!("the defaults of {} refer to each other", all_of(chain)),
    )
    .label(span, "no initial value")
    .hint("write a number as the default of one of them")
}
