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

/// Remedy for a name that is none of those known: the nearest, or all of them if none is near.
pub fn choice<'a>(name: &str, known: impl IntoIterator<Item = &'a str> + Clone) -> String {
    match nearest(name, known.clone()) {
        Some(nearest) => format!("did you mean `{nearest}`?"),
        None => format!("choose among {}", listed(known)),
    }
}

/// The same where something other than a known name is possible.
pub fn choice_or<'a>(name: &str, known: impl IntoIterator<Item = &'a str> + Clone, other: &str) -> String {
    match nearest(name, known.clone()) {
        Some(nearest) => format!("did you mean `{nearest}`? Otherwise {other}"),
        None => format!("choose among {}, or {other}", listed(known)),
    }
}

fn listed<'a>(names: impl IntoIterator<Item = &'a str>) -> String {
    let all: Vec<String> = names.into_iter().map(|own| format!("`{own}`")).collect();
    all.join(", ")
}

#[cfg(test)]
mod tests {
    use super::{choice, choice_or};

    #[test]
    fn a_misspelt_name_is_recognised() {
        let known = ["pad_to_body", "pad_to_wheel"];
        assert_eq!(choice("pad_to_bdy", known), "did you mean `pad_to_body`?");
        assert_eq!(choice("moon", known), "choose among `pad_to_body`, `pad_to_wheel`");
        assert_eq!(
            choice_or("pad_to_wheal", known, "give a path"),
            "did you mean `pad_to_wheel`? Otherwise give a path"
        );
    }
}
