//! Texts of a model where C expects a comment, a string or a number.

/// A text as a comment of its own lines.
pub fn comment(text: &str) -> String {
    let text = harmless(text);
    let mut lines = text.lines().map(str::trim_end);
    let first = lines.next().unwrap_or_default();
    let rest: String = lines
        .map(|line| format!("\n * {line}").trim_end().to_string())
        .collect();
    let end = if rest.is_empty() { " */" } else { "\n */" };
    format!("/* {first}{rest}{end}\n")
}

/// A text after a statement, on its line.
pub fn remark(text: &str) -> String {
    match text {
        "" => String::new(),
        _ => format!(" /* {} */", harmless(text).replace('\n', " ")),
    }
}

/// Nothing in it begins or ends a comment, and nothing of it is a link of Rust's documentation.
fn harmless(text: &str) -> String {
    let plain = text.replace("[`", "").replace("`]", "").replace('`', "");
    plain.replace("*/", "* /").replace("/*", "/ *")
}

/// A string; a question mark cannot begin a trigraph, and no line is continued.
pub fn string(text: &str) -> String {
    let escaped = text.chars().map(|letter| match letter {
        '"' | '\\' | '?' => format!("\\{letter}"),
        '\n' => "\\n".into(),
        letter if letter.is_control() => " ".into(),
        letter => letter.to_string(),
    });
    format!("\"{}\"", escaped.collect::<String>())
}

/// A number, to every digit; a negative one in parentheses, since `--` is an operator.
pub fn number(number: f64) -> String {
    match number {
        _ if number.is_nan() => "NAN".into(),
        _ if number == f64::INFINITY => "INFINITY".into(),
        _ if number == f64::NEG_INFINITY => "(-INFINITY)".into(),
        _ if number.is_sign_negative() => format!("({number:?})"),
        _ => format!("{number:?}"),
    }
}
