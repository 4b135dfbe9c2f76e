//! Statements of families, axles and directions.

use super::block::{conditional, definition};
use super::expression::{dotted, expression, option_condition};
use super::law::law;
use super::tokens::{Parsed, Tokens};
use super::unit::{declared_unit, number};
use crate::diagnostic::reading;
use crate::front::syntax::{
    Choice, Coordinate, CoordinateKind, Direction, Expression, Link, Number, Parameter, ParameterDefault, Requirement,
    Statement,
};

/// The kind of block that contains a statement.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Scope {
    /// `family { … }`
    Family,
    /// `axle { … }`
    Axle,
    /// `axle from … { … }`
    Chosen,
    /// `direction { … }`
    Direction,
}

/// The words with which a statement can begin.
const WORDS: [&str; 19] = [
    "param",
    "known",
    "clock",
    "let",
    "direction",
    "road",
    "gravity",
    "mass",
    "inertia",
    "node",
    "motion",
    "force",
    "point",
    "link",
    "output",
    "channel",
    "option",
    "require",
    "if",
];

/// The statements of a block to its end.
pub fn body(inside: Tokens, scope: Scope) -> Vec<Statement> {
    inside.each(|tokens| {
        let (span, word) = (tokens.span(), tokens.peek().unwrap_or_default());
        let statement = statement(tokens, scope)?;
        if let Some(home) = home(&statement, scope) {
            tokens.report(reading::misplaced_statement(span, &word, home));
        }
        Ok(statement)
    })
}

/// The block in which a statement belongs; `None` if it is allowed in this one.
fn home(statement: &Statement, scope: Scope) -> Option<&'static str> {
    use Statement::*;
    let (home, fits) = match statement {
        Option(_) | Require(_) => ("a `family`", scope == Scope::Family),
        Choose(..) => ("an `axle … from \"…\"`", scope == Scope::Chosen),
        Direction(_) => (
            "an `axle` or `family`, beside other directions",
            scope != Scope::Direction,
        ),
        Coordinate(_) | Gravity(_) | Force(..) | Point(..) | Link(_) => {
            ("a `direction z { … }`", scope == Scope::Direction)
        }
        Parameter(_) | Let(_) | If(_) | Output(..) | Channel(..) => ("", true),
    };
    (!fits).then_some(home)
}

/// One statement.
pub fn statement(tokens: &mut Tokens, scope: Scope) -> Parsed<Statement> {
    let word = tokens.peek();
    if is_choice(tokens) {
        return choose(tokens);
    }
    match word.as_deref() {
        Some("option") => option(tokens),
        Some("require") => require(tokens),
        Some("param" | "known" | "clock") => parameter(tokens),
        Some("let") => Ok(Statement::Let(definition(tokens)?)),
        Some("if") => Ok(Statement::If(conditional(tokens, &mut |inside| body(inside, scope))?)),
        Some("direction") => direction(tokens),
        Some("mass" | "inertia" | "node" | "road" | "motion") => coordinate(tokens),
        Some("gravity") => gravity(tokens),
        Some("force") => force(tokens),
        Some("point") => point(tokens),
        Some("link") => link(tokens),
        Some("output") => output(tokens),
        Some("channel") => channel(tokens),
        Some(word @ ("spring" | "damper" | "inerter" | "state" | "rate" | "rolling")) => {
            let home = "a `link name: a - b { … }`";
            Err(Box::new(reading::misplaced_statement(tokens.span(), word, home)))
        }
        Some(word @ ("strength" | "shape" | "shared")) => {
            let home = "an `effect name at link l { … }`";
            Err(Box::new(reading::misplaced_statement(tokens.span(), word, home)))
        }
        _ => {
            let mistake = reading::unknown_statement(tokens.span(), &tokens.found(), &WORDS);
            Err(Box::new(mistake))
        }
    }
}

/// True for `word =`, with which no other statement begins.
fn is_choice(tokens: &Tokens) -> bool {
    let mut ahead = *tokens;
    ahead.any_word().is_some() && ahead.sees("=")
}

fn choose(tokens: &mut Tokens) -> Parsed<Statement> {
    const EXAMPLE: &str = "top_mount = on;";
    let option = tokens.name("an option", EXAMPLE)?;
    tokens.expect("=", EXAMPLE)?;
    let value = tokens.name("a value of the option", EXAMPLE)?;
    tokens.expect(";", EXAMPLE)?;
    Ok(Statement::Choose(option, value))
}

fn option(tokens: &mut Tokens) -> Parsed<Statement> {
    const EXAMPLE: &str = "option top_mount: on | off = on \"what it is\";";
    tokens.take_word("option");
    let name = tokens.new_name("the name of an option", EXAMPLE)?;
    tokens.expect(":", EXAMPLE)?;
    let mut values = vec![tokens.name("a value", EXAMPLE)?];
    while tokens.take("|") {
        values.push(tokens.name("a value", EXAMPLE)?);
    }
    let default = if tokens.take("=") {
        Some(tokens.name("one of the values", EXAMPLE)?)
    } else {
        None
    };
    let doc = tokens.sentence();
    tokens.expect(";", EXAMPLE)?;
    Ok(Statement::Option(Choice {
        name,
        values,
        default,
        doc,
    }))
}

fn require(tokens: &mut Tokens) -> Parsed<Statement> {
    const EXAMPLE: &str = "require subframe == on || spring != arm \"why\";";
    let span = tokens.span();
    tokens.take_word("require");
    let condition = option_condition(tokens)?;
    let (message, _) = tokens.text("a sentence that says why", EXAMPLE)?;
    tokens.expect(";", EXAMPLE)?;
    Ok(Statement::Require(Requirement {
        span,
        condition,
        message,
    }))
}

fn parameter(tokens: &mut Tokens) -> Parsed<Statement> {
    const EXAMPLE: &str = "param k_tire: N/m = 200 N/mm in 50 N/mm..800 N/mm \"what it is\";";
    let clock = tokens.take_word("clock");
    let known = clock || tokens.take_word("known");
    if !tokens.take_word("param") {
        return tokens.expected("`param`", "known param m_corner: kg;");
    }
    let name = tokens.new_name("the name of a parameter", EXAMPLE)?;
    tokens.expect(":", EXAMPLE)?;
    let unit = declared_unit(tokens)?;
    let default = if tokens.take("=") {
        Some(parameter_default(tokens)?)
    } else {
        None
    };
    let range = if tokens.take_word("in") {
        Some(range(tokens)?)
    } else {
        None
    };
    let doc = tokens.sentence();
    tokens.expect(";", EXAMPLE)?;
    Ok(Statement::Parameter(Parameter {
        known,
        clock,
        name,
        unit,
        default,
        range,
        doc,
    }))
}

fn parameter_default(tokens: &mut Tokens) -> Parsed<ParameterDefault> {
    match tokens.any_word() {
        Some(name) => Ok(ParameterDefault::Same(name)),
        None => Ok(ParameterDefault::Number(number(tokens)?)),
    }
}

fn range(tokens: &mut Tokens) -> Parsed<(Number, Number)> {
    let low = number(tokens)?;
    tokens.expect("..", "in 50 N/mm..800 N/mm")?;
    Ok((low, number(tokens)?))
}

fn direction(tokens: &mut Tokens) -> Parsed<Statement> {
    const EXAMPLE: &str = "direction z { … }";
    tokens.take_word("direction");
    let name = tokens.new_name("the name of a direction", EXAMPLE)?;
    let inside = tokens.block(EXAMPLE)?;
    Ok(Statement::Direction(Direction {
        name,
        body: body(inside, Scope::Direction),
    }))
}

fn coordinate(tokens: &mut Tokens) -> Parsed<Statement> {
    let word = tokens.peek().unwrap_or_default();
    tokens.any_word();
    let example = match word.as_str() {
        "mass" => "mass body = m_body;",
        "inertia" => "inertia pitch = j_body;",
        "node" => "node rod;` or `node lever: angle;",
        "road" => "road pad;",
        _ => "motion rod;` or `motion theta: angle;",
    };
    let name = tokens.new_name("a name", example)?;
    let angle = angle(tokens, example)?;
    let kind = match word.as_str() {
        "mass" => CoordinateKind::Mass(inertia(tokens, example)?),
        "inertia" => CoordinateKind::Inertia(inertia(tokens, example)?),
        "node" => CoordinateKind::Node,
        "road" => CoordinateKind::Road,
        _ => CoordinateKind::Motion,
    };
    let doc = tokens.sentence();
    tokens.expect(";", example)?;
    Ok(Statement::Coordinate(Coordinate {
        angle: angle || matches!(kind, CoordinateKind::Inertia(_)),
        kind,
        name,
        doc,
    }))
}

fn angle(tokens: &mut Tokens, example: &str) -> Parsed<bool> {
    if !tokens.take(":") {
        return Ok(false);
    }
    if tokens.take_word("angle") {
        Ok(true)
    } else {
        tokens.expected("`angle`", example)
    }
}

fn inertia(tokens: &mut Tokens, example: &str) -> Parsed<Expression> {
    tokens.expect("=", example)?;
    expression(tokens)
}

fn gravity(tokens: &mut Tokens) -> Parsed<Statement> {
    tokens.take_word("gravity");
    let name = tokens.new_name("the name of the gravity input", "gravity g;")?;
    tokens.expect(";", "gravity g;")?;
    Ok(Statement::Gravity(name))
}

fn force(tokens: &mut Tokens) -> Parsed<Statement> {
    const EXAMPLE: &str = "force f_wheel_z on wheel;` or `force lift on body - wheel;";
    tokens.take_word("force");
    let name = tokens.new_name("the name of a force input", EXAMPLE)?;
    let on = if tokens.take_word("on") {
        Some(expression(tokens)?)
    } else if tokens.sees(";") {
        None
    } else {
        return tokens.expected("`on`", EXAMPLE);
    };
    tokens.expect(";", EXAMPLE)?;
    Ok(Statement::Force(name, on))
}

fn point(tokens: &mut Tokens) -> Parsed<Statement> {
    const EXAMPLE: &str = "point seat = body;` or `point nose = body + arm*pitch;";
    tokens.take_word("point");
    let name = tokens.new_name("the name of a point", EXAMPLE)?;
    tokens.expect("=", EXAMPLE)?;
    let target = expression(tokens)?;
    tokens.expect(";", EXAMPLE)?;
    Ok(Statement::Point(name, target))
}

fn link(tokens: &mut Tokens) -> Parsed<Statement> {
    const EXAMPLE: &str = "link tire: wheel - pad { spring k_tire; damper c_tire; }";
    tokens.take_word("link");
    let name = tokens.new_name("the name of a link", EXAMPLE)?;
    tokens.expect(":", EXAMPLE)?;
    let stretch = expression(tokens)?;
    let mut inside = tokens.block(EXAMPLE)?;
    let doc = inside.sentence();
    Ok(Statement::Link(Link {
        name,
        stretch,
        doc,
        body: law(inside),
    }))
}

fn output(tokens: &mut Tokens) -> Parsed<Statement> {
    const EXAMPLE: &str = "output body.acceleration;` or `output travel = damper.stretch;";
    tokens.take_word("output");
    let mut ahead = *tokens;
    let named = ahead.any_word().is_some() && ahead.sees("=");
    let name = if named {
        Some(tokens.new_name("the name of an output", EXAMPLE)?)
    } else {
        None
    };
    tokens.take("=");
    let signal = dotted(tokens, "what to see", EXAMPLE)?;
    tokens.expect(";", EXAMPLE)?;
    Ok(Statement::Output(name, signal))
}

fn channel(tokens: &mut Tokens) -> Parsed<Statement> {
    const EXAMPLE: &str = "channel pad_to_body = body.acceleration / pad.acceleration;";
    tokens.take_word("channel");
    let name = tokens.new_name("the name of a channel", EXAMPLE)?;
    tokens.expect("=", EXAMPLE)?;
    let numerator = dotted(tokens, "what to see", EXAMPLE)?;
    tokens.expect("/", EXAMPLE)?;
    let denominator = dotted(tokens, "what to compare it with", EXAMPLE)?;
    tokens.expect(";", EXAMPLE)?;
    Ok(Statement::Channel(name, numerator, denominator))
}
