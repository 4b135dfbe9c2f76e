//! Units and numbers with units.

use proc_macro2::Delimiter;

use super::tokens::{Parsed, Tokens};
use crate::diagnostic::reading;
use crate::diagnostic::units::unknown_unit;
use crate::front::syntax::{Name, Number, UnitFactor, UnitText};
use crate::units;

/// The unit of a declaration, such as `N s/m`, `N*s/m`, `kg m^2`, `N/(m/s)` or `1`.
pub fn declared_unit(tokens: &mut Tokens) -> Parsed<UnitText> {
    let span = tokens.span();
    let mut factors = product(tokens)?;
    factors.sort_by_key(|factor| factor.numerator < 0);
    Ok(UnitText {
        factors,
        span: tokens.span_from(span),
    })
}

fn product(tokens: &mut Tokens) -> Parsed<Vec<UnitFactor>> {
    let mut factors = power(tokens)?;
    let mut divided = false;
    loop {
        if tokens.take("/") {
            divided = true;
            factors.extend(power(tokens)?.into_iter().map(inverse));
            continue;
        }
        let at = *tokens;
        if !(tokens.take("*") || follows(tokens)) {
            return Ok(factors);
        }
        let next = power(tokens)?;
        if divided {
            let (before, after) = two_readings(&factors, &next);
            return Err(Box::new(reading::ambiguous_unit(at.span(), &before, &after)));
        }
        factors.extend(next);
    }
}

/// True if another factor follows; `in` begins a range, not a unit.
fn follows(tokens: &Tokens) -> bool {
    tokens.peek().is_some_and(|word| word != "in")
}

fn two_readings(before: &[UnitFactor], next: &[UnitFactor]) -> (String, String) {
    let spelled = |factors: &[UnitFactor]| -> Vec<String> { factors.iter().map(|f| f.symbol.text.clone()).collect() };
    let (below, above): (Vec<_>, Vec<_>) = before.iter().cloned().partition(|factor| factor.numerator < 0);
    let (above, below, next) = (
        spelled(&above).join(" "),
        spelled(&below).join(" "),
        spelled(next).join(" "),
    );
    (format!("{above} {next}/{below}"), format!("{above}/({below} {next})"))
}

fn power(tokens: &mut Tokens) -> Parsed<Vec<UnitFactor>> {
    let factors = atom(tokens)?;
    raised(tokens, factors)
}

/// The factors, raised to the power that follows, if any.
fn raised(tokens: &mut Tokens, mut factors: Vec<UnitFactor>) -> Parsed<Vec<UnitFactor>> {
    if tokens.take("^") {
        let (numerator, denominator) = exponent(tokens)?;
        for factor in &mut factors {
            factor.numerator = factor.numerator.saturating_mul(numerator);
            factor.denominator = factor.denominator.saturating_mul(denominator);
        }
        factors.retain(|factor| factor.numerator != 0);
    }
    Ok(factors)
}

fn atom(tokens: &mut Tokens) -> Parsed<Vec<UnitFactor>> {
    let at = *tokens;
    if let Some(mut inside) = tokens.group(Delimiter::Parenthesis) {
        let factors = product(&mut inside)?;
        inside.finished("N/(m/s)")?;
        return Ok(factors);
    }
    if let Some(symbol) = tokens.any_word() {
        return Ok(vec![UnitFactor {
            symbol,
            numerator: 1,
            denominator: 1,
        }]);
    }
    match tokens.digits() {
        Some((digits, _, suffix)) if digits == "1" && suffix.is_empty() => Ok(vec![]),
        _ => at.expected("a unit", "N/m` or, for a plain number, `1"),
    }
}

fn inverse(factor: UnitFactor) -> UnitFactor {
    UnitFactor {
        numerator: -factor.numerator,
        ..factor
    }
}

/// `2`, `-1` or `(3/2)`
fn exponent(tokens: &mut Tokens) -> Parsed<(i32, i32)> {
    let Some(mut inside) = tokens.group(Delimiter::Parenthesis) else {
        return Ok((whole(tokens)?, 1));
    };
    let numerator = whole(&mut inside)?;
    let denominator = if inside.take("/") { whole(&mut inside)? } else { 1 };
    inside.finished("m^(3/2)")?;
    if denominator == 0 {
        inside.expected("a number above 0", "m^(3/2)")
    } else {
        Ok((numerator, denominator))
    }
}

fn whole(tokens: &mut Tokens) -> Parsed<i32> {
    let at = *tokens;
    let sign = if tokens.take("-") { -1 } else { 1 };
    match tokens.digits() {
        Some((digits, _, suffix)) if suffix.is_empty() => match digits.parse::<i16>() {
            Ok(value) => Ok(sign * i32::from(value)),
            Err(_) => at.expected("a whole number", "m^2"),
        },
        _ => at.expected("a whole number", "m^2"),
    }
}

/// A number with the unit that follows it, if any. A unit ends before the first word that is no symbol of a unit, so `2
/// N/k` is 2 N divided by `k`. A product of units is written with spaces, since `*` continues the expression.
pub fn number(tokens: &mut Tokens) -> Parsed<Number> {
    let (at, span) = (*tokens, tokens.span());
    let negative = tokens.take("-");
    let Some((digits, value, suffix)) = tokens.digits() else {
        return at.expected("a number", "25 N/mm");
    };
    if !value.is_finite() {
        return Err(Box::new(reading::number_too_large(span)));
    }
    let unit = unit_of_number(tokens, Name { text: suffix, span })?;
    let sign = if negative { "-" } else { "" };
    let span = tokens.span_from(span);
    Ok(Number {
        digits: format!("{sign}{digits}"),
        value: if negative { -value } else { value },
        unit,
        span,
    })
}

fn unit_of_number(tokens: &mut Tokens, suffix: Name) -> Parsed<UnitText> {
    let mut factors = Vec::new();
    let span = if suffix.text.is_empty() {
        tokens.span()
    } else {
        suffix.span
    };
    if !suffix.text.is_empty() {
        if units::symbol(&suffix.text).is_none() {
            return Err(Box::new(unknown_unit(suffix.span, &suffix.text)));
        }
        factors = raised(
            tokens,
            vec![UnitFactor {
                symbol: suffix,
                numerator: 1,
                denominator: 1,
            }],
        )?;
    }
    while is_symbol(tokens) {
        factors.extend(power(tokens)?);
    }
    while !factors.is_empty() && divides_by_unit(tokens) {
        tokens.take("/");
        factors.extend(power(tokens)?.into_iter().map(inverse));
    }
    factors.sort_by_key(|factor| factor.numerator < 0);
    Ok(UnitText { factors, span })
}

fn is_symbol(tokens: &Tokens) -> bool {
    tokens.peek().is_some_and(|word| units::symbol(&word).is_some())
}

/// `/mm`, or `/(m s)` with several symbols in the brackets.
fn divides_by_unit(tokens: &Tokens) -> bool {
    let mut ahead = *tokens;
    if !ahead.take("/") {
        return false;
    }
    let Some(mut inside) = ahead.group(Delimiter::Parenthesis) else {
        return is_symbol(&ahead);
    };
    let factors = product(&mut inside).unwrap_or_default();
    let all_units = factors
        .iter()
        .all(|factor| units::symbol(&factor.symbol.text).is_some());
    factors.len() > 1 && all_units && inside.at_end()
}
