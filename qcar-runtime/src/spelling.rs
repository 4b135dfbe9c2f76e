//! The form of names, and the known name nearest to an unknown one.

use strsim::levenshtein;

/// True if a text can be a name in model files and campaigns: lower-case letters, digits and `_`, a letter first.
pub fn is_name(text: &str) -> bool {
    let is_plain = |c: char| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '_';
    text.starts_with(|c: char| c.is_ascii_lowercase()) && text.chars().all(is_plain)
}

/// The known name that differs from `name` in the fewest letters, if that is at most a third of its letters; names of
/// one or two letters would resemble everything.
pub fn nearest<'a>(name: &str, known: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    let (distance, nearest) = known.into_iter().map(|other| (levenshtein(name, other), other)).min()?;
    (3 * distance <= name.chars().count()).then_some(nearest)
}

/// Remedy for an unknown key.
pub fn remedy<'a>(name: &str, known: impl IntoIterator<Item = &'a str>) -> String {
    match nearest(name, known) {
        Some(nearest) => format!("did you mean `{nearest}`? Otherwise remove it"),
        None => "correct its name or remove it".into(),
    }
}
