//! Effects: patches of models.

use super::expression::{dotted, expression};
use super::law::law;
use super::statement::{Scope, statement};
use super::tokens::{Parsed, Tokens};
use super::unit::declared_unit;
use crate::diagnostic::reading;
use crate::front::syntax::{
    Change, Effect, EffectParameter, Form, LawStatement, Name, Pattern, PlaceKind, Role, VanishesAt,
};

const HEAD: &str = "effect name at link l named damper { … }";

/// The words with which a statement of an effect can begin.
const WORDS: [&str; 23] = [
    "param",
    "strength",
    "shape",
    "clock",
    "known",
    "shared",
    "source",
    "shows",
    "nuisance",
    "form",
    "let",
    "take",
    "add",
    "replace",
    "remove",
    "direction",
    "delay",
    "scale",
    "sensor",
    "mass",
    "inertia",
    "node",
    "link",
];

/// Parses an effect after the word `effect`.
pub fn effect(tokens: &mut Tokens) -> Parsed<Effect> {
    let name = tokens.new_name("the name of an effect", HEAD)?;
    let pattern = pattern(tokens)?;
    let mut inside = tokens.block(HEAD)?;
    let mut effect = Effect {
        name,
        pattern,
        doc: inside.sentence(),
        source: String::new(),
        shows: String::new(),
        nuisance: false,
        body: vec![],
        forms: vec![],
    };
    let changes = inside.each(|tokens| match tokens.peek().as_deref() {
        Some("source") => sentence(tokens, &mut effect.source, "source \"Author: Title, year\";"),
        Some("shows") => sentence(tokens, &mut effect.shows, "shows \"how it shows in measurements\";"),
        Some("nuisance") => {
            tokens.any_word();
            effect.nuisance = true;
            tokens.expect(";", "nuisance;").map(|()| None)
        }
        Some("form") => form(tokens).map(|form| {
            effect.forms.push(form);
            None
        }),
        _ => change(tokens).map(Some),
    });
    effect.body = changes.into_iter().flatten().collect();
    Ok(effect)
}

fn form(tokens: &mut Tokens) -> Parsed<Form> {
    const EXAMPLE: &str = "form across_strut { \"what it acts on\" … }";
    tokens.any_word();
    let name = tokens.new_name("the name of a form", EXAMPLE)?;
    let role = match tokens.peek().as_deref() {
        Some("role") => Some(after(tokens, "a role", "form attached role part { … }")?),
        _ => None,
    };
    let terms = match tokens.peek().as_deref() {
        Some("with") => terms(tokens)?,
        _ => vec![],
    };
    let mut inside = tokens.block(EXAMPLE)?;
    let doc = inside.sentence();
    let body = inside.each(change);
    Ok(Form {
        name,
        doc,
        role,
        terms,
        body,
    })
}

/// A sentence after its word.
fn sentence(tokens: &mut Tokens, into: &mut String, example: &str) -> Parsed<Option<Change>> {
    tokens.any_word();
    (*into, _) = tokens.text("a sentence", example)?;
    tokens.expect(";", example)?;
    Ok(None)
}

fn pattern(tokens: &mut Tokens) -> Parsed<Pattern> {
    word(tokens, "at", HEAD)?;
    let Some(kind) = PlaceKind::ALL.into_iter().find(|kind| tokens.take_word(kind.word())) else {
        return tokens.expected("`link`, `mass` or `sensor`", HEAD);
    };
    let mut pattern = Pattern {
        kind,
        variable: tokens.new_name("what the effect calls its place", HEAD)?,
        direction: None,
        names: vec![],
        roles: vec![],
        on: None,
        terms: vec![],
        given: vec![],
        seen_from: None,
    };
    loop {
        match tokens.peek().as_deref() {
            Some("in") => pattern.direction = Some(after(tokens, "a direction", "at mass m in z")?),
            Some("named") => {
                pattern.names = called(tokens, "the name of a place", "named body | sf as subframe")?;
            }
            Some("role") => pattern.roles = called(tokens, "a role", "role body | pivot as subframe")?,
            Some("on") => pattern.on = Some(after(tokens, "a point", "at link l role suspension on body")?),
            Some("with") => pattern.terms = terms(tokens)?,
            Some("given") => pattern.given = list(tokens, "a parameter or point", "given m_corner, pivot")?,
            Some("seen") => {
                tokens.any_word();
                pattern.seen_from = Some(seen_from(tokens)?);
            }
            _ => return Ok(pattern),
        }
    }
}

fn seen_from(tokens: &mut Tokens) -> Parsed<Name> {
    const EXAMPLE: &str = "at link l named damper seen from wheel";
    if tokens.peek().as_deref() != Some("from") {
        return tokens.expected("`from`", EXAMPLE);
    }
    after(tokens, "a point", EXAMPLE)
}

/// The name after the next word.
fn after(tokens: &mut Tokens, what: &str, example: &str) -> Parsed<Name> {
    tokens.any_word();
    tokens.name(what, example)
}

fn word(tokens: &mut Tokens, word: &str, example: &str) -> Parsed<()> {
    if tokens.take_word(word) {
        Ok(())
    } else {
        tokens.expected(&format!("`{word}`"), example)
    }
}

/// Names after the next word, with commas between.
fn list(tokens: &mut Tokens, what: &str, example: &str) -> Parsed<Vec<Name>> {
    let mut names = vec![after(tokens, what, example)?];
    while tokens.take(",") {
        names.push(tokens.name(what, example)?);
    }
    Ok(names)
}

fn terms(tokens: &mut Tokens) -> Parsed<Vec<Name>> {
    list(
        tokens,
        "`spring`, `damper`, `inerter`, `damping` or `law`",
        "with spring, damper",
    )
}

/// `named body | sf as subframe`
fn called(tokens: &mut Tokens, what: &str, example: &str) -> Parsed<Vec<(Name, Option<Name>)>> {
    tokens.any_word();
    let mut names = Vec::new();
    loop {
        let name = tokens.name(what, example)?;
        let called = match tokens.peek().as_deref() {
            Some("as") => Some(after(tokens, "what the catalogue calls it", example)?),
            _ => None,
        };
        names.push((name, called));
        if !tokens.take("|") {
            return Ok(names);
        }
    }
}

fn change(tokens: &mut Tokens) -> Parsed<Change> {
    match tokens.peek().as_deref() {
        Some("param" | "strength" | "shape" | "clock" | "known" | "shared") => {
            Ok(Change::Parameter(parameter(tokens)?))
        }
        Some("take") => take(tokens),
        Some("add") => add(tokens),
        Some("replace") => replace(tokens),
        Some("remove") => remove(tokens),
        Some("direction") => direction(tokens),
        Some("delay") => sensed(tokens, "delay m by delay;", Change::Delay),
        Some("sensor") => sensor(tokens),
        Some("scale") => sensed(tokens, "scale m by gain;", Change::Scale),
        Some("let" | "mass" | "inertia" | "node" | "point" | "link" | "output" | "channel") => declaration(tokens),
        _ => Err(Box::new(reading::unknown_statement(
            tokens.span(),
            &tokens.found(),
            &WORDS,
        ))),
    }
}

fn declaration(tokens: &mut Tokens) -> Parsed<Change> {
    Ok(Change::Declare(statement(tokens, Scope::Direction)?))
}

fn parameter(tokens: &mut Tokens) -> Parsed<EffectParameter> {
    const EXAMPLE: &str = "param k: N/m = 0.5*l.spring in 0.1*l.spring..2*l.spring \"what it is\";";
    let (strength, shape) = (tokens.take_word("strength"), tokens.take_word("shape"));
    let clock = !strength && !shape && tokens.take_word("clock");
    // A strength cannot be known, since it is what a search estimates. Time is always known.
    let (shared, known) = (tokens.take_word("shared"), !strength && tokens.take_word("known"));
    let known = known || clock;
    word(tokens, "param", EXAMPLE)?;
    let name = tokens.new_name("the name of a parameter", EXAMPLE)?;
    tokens.expect(":", EXAMPLE)?;
    let unit = declared_unit(tokens)?;
    tokens.expect("=", EXAMPLE)?;
    let start = expression(tokens)?;
    word(tokens, "in", EXAMPLE)?;
    let low = expression(tokens)?;
    tokens.expect("..", EXAMPLE)?;
    let high = expression(tokens)?;
    let role = match (strength, shape, clock) {
        (true, ..) => Role::Strength(vanishes_at(tokens)?),
        (_, true, _) => Role::Shape,
        (.., true) => Role::Clock,
        _ => Role::Other,
    };
    let (doc, _) = tokens.text("a sentence that says what it is", EXAMPLE)?;
    tokens.expect(";", EXAMPLE)?;
    Ok(EffectParameter {
        shared,
        known,
        role,
        name,
        unit,
        start,
        range: (low, high),
        doc,
    })
}

/// `vanishes at infinity`, or nothing for a strength that vanishes at 0.
fn vanishes_at(tokens: &mut Tokens) -> Parsed<VanishesAt> {
    const EXAMPLE: &str = "strength param k: N/m = 500 N/mm in 10 N/mm..20 kN/mm vanishes at infinity \"what it is\";";
    if !tokens.take_word("vanishes") {
        return Ok(VanishesAt::Zero);
    }
    word(tokens, "at", EXAMPLE)?;
    if tokens.take_word("infinity") {
        return Ok(VanishesAt::Infinity);
    }
    expression(tokens).map(VanishesAt::Value)
}

fn take(tokens: &mut Tokens) -> Parsed<Change> {
    const EXAMPLE: &str = "take m_tm from body;";
    tokens.any_word();
    let part = expression(tokens)?;
    word(tokens, "from", EXAMPLE)?;
    let mass = dotted(tokens, "a mass", EXAMPLE)?;
    tokens.expect(";", EXAMPLE)?;
    Ok(Change::Take(part, mass))
}

fn add(tokens: &mut Tokens) -> Parsed<Change> {
    const EXAMPLE: &str = "add to l { force = …; }";
    tokens.any_word();
    word(tokens, "to", EXAMPLE)?;
    let link = tokens.name("a link", EXAMPLE)?;
    Ok(Change::Add(link, law_block(tokens, EXAMPLE)?))
}

fn law_block(tokens: &mut Tokens, example: &str) -> Parsed<Vec<LawStatement>> {
    Ok(law(tokens.block(example)?))
}

fn replace(tokens: &mut Tokens) -> Parsed<Change> {
    const TERM: &str = "replace damper of l { force = …; }";
    const POINT: &str = "replace l.upper of l by tm;";
    tokens.any_word();
    let what = dotted(tokens, "a kind of term, or a point", TERM)?;
    let of = if tokens.take_word("of") {
        Some(tokens.name("a link", TERM)?)
    } else {
        None
    };
    if tokens.take_word("by") {
        let by = expression(tokens)?;
        let rolling = if tokens.take_word("rolling") {
            Some(expression(tokens)?)
        } else {
            None
        };
        tokens.expect(";", POINT)?;
        return Ok(match of {
            Some(of) if what.to_string() == "s" => Change::ReplaceStretch { of, by, rolling },
            of => Change::ReplacePoint { point: what, of, by },
        });
    }
    match (what.names.as_slice(), of) {
        ([term], Some(link)) => Ok(Change::ReplaceTerm(term.clone(), link, law_block(tokens, TERM)?)),
        _ => tokens.expected("`by`", POINT),
    }
}

fn remove(tokens: &mut Tokens) -> Parsed<Change> {
    const EXAMPLE: &str = "remove subframe_mount;";
    let link = after(tokens, "a link", EXAMPLE)?;
    tokens.expect(";", EXAMPLE)?;
    Ok(Change::Remove(link))
}

fn direction(tokens: &mut Tokens) -> Parsed<Change> {
    const EXAMPLE: &str = "direction x without sf { … }";
    let name = after(tokens, "a direction", EXAMPLE)?;
    let without = match tokens.peek().as_deref() {
        Some("without") => list(tokens, "a point", EXAMPLE)?,
        _ => vec![],
    };
    let body = tokens.block(EXAMPLE)?.each(change);
    Ok(Change::Direction { name, without, body })
}

fn sensor(tokens: &mut Tokens) -> Parsed<Change> {
    const EXAMPLE: &str = "sensor front of l.lower at l.lower + arm*pitch;";
    tokens.any_word();
    let end = match tokens.peek().as_deref() {
        Some("front" | "rear") => Some(tokens.name("an end", EXAMPLE)?),
        Some("of") => None,
        _ => return tokens.expected("`front`, `rear` or `of`", EXAMPLE),
    };
    word(tokens, "of", EXAMPLE)?;
    let of = dotted(tokens, "a mass", EXAMPLE)?;
    word(tokens, "at", EXAMPLE)?;
    let at = expression(tokens)?;
    tokens.expect(";", EXAMPLE)?;
    Ok(Change::PlaceSensor { end, of, at })
}

fn sensed(tokens: &mut Tokens, example: &str, kind: fn(Name, Name) -> Change) -> Parsed<Change> {
    let place = after(tokens, "a place", example)?;
    word(tokens, "by", example)?;
    let parameter = tokens.name("a parameter", example)?;
    tokens.expect(";", example)?;
    Ok(kind(place, parameter))
}
