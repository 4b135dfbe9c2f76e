//! Texts of a model as comments, strings and numbers of C.

/// A text as a comment on separate lines.
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

/// The text without marks that begin or end a comment, and without the links of Rust's documentation.
fn harmless(text: &str) -> String {
    let plain = text.replace("[`", "").replace("`]", "").replace('`', "");
    plain.replace("*/", "* /").replace("/*", "/ *")
}

/// A string literal, in which no question mark begins a trigraph and no backslash continues a line.
pub fn string(text: &str) -> String {
    let escaped = text.chars().map(|letter| match letter {
        '"' | '\\' | '?' => format!("\\{letter}"),
        '\n' => "\\n".into(),
        letter if letter.is_control() => " ".into(),
        letter => letter.to_string(),
    });
    format!("\"{}\"", escaped.collect::<String>())
}

/// A number with all its digits; a negative one is in parentheses, since `--` is an operator.
pub fn number(number: f64) -> String {
    match number {
        _ if number.is_nan() => "NAN".into(),
        _ if number == f64::INFINITY => "INFINITY".into(),
        _ if number == f64::NEG_INFINITY => "(-INFINITY)".into(),
        _ if number.is_sign_negative() => format!("({number:?})"),
        _ => format!("{number:?}"),
    }
}
