//! Statements that models and laws share: derived quantities, and `if` around statements.

use super::expression::{expression, option_condition};
use super::tokens::{Parsed, Tokens};
use crate::front::syntax::{If, Let};

/// `let NAME = expression "sentence";`.
pub fn definition(tokens: &mut Tokens) -> Parsed<Let> {
    const EXAMPLE: &str = "let m_body = m_corner - m_wheel;";
    tokens.take_word("let");
    let name = tokens.new_name("the name of a derived quantity", EXAMPLE)?;
    tokens.expect("=", EXAMPLE)?;
    let value = expression(tokens)?;
    let doc = tokens.sentence();
    tokens.expect(";", EXAMPLE)?;
    Ok(Let { name, value, doc })
}

/// `if condition { … } else if condition { … } else { … }` around parts of any kind.
pub fn conditional<'a, Part>(
    tokens: &mut Tokens<'a>,
    body: &mut dyn FnMut(Tokens<'a>) -> Vec<Part>,
) -> Parsed<If<Part>> {
    const EXAMPLE: &str = "if top_mount == on { … } else { … }";
    let mut branches = Vec::new();
    let mut otherwise = Vec::new();
    loop {
        tokens.take_word("if");
        let condition = option_condition(tokens)?;
        branches.push((condition, body(tokens.block(EXAMPLE)?)));
        if !tokens.take_word("else") {
            break;
        }
        if tokens.peek().as_deref() != Some("if") {
            otherwise = body(tokens.block(EXAMPLE)?);
            break;
        }
    }
    Ok(If { branches, otherwise })
}
