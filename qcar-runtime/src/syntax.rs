//! Errors of the readers of TOML and JSON in the words of this program: what was found, what was expected, the remedy.

use std::path::Path;

use crate::error::{Place, Problem};
use crate::spelling;

/// Most characters of a line that a message quotes.
const MOST: usize = 60;

/// The problem of a text that is no TOML, or that has other keys or values than a reader expects; `else_do` is the remedy
/// where the message of the reader suggests none.
pub fn of_toml(file: &Path, text: &str, error: &toml::de::Error, else_do: &str) -> Problem {
    let start = error.span().map_or(0, |span| span.start);
    let place = Place::in_text(text, start, "");
    let line = &text[text[..start.min(text.len())].rfind('\n').map_or(0, |end| end + 1)..];
    let line = line.lines().next().unwrap_or_default();
    if let Some(number) = decimal_comma(line) {
        let point = number.replace(',', ".");
        let (found, expected) = (format!("`{number}`"), format!("a number such as {point}"));
        return Problem::new(file, place, found, expected, "write a decimal point");
    }
    let (what, expected) = words(error.message());
    let expected = expected.unwrap_or_else(|| "TOML, such as `name = value` or `[table]`".into());
    let remedy = remedy(&what, &expected).unwrap_or_else(|| else_do.into());
    Problem::new(file, place, quoted(line, &what), expected, remedy)
}

/// The problem of a text that is no JSON.
pub fn of_json(file: &Path, text: &str, error: &serde_json::Error, remedy: &str) -> Problem {
    let place = Place::Key(error.line(), error.column(), String::new());
    let line = text.lines().nth(error.line().saturating_sub(1)).unwrap_or_default();
    let message = error.to_string();
    let message = message.split(" at line ").next().unwrap_or_default();
    let (what, expected) = match message.strip_prefix("expected ") {
        Some(expected) => (String::new(), format!("JSON: {expected}")),
        None => (message.to_string(), "JSON".to_string()),
    };
    Problem::new(file, place, quoted(line, &what), expected, remedy)
}

/// What a message of a reader calls wrong, and what it calls right if it does.
pub fn words(message: &str) -> (String, Option<String>) {
    let message = message.lines().collect::<Vec<_>>().join(" ");
    if let Some(key) = message.strip_prefix("missing field ") {
        return (format!("no {key}"), Some(format!("the key {key}")));
    }
    let message = message.replace("unknown field ", "the unknown key ");
    match message.split_once(", expected ") {
        Some(("string values must be quoted", _)) => ("a text without quotes".into(), Some("a text in quotes".into())),
        Some((what, "nothing")) => (what.into(), Some("nothing more on this line".into())),
        Some((what, "newline, `#`")) => (what.into(), Some("the end of the line, or a comment after `#`".into())),
        Some((what, expected)) => (what.into(), Some(expected.into())),
        None => (message, None),
    }
}

/// A line, cut where it is long, with what is wrong in it.
fn quoted(line: &str, what: &str) -> String {
    let line = line.trim();
    let cut: String = line.chars().take(MOST).collect();
    let dots = if cut.len() < line.len() { "…" } else { "" };
    match (line, what) {
        ("", "") => "the end of the text".into(),
        ("", what) => what.into(),
        (_, "") => format!("`{cut}{dots}`"),
        // The line of a missing key is not where it is missing.
        (_, what) if what.starts_with("no `") => what.into(),
        (_, what) => format!("{what} in `{cut}{dots}`"),
    }
}

/// `expected` names the known keys in backticks where `what` is an unknown one.
fn remedy(what: &str, expected: &str) -> Option<String> {
    if let Some(key) = what.strip_prefix("the unknown key ") {
        let known = expected.split('`').skip(1).step_by(2);
        return Some(spelling::remedy(key.trim_matches('`'), known));
    }
    let known = [
        ("unclosed", "close it on this line"),
        ("duplicate key", "rename or remove one of the two"),
        ("without quotes", "put the text in quotes"),
    ];
    let own = known.into_iter().find(|(words, _)| what.contains(words));
    own.map(|(_, remedy)| remedy.into())
}

/// The first number with a decimal comma that is the value of a line, such as `3,5` of `k = 3,5`.
fn decimal_comma(line: &str) -> Option<&str> {
    let value = line.split('#').next()?.split_once('=')?.1.trim();
    let (whole, decimals) = value.split_once(',')?;
    let digits = |text: &str| !text.is_empty() && text.bytes().all(|byte| byte.is_ascii_digit());
    let whole = whole.strip_prefix(['-', '+']).unwrap_or(whole);
    let end = decimals.find(['e', 'E']).unwrap_or(decimals.len());
    (digits(whole) && digits(&decimals[..end])).then_some(value)
}
