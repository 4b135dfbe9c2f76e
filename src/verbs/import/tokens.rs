//! Words of a channel name: `FL_Body_Acc_Z`, `bodyAccZ_left` and `Beschl. Aufbau VL z` have the same meaning.

/// The words of a name in lower case. They are separated by any other character than letters and digits, and before a
/// capital letter after a small letter or digit.
pub(super) fn words(name: &str) -> Vec<String> {
    let (mut words, mut before) = (vec![String::new()], None);
    for c in name.chars() {
        let new = !c.is_alphanumeric()
            || (c.is_uppercase() && before.is_some_and(|b: char| b.is_lowercase() || b.is_numeric()));
        if new {
            words.push(String::new());
        }
        if c.is_alphanumeric() {
            words.last_mut().expect("one was put there").extend(c.to_lowercase());
        }
        before = Some(c);
    }
    words.retain(|word| !word.is_empty());
    words
}

/// The meaning of the first word that has one in a list of words and meanings.
pub(super) fn meaning<T: Clone>(words: &[String], list: &[(&[&str], T)]) -> Option<T> {
    let of = |word: &String| {
        list.iter()
            .find(|(known, _)| known.contains(&word.as_str()))
            .map(|(_, own)| own.clone())
    };
    words.iter().find_map(of)
}

#[cfg(test)]
mod tests {
    use super::words;

    #[test]
    fn names_fall_into_words() {
        for (name, expected) in [
            ("FL_Body_Acc_Z", "fl body acc z"),
            ("bodyAccZ", "body acc z"),
            ("Aufbau VL z", "aufbau vl z"),
            ("pad.left-z", "pad left z"),
        ] {
            assert_eq!(words(name).join(" "), expected);
        }
    }
}
