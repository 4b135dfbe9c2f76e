//! Expressions and conditions. `^` binds tighter than a sign, a sign tighter than `*` and `/`.

use proc_macro2::Delimiter;

use super::tokens::{Parsed, Tokens};
use super::unit;
use crate::diagnostic::reading;
use crate::front::syntax::{
    Comparison, Dotted, Expression, ExpressionKind, List, Logic, Name, Operator, OptionTest, Order, Table,
};

/// A complete expression: what follows `=` or a word such as `spring` in a statement.
pub fn expression(tokens: &mut Tokens) -> Parsed<Expression> {
    tokens.reset_parts();
    sum(tokens)
}

fn sum(tokens: &mut Tokens) -> Parsed<Expression> {
    let operators = [("+", Operator::Add), ("-", Operator::Subtract)];
    chain(tokens, &operators, product)
}

fn product(tokens: &mut Tokens) -> Parsed<Expression> {
    let operators = [("*", Operator::Multiply), ("/", Operator::Divide)];
    chain(tokens, &operators, signed)
}

/// Operands of the same rank from left to right.
fn chain(
    tokens: &mut Tokens,
    operators: &[(&str, Operator)],
    operand: impl Fn(&mut Tokens) -> Parsed<Expression>,
) -> Parsed<Expression> {
    let mut left = operand(tokens)?;
    while let Some((_, operator)) = operators.iter().find(|(mark, _)| tokens.take(mark)) {
        tokens.count_part()?;
        let right = operand(tokens)?;
        left = binary(*operator, left, right);
    }
    Ok(left)
}

fn binary(operator: Operator, left: Expression, right: Expression) -> Expression {
    let span = left.span.join(right.span);
    Expression {
        kind: ExpressionKind::Binary(operator, Box::new(left), Box::new(right)),
        span,
    }
}

fn signed(tokens: &mut Tokens) -> Parsed<Expression> {
    let span = tokens.span();
    tokens.count_part()?;
    if tokens.take("-") {
        let operand = signed(tokens)?;
        let span = span.join(operand.span);
        return Ok(Expression {
            kind: ExpressionKind::Negative(Box::new(operand)),
            span,
        });
    }
    let base = atom(tokens)?;
    if !tokens.take("^") {
        return Ok(base);
    }
    let exponent = signed(tokens)?;
    Ok(binary(Operator::Power, base, exponent))
}

fn atom(tokens: &mut Tokens) -> Parsed<Expression> {
    let (at, span) = (*tokens, tokens.span());
    if let Some(mut inside) = tokens.group(Delimiter::Parenthesis) {
        let value = sum(&mut inside)?;
        inside.finished("(a + b)")?;
        return Ok(value);
    }
    if at.peek().as_deref() == Some("if") {
        return choice(tokens);
    }
    let mut ahead = at;
    if ahead.digits().is_some() {
        return literal(tokens);
    }
    let Some(name) = tokens.any_word() else {
        return at.expected("a value", "k*s");
    };
    match tokens.group(Delimiter::Parenthesis) {
        Some(inside) if name.text == "table" => {
            let kind = ExpressionKind::Table(Box::new(table(inside)?));
            let span = tokens.span_from(span);
            Ok(Expression { kind, span })
        }
        Some(inside) => {
            let kind = ExpressionKind::Call(name, arguments(inside)?);
            let span = tokens.span_from(span);
            Ok(Expression { kind, span })
        }
        None => {
            let dotted = dotted_from(tokens, name)?;
            let span = dotted.span();
            Ok(Expression {
                kind: ExpressionKind::Name(dotted),
                span,
            })
        }
    }
}

fn literal(tokens: &mut Tokens) -> Parsed<Expression> {
    let number = unit::number(tokens)?;
    if let Some(word) = tokens
        .peek()
        .filter(|word| !["in", "if", "else", "from", "by", "vanishes"].contains(&word.as_str()))
    {
        return Err(Box::new(reading::missing_operator(
            tokens.span(),
            &number.digits,
            &word,
        )));
    }
    let span = number.span;
    Ok(Expression {
        kind: ExpressionKind::Number(number),
        span,
    })
}

/// Expressions separated by commas.
pub fn arguments(mut inside: Tokens) -> Parsed<Vec<Expression>> {
    let mut arguments = Vec::new();
    while !inside.at_end() {
        arguments.push(sum(&mut inside)?);
        if !inside.at_end() {
            inside.expect(",", "max(a, b)")?;
        }
    }
    Ok(arguments)
}

/// `x, [x0, …], [y0, …]`
fn table(mut inside: Tokens) -> Parsed<Table> {
    const EXAMPLE: &str = "table(v, [-1 m/s, 0 m/s, 1 m/s], [-1.5 kN, 0 kN, 0.9 kN])";
    let x = sum(&mut inside)?;
    inside.expect(",", EXAMPLE)?;
    let knots = list(&mut inside, EXAMPLE)?;
    inside.expect(",", EXAMPLE)?;
    let values = list(&mut inside, EXAMPLE)?;
    inside.take(",");
    inside.finished(EXAMPLE)?;
    Ok(Table { x, knots, values })
}

fn list(tokens: &mut Tokens, example: &str) -> Parsed<List> {
    let span = tokens.span();
    let Some(mut inside) = tokens.group(Delimiter::Bracket) else {
        return tokens.expected("`[`", example);
    };
    let mut entries = Vec::new();
    while !inside.at_end() {
        entries.push(inside.entry(sum)?);
        if !inside.at_end() {
            inside.expect(",", example)?;
        }
    }
    let span = tokens.span_from(span);
    Ok(List { entries, span })
}

/// Names joined by dots.
pub fn dotted(tokens: &mut Tokens, what: &str, example: &str) -> Parsed<Dotted> {
    let first = tokens.name(what, example)?;
    dotted_from(tokens, first)
}

fn dotted_from(tokens: &mut Tokens, first: Name) -> Parsed<Dotted> {
    let mut names = vec![first];
    while tokens.take(".") {
        names.push(tokens.name("a name after the dot", "z.body")?);
    }
    Ok(Dotted { names })
}

/// `if a < b { c } else { d }`, where the last may be another `if`.
fn choice(tokens: &mut Tokens) -> Parsed<Expression> {
    const EXAMPLE: &str = "if v > 0 { c_rebound } else { c_bump }";
    let span = tokens.span();
    tokens.count_part()?;
    tokens.take_word("if");
    let condition = logic(tokens, &comparison)?;
    let mut inside = tokens.block(EXAMPLE)?;
    let then = sum(&mut inside)?;
    inside.finished(EXAMPLE)?;
    if !tokens.take_word("else") {
        return tokens.expected("`else`", EXAMPLE);
    }
    let otherwise = if tokens.peek().as_deref() == Some("if") {
        choice(tokens)?
    } else {
        last_branch(tokens, EXAMPLE)?
    };
    let span = tokens.span_from(span);
    Ok(Expression {
        kind: ExpressionKind::If(Box::new(condition), Box::new(then), Box::new(otherwise)),
        span,
    })
}

fn last_branch(tokens: &mut Tokens, example: &str) -> Parsed<Expression> {
    let mut inside = tokens.block(example)?;
    let value = sum(&mut inside)?;
    inside.finished(example)?;
    Ok(value)
}

fn comparison(tokens: &mut Tokens) -> Parsed<Comparison> {
    let left = sum(tokens)?;
    if tokens.sees("==") || tokens.sees("!=") {
        return Err(Box::new(reading::equality_of_values(tokens.span())));
    }
    let orders = [
        ("<=", Order::LessEqual),
        (">=", Order::GreaterEqual),
        ("<", Order::Less),
        (">", Order::Greater),
    ];
    let Some((_, order)) = orders.into_iter().find(|(mark, _)| tokens.take(mark)) else {
        return tokens.expected("`<`, `<=`, `>` or `>=`", "if v > 0 { a } else { b }");
    };
    Ok(Comparison {
        left,
        order,
        right: sum(tokens)?,
    })
}

/// The condition of an `if` around statements, or of a `require`.
pub fn option_condition(tokens: &mut Tokens) -> Parsed<Logic<OptionTest>> {
    tokens.reset_parts();
    logic(tokens, &option_test)
}

fn option_test(tokens: &mut Tokens) -> Parsed<OptionTest> {
    const EXAMPLE: &str = "if subframe == on { … }";
    let option = tokens.name("an option", EXAMPLE)?;
    let equal = tokens.take("==");
    if !equal {
        tokens.expect("!=", EXAMPLE)?;
    }
    Ok(OptionTest {
        option,
        equal,
        value: tokens.name("a value of the option", EXAMPLE)?,
    })
}

/// Tests joined by `||`, `&&` and `!`.
fn logic<'a, Test>(tokens: &mut Tokens<'a>, test: &dyn Fn(&mut Tokens<'a>) -> Parsed<Test>) -> Parsed<Logic<Test>> {
    let mut left = conjunction(tokens, test)?;
    while tokens.take("||") {
        left = Logic::Or(Box::new(left), Box::new(conjunction(tokens, test)?));
    }
    Ok(left)
}

fn conjunction<'a, Test>(
    tokens: &mut Tokens<'a>,
    test: &dyn Fn(&mut Tokens<'a>) -> Parsed<Test>,
) -> Parsed<Logic<Test>> {
    let mut left = negation(tokens, test)?;
    while tokens.take("&&") {
        left = Logic::And(Box::new(left), Box::new(negation(tokens, test)?));
    }
    Ok(left)
}

fn negation<'a, Test>(tokens: &mut Tokens<'a>, test: &dyn Fn(&mut Tokens<'a>) -> Parsed<Test>) -> Parsed<Logic<Test>> {
    tokens.count_part()?;
    if tokens.take("!") {
        return Ok(Logic::Not(Box::new(negation(tokens, test)?)));
    }
    // Brackets may contain a condition, or begin the left side of a comparison.
    let mut ahead = *tokens;
    match (test(tokens), ahead.group(Delimiter::Parenthesis)) {
        (Ok(single), _) => Ok(Logic::Test(single)),
        (Err(mistake), None) => Err(mistake),
        (Err(_), Some(mut inside)) => {
            let whole = logic(&mut inside, test)?;
            inside.finished("(a == b || c == d) && e == f")?;
            *tokens = ahead;
            Ok(whole)
        }
    }
}
