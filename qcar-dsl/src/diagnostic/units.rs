//! Mistakes of units, stretches and laws.

use super::{Code, Diagnostic};
use crate::source::Span;

/// A symbol that is no unit.
pub fn unknown_unit(span: Span, symbol: &str) -> Diagnostic {
    Diagnostic::error(Code::UnknownUnit, format!("`{symbol}` is no unit"))
        .label(span, "unknown")
        .hint("write a unit of kg, m, s, N, rad and what follows from them, such as `N/m`, `N s/m`, `kg m^2`, or `1`")
}

/// A declaration in a unit that is not coherent with kg, m and s.
pub fn not_coherent(span: Span, unit: &str, coherent: &str, example: &str) -> Diagnostic {
    Diagnostic::error(
        Code::NotCoherent,
        format!("values are stored in SI: `{unit}` cannot be a declared unit"),
    )
    .label(span, format!("declare it in `{coherent}`"))
    .hint(format!("write `{example}`; a value may have any unit of its kind"))
}

/// An exponent of a unit that is no multiple of 1/6.
pub fn odd_exponent(span: Span, what: &str) -> Diagnostic {
    Diagnostic::error(
        Code::OddExponent,
        format!("the unit of {what} has an exponent that is no multiple of 1/6"),
    )
    .label(span, "here")
    .hint("write whole powers, square roots or cube roots of quantities, or divide by a reference value first")
}

/// Summands, branches or sides of different units.
pub fn units_differ(left: (Span, String), right: (Span, String), what: &str) -> Diagnostic {
    let message = format!("{what} of different units: {} and {}", left.1, right.1);
    Diagnostic::error(Code::UnitsDiffer, message)
        .label(right.0, format!("this is in {}", right.1))
        .label(left.0, format!("this is in {}", left.1))
        .hint("write both in the same unit: a factor or a unit, as in `40 mm`, may be missing or superfluous")
}

/// A quantity in a unit other than the required one.
pub fn wrong_unit(span: Span, what: &str, expected: &str, found: &str) -> Diagnostic {
    Diagnostic::error(Code::WrongUnit, format!("{what} is in {expected}, not in {found}"))
        .label(span, format!("this is in {found}"))
        .hint(format!("write an expression in {expected}"))
}

/// A function, such as `exp`, of a quantity with a unit.
pub fn argument_has_unit(span: Span, function: &str, unit: &str) -> Diagnostic {
    Diagnostic::error(
        Code::ArgumentHasUnit,
        format!("`{function}` takes a dimensionless number, not {unit}"),
    )
    .label(span, format!("this is in {unit}"))
    .hint(format!("write `{function}(x/x_ref)` with a reference value in {unit}"))
}

/// A quantity with a unit, raised to an exponent that is not a constant.
pub fn exponent_not_constant(span: Span, unit: &str) -> Diagnostic {
    Diagnostic::error(
        Code::ExponentNotConstant,
        format!("a quantity in {unit} can only be raised to a constant number"),
    )
    .label(span, "its unit would depend on a value")
    .hint("write `(x/x_ref)^n` with a reference value, or a number as exponent")
}

/// A constant expression without a finite value, such as the root of a negative number.
pub fn not_finite(span: Span, value: f64) -> Diagnostic {
    let what = if value.is_nan() { "not a number" } else { "infinite" };
    Diagnostic::error(Code::NotFinite, format!("this is {what}, whatever the parameters are"))
        .label(span, what)
        .hint("write an expression with a finite value, such as the root of a positive number")
}

/// A division by a literal zero.
pub fn division_by_zero(span: Span) -> Diagnostic {
    Diagnostic::error(Code::DivisionByZero, "this divides by zero")
        .label(span, "always 0")
        .hint("write a divisor that is not zero")
}

/// A stretch that is not linear in the coordinates.
pub fn stretch_not_linear(span: Span) -> Diagnostic {
    Diagnostic::error(
        Code::StretchNotLinear,
        "a stretch is a linear combination of coordinates",
    )
    .label(span, "not linear")
    .hint("write coordinates times parameters, such as `body - pivot - mr*(wheel - pivot)`; the law may be nonlinear")
}

/// A constant in a stretch.
pub fn stretch_has_constant(span: Span) -> Diagnostic {
    Diagnostic::error(Code::StretchHasConstant, "a stretch has no constant part")
        .label(span, "does not move")
        .hint("write the free length or gap into the law: `force = k*(s + preload);`")
}

/// A stretch of a link or force, or a point, in which all coordinates cancel.
pub fn stretch_vanishes(span: Span, kind: &str, name: &str) -> Diagnostic {
    let does = match kind {
        "force" => "moves nothing",
        "point" => "never moves",
        _ => "never stretches",
    };
    Diagnostic::error(
        Code::StretchVanishes,
        format!("{kind} `{name}` {does}: both ends are the same point"),
    )
    .label(span, "always 0")
    .hint(format!(
        "write two different points, or leave the {kind} out by an `if`"
    ))
}

/// A stretch that is neither a length nor an angle.
pub fn stretch_unit(span: Span, unit: &str) -> Diagnostic {
    Diagnostic::error(
        Code::StretchUnit,
        format!("a stretch is in m, or in rad, not in {unit}"),
    )
    .label(span, format!("this is in {unit}"))
    .hint("write lever arms in m and ratios as plain numbers, such as `body + arm*pitch - wheel`")
}

/// A link whose law is empty.
pub fn empty_law(span: Span, name: &str) -> Diagnostic {
    Diagnostic::error(Code::EmptyLaw, format!("link `{name}` has no force"))
        .label(span, "no term")
        .hint("write `spring k;`, `damper c;`, `inerter b;` or `force = …;` into its braces")
}

/// A state whose rate is not given.
pub fn state_without_rate(span: Span, name: &str) -> Diagnostic {
    Diagnostic::error(Code::StateWithoutRate, format!("state `{name}` has no rate"))
        .label(span, "its rate is missing")
        .hint(format!("write `rate {name} = …;` beside it"))
}

/// A second state with the same name in one law.
pub fn second_state(span: Span, name: &str, element: Option<&str>) -> Diagnostic {
    let hint = match element {
        Some(element) => format!("write `second: {element}(…);` to tell the two uses apart"),
        None => "write another name for one of them".to_string(),
    };
    Diagnostic::error(Code::SecondState, format!("the law has two states `{name}`"))
        .label(span, "again here")
        .hint(hint)
}

/// A coefficient of a linear term that depends on the motion.
pub fn coefficient_varies(span: Span, what: &str) -> Diagnostic {
    Diagnostic::error(Code::CoefficientVaries, format!("{what} depends on parameters only"))
        .label(span, "varies with the motion")
        .hint("write a law of its own: `force = k*s*(1 + s/s_0);`")
}

/// A rate of a name that is not a state.
pub fn rate_without_state(span: Span, name: &str, unit: &str) -> Diagnostic {
    Diagnostic::error(Code::RateWithoutState, format!("`{name}` is no state of this law"))
        .label(span, "no state of that name")
        .hint(format!("write `state {name}: {unit};` above it"))
}

/// A state whose rate is given twice.
pub fn second_rate(span: Span, name: &str) -> Diagnostic {
    Diagnostic::error(Code::SecondRate, format!("the rate of `{name}` is given twice"))
        .label(span, "again here")
        .hint("write one `rate` with the sum of both")
}

/// A `rolling` block in a link without a road.
pub fn rolling_without_road(span: Span, link: &str) -> Diagnostic {
    Diagnostic::error(
        Code::RollingWithoutRoad,
        format!("link `{link}` has no road to roll on"),
    )
    .label(span, "for tyres only")
    .hint("write `road pad;` and a stretch such as `wheel - pad`, or remove the block")
}

/// States or rates inside `rolling`.
pub fn rolling_changes_states(span: Span) -> Diagnostic {
    Diagnostic::error(
        Code::RollingChangesStates,
        "a rolling tyre has the same inner states as a standing one",
    )
    .label(span, "cannot be declared here")
    .hint("write states and rates outside of `rolling`; inside, use them in forces")
}

/// A second `rolling` block, or one outside of a link.
pub fn second_rolling(span: Span) -> Diagnostic {
    Diagnostic::error(Code::SecondRolling, "a `rolling` block stands once, directly in a link")
        .label(span, "not directly in a link, or not the first")
        .hint("write one `rolling { … }` into the link")
}

/// A range whose bounds are in the wrong order.
pub fn range_reversed(span: Span, low: &str, high: &str) -> Diagnostic {
    Diagnostic::error(Code::RangeReversed, "the lower bound is not below the upper one")
        .label(span, "an empty range")
        .hint(match low == high {
            true => format!("write a lower and an upper bound, or no range: `= {low}` is the value unless given"),
            false => format!("write `in {high}..{low}`"),
        })
}

/// A default outside of the declared range.
pub fn default_outside_range(span: Span, name: &str) -> Diagnostic {
    Diagnostic::error(
        Code::DefaultOutsideRange,
        format!("the default of `{name}` is outside of its range"),
    )
    .label(span, "not between the bounds")
    .hint("write a default between the bounds, or wider bounds")
}
