//! Elements of XML as text.

/// An element without content; attributes that are `None` are left out.
pub fn element(name: &str, attributes: &[(&str, String)]) -> String {
    format!("<{name}{}/>", self::attributes(attributes))
}

/// An element with its content on separate, indented lines.
pub fn around(name: &str, attributes: &[(&str, String)], content: &[String]) -> String {
    if content.is_empty() {
        return element(name, attributes);
    }
    let lines: String = content
        .iter()
        .flat_map(|part| part.lines())
        .map(|line| format!("  {line}\n"))
        .collect();
    format!("<{name}{}>\n{lines}</{name}>", self::attributes(attributes))
}

fn attributes(attributes: &[(&str, String)]) -> String {
    let given = attributes.iter().filter(|(_, value)| !value.is_empty());
    given
        .map(|(name, value)| format!(" {name}=\"{}\"", escaped(value)))
        .collect()
}

/// Text that is valid in an attribute; characters that XML cannot hold become spaces.
fn escaped(text: &str) -> String {
    let letters = text.chars().map(|letter| match letter {
        '&' => "&amp;".into(),
        '<' => "&lt;".into(),
        '>' => "&gt;".into(),
        '"' => "&quot;".into(),
        letter if letter.is_control() => " ".into(),
        letter => letter.to_string(),
    });
    letters.collect()
}
