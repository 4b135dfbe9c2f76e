//! Mistakes of the text itself: characters, brackets, statements.

use super::{Code, Diagnostic, all_of, nearest, one_of};
use crate::source::Span;

/// A line with characters that the language does not know, and the line to write instead.
pub fn foreign_characters(found: &[(Span, char)], line: &str) -> Diagnostic {
    let characters: Vec<String> = found.iter().map(|(_, character)| character.to_string()).collect();
    let message = format!(
        "the language does not know {} outside of sentences",
        all_of(&characters)
    );
    let diagnostic = Diagnostic::error(Code::ForeignCharacter, message).hint(format!("write `{}`", line.trim()));
    found.iter().fold(diagnostic, |diagnostic, (span, _)| {
        diagnostic.label(*span, "not a part of the language")
    })
}

/// A sentence that does not end on its line.
pub fn unterminated_text(span: Span, line: &str) -> Diagnostic {
    Diagnostic::error(Code::UnterminatedText, "a sentence does not end on its line")
        .label(span, "begins here")
        .hint(format!("write `{}\"` and end the statement", line.trim_end()))
}

/// An opening bracket without its closing one.
pub fn unclosed_bracket(span: Span, open: char, close: char) -> Diagnostic {
    Diagnostic::error(Code::UnclosedBracket, format!("`{open}` is never closed"))
        .label(span, "opens here")
        .hint(format!("write `{close}` where it ends"))
}

/// A comment without its closing mark.
pub fn unclosed_comment(span: Span) -> Diagnostic {
    Diagnostic::error(Code::UnclosedComment, "a comment is never closed")
        .label(span, "begins here")
        .hint("write `*/` where it ends, or `//` for a comment of one line")
}

/// A closing bracket without its opening one, or of another kind than the open one.
pub fn stray_bracket(span: Span, found: char, open: Option<(Span, char)>) -> Diagnostic {
    let diagnostic = Diagnostic::error(Code::StrayBracket, format!("`{found}` closes nothing"));
    match open {
        Some((place, expected)) => diagnostic
            .label(span, format!("expected `{expected}`"))
            .label(place, "to close this one")
            .hint(format!("write `{expected}` here, or remove `{found}`")),
        None => diagnostic
            .label(span, "no bracket is open here")
            .hint(format!("remove `{found}`")),
    }
}

/// Brackets or expressions that are nested too deeply, or too long.
pub fn nested_too_deep(span: Span) -> Diagnostic {
    Diagnostic::error(
        Code::NestedTooDeep,
        "this is nested too deeply, or too long, to be read",
    )
    .label(span, "beyond the limit")
    .hint("write parts of it as `let part = …;`")
}

/// What the lexer refuses for any other reason.
pub fn unreadable(span: Span, reason: &str) -> Diagnostic {
    Diagnostic::error(Code::Unreadable, format!("this cannot be read: {reason}"))
        .label(span, "near here")
        .hint("write sentences without `\\`, and numbers like `25.4` or `50e3`")
}

/// A number beyond what fits into 64 bits of floating point.
pub fn number_too_large(span: Span) -> Diagnostic {
    Diagnostic::error(Code::NumberTooLarge, "this number is too large")
        .label(span, "not finite")
        .hint("write a number below 1e308")
}

/// A number with more digits than a 64-bit number needs.
pub fn number_too_long(span: Span, digits: usize) -> Diagnostic {
    Diagnostic::error(Code::NumberTooLarge, format!("this number has {digits} digits"))
        .label(span, "beyond the limit")
        .hint("write it with an exponent, such as 25.4e3")
}

/// A token that the grammar does not allow at this place.
pub fn expected(span: Span, expected: &str, found: &str, example: &str) -> Diagnostic {
    Diagnostic::error(Code::Expected, format!("expected {expected}, found {found}"))
        .label(span, format!("expected {expected}"))
        .hint(format!("write `{example}`"))
}

/// Two values side by side, as in `2 k`.
pub fn missing_operator(span: Span, left: &str, right: &str) -> Diagnostic {
    Diagnostic::error(
        Code::MissingOperator,
        format!("there is no operator between `{left}` and `{right}`"),
    )
    .label(span, "an operator, or a unit after a number, is expected here")
    .hint(format!("write `{left}*{right}` for a product"))
}

/// A comparison of options inside a law, or of values by `==`.
pub fn equality_of_values(span: Span) -> Diagnostic {
    Diagnostic::error(Code::EqualityOfValues, "varying values are never exactly equal")
        .label(span, "a law compares with `<`, `<=`, `>` or `>=`")
        .hint("write `if abs(a - b) < tolerance { … } else { … }`; options are compared by an `if` around statements")
}

/// `N/m s`, which can be read in two ways.
pub fn ambiguous_unit(span: Span, before: &str, after: &str) -> Diagnostic {
    Diagnostic::error(
        Code::AmbiguousUnit,
        "a product after `/` in a unit can be read in two ways",
    )
    .label(span, "numerator or denominator?")
    .hint(format!("write `{before}` or `{after}`"))
}

/// A statement that begins with an unknown word.
pub fn unknown_statement(span: Span, found: &str, known: &[&str]) -> Diagnostic {
    let word = found.trim_matches('`');
    let hint = match nearest(word, known) {
        // The lexer turns `///` and `//!` into attributes, which begin with `#`.
        _ if word == "#" => "write a comment as `// …`".to_string(),
        Some(near) => format!("write `{near} …`"),
        None => format!("write a statement that begins with {}", one_of(known)),
    };
    Diagnostic::error(Code::UnknownStatement, format!("no statement begins with {found}"))
        .label(span, "not a statement")
        .hint(hint)
}

/// A statement in the wrong kind of block.
pub fn misplaced_statement(span: Span, word: &str, home: &str) -> Diagnostic {
    Diagnostic::error(Code::MisplacedStatement, format!("`{word}` does not belong here"))
        .label(span, format!("belongs in {home}"))
        .hint(format!("write it in {home}"))
}

/// A patch where a model is expected.
pub fn effect_is_no_model(span: Span) -> Diagnostic {
    Diagnostic::error(Code::EffectIsNoModel, "effects are files of models/effects, not models")
        .label(span, "this is an effect, not a model")
        .hint("write `axle name { … }`, and keep effects in files of their own")
}

/// A name that Rust, the language or a unit reserves.
pub fn reserved_name(span: Span, name: &str, owner: &str) -> Diagnostic {
    Diagnostic::error(
        Code::ReservedName,
        format!("`{name}` cannot be used as a name: it is {owner}"),
    )
    .label(span, "taken")
    .hint(format!("write another name, such as `{name}_1`"))
}

/// A name that is not in lower case.
pub fn name_not_lower_case(span: Span, name: &str) -> Diagnostic {
    Diagnostic::error(Code::NameNotLowerCase, format!("`{name}` is not written in lower case"))
        .label(span, "names are lower-case letters, digits and `_`")
        .hint(format!("write `{}`", name.to_lowercase()))
}

/// A file without a model, or with more than one.
pub fn not_one_model(span: Span, found: usize) -> Diagnostic {
    let message = match found {
        0 => "this file contains no model".to_string(),
        _ => format!("this file contains {found} models"),
    };
    Diagnostic::error(Code::NotOneModel, message)
        .label(span, "one `axle` or `family` per file")
        .hint("write one `axle name { … }` in a file of its own; elements may stand beside it")
}
