//! Statements of laws, and elements.

use proc_macro2::Delimiter;

use super::block::{conditional, definition};
use super::expression::{arguments, expression};
use super::tokens::{Parsed, Tokens};
use super::unit::declared_unit;
use crate::diagnostic::reading;
use crate::front::syntax::{Element, ElementUse, LawStatement, Name, UnitText};

/// The words with which a statement of a law can begin.
const WORDS: [&str; 11] = [
    "spring",
    "damper",
    "inerter",
    "force",
    "state",
    "rate",
    "let",
    "active",
    "rolling",
    "if",
    "an element's name",
];

/// `(k: N/m) { … }` after the word `element` and the name.
pub fn element(tokens: &mut Tokens, name: Name) -> Parsed<Element> {
    const EXAMPLE: &str = "element maxwell(k: N/m, c: N s/m) { … }";
    let at = *tokens;
    let Some(inside) = tokens.group(Delimiter::Parenthesis) else {
        return at.expected("`(`", EXAMPLE);
    };
    let arguments = element_arguments(inside)?;
    let mut inside = tokens.block(EXAMPLE)?;
    let doc = inside.sentence();
    Ok(Element {
        name,
        arguments,
        doc,
        body: law(inside),
    })
}

fn element_arguments(mut inside: Tokens) -> Parsed<Vec<(Name, UnitText)>> {
    const EXAMPLE: &str = "(k: N/m, c: N s/m)";
    let mut arguments = Vec::new();
    while !inside.at_end() {
        let name = inside.new_name("the name of an argument", EXAMPLE)?;
        inside.expect(":", EXAMPLE)?;
        arguments.push((name, declared_unit(&mut inside)?));
        if !inside.at_end() {
            inside.expect(",", EXAMPLE)?;
        }
    }
    Ok(arguments)
}

/// The statements of a law to the end of its block.
pub fn law(inside: Tokens) -> Vec<LawStatement> {
    inside.each(law_statement)
}

fn law_statement(tokens: &mut Tokens) -> Parsed<LawStatement> {
    let span = tokens.span();
    match tokens.peek().as_deref() {
        Some("spring") => term(tokens, LawStatement::Spring, "spring k;"),
        Some("damper") => term(tokens, LawStatement::Damper, "damper c;"),
        Some("inerter") => term(tokens, LawStatement::Inerter, "inerter b;"),
        Some("force") => force(tokens),
        Some("state") => state(tokens),
        Some("rate") => rate(tokens),
        Some("let") => Ok(LawStatement::Let(definition(tokens)?)),
        Some("if") => Ok(LawStatement::If(conditional(tokens, &mut law)?)),
        Some("active") if is_alone(tokens) => {
            tokens.take_word("active");
            tokens.expect(";", "active;")?;
            Ok(LawStatement::Active)
        }
        Some("rolling") => {
            tokens.take_word("rolling");
            let inside = tokens.block("rolling { force = …; }")?;
            Ok(LawStatement::Rolling(span, law(inside)))
        }
        Some(_) => element_use(tokens),
        None => Err(Box::new(reading::unknown_statement(span, &tokens.found(), &WORDS))),
    }
}

/// True for `active;`, false for the use of an element of that name.
fn is_alone(tokens: &Tokens) -> bool {
    let mut ahead = *tokens;
    ahead.any_word().is_some() && ahead.sees(";")
}

fn term(
    tokens: &mut Tokens,
    kind: impl Fn(crate::front::syntax::Expression) -> LawStatement,
    example: &str,
) -> Parsed<LawStatement> {
    tokens.any_word();
    let value = expression(tokens)?;
    tokens.expect(";", example)?;
    Ok(kind(value))
}

fn force(tokens: &mut Tokens) -> Parsed<LawStatement> {
    const EXAMPLE: &str = "force = c*v/(1 + abs(v)/v_0);";
    tokens.take_word("force");
    tokens.expect("=", EXAMPLE)?;
    let value = expression(tokens)?;
    tokens.expect(";", EXAMPLE)?;
    Ok(LawStatement::Force(value))
}

fn state(tokens: &mut Tokens) -> Parsed<LawStatement> {
    const EXAMPLE: &str = "state f: N;";
    tokens.take_word("state");
    let name = tokens.new_name("the name of a state", EXAMPLE)?;
    tokens.expect(":", EXAMPLE)?;
    let unit = declared_unit(tokens)?;
    tokens.expect(";", EXAMPLE)?;
    Ok(LawStatement::State(name, unit))
}

fn rate(tokens: &mut Tokens) -> Parsed<LawStatement> {
    const EXAMPLE: &str = "rate f = k*v - k/c*f;";
    tokens.take_word("rate");
    let name = tokens.name("the name of a state", EXAMPLE)?;
    tokens.expect("=", EXAMPLE)?;
    let value = expression(tokens)?;
    tokens.expect(";", EXAMPLE)?;
    Ok(LawStatement::Rate(name, value))
}

fn element_use(tokens: &mut Tokens) -> Parsed<LawStatement> {
    const EXAMPLE: &str = "maxwell(k, c);";
    let (span, found) = (tokens.span(), tokens.found());
    let mut element = tokens.name("a statement of a law", EXAMPLE)?;
    let mut label = None;
    if tokens.take(":") {
        label = Some(element);
        element = tokens.name("an element", "second: maxwell(k, c);")?;
    }
    let Some(inside) = tokens.group(Delimiter::Parenthesis) else {
        return Err(Box::new(reading::unknown_statement(span, &found, &WORDS)));
    };
    tokens.reset_parts();
    let arguments = arguments(inside)?;
    tokens.expect(";", EXAMPLE)?;
    Ok(LawStatement::Use(ElementUse {
        label,
        element,
        arguments,
    }))
}
