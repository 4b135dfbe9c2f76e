//! Expressions with no more brackets than they need.

use std::fmt::{self, Display, Formatter};

use crate::front::syntax::{
    Comparison, Expression, ExpressionKind, List, Logic, Number, Operator, OptionTest, Order, UnitFactor, UnitText,
};
use crate::units;

/// Precedence of an expression, from the weakest to the strongest.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Rank {
    Sum,
    Product,
    Sign,
    Power,
    Atom,
}

fn rank(expression: &Expression) -> Rank {
    match &expression.kind {
        ExpressionKind::Binary(Operator::Add | Operator::Subtract, ..) => Rank::Sum,
        ExpressionKind::Binary(Operator::Multiply | Operator::Divide, ..) => Rank::Product,
        ExpressionKind::Negative(_) => Rank::Sign,
        ExpressionKind::Number(number) if number.digits.starts_with('-') => Rank::Sign,
        // An exponent would apply to its unit.
        ExpressionKind::Number(number) if !number.unit.factors.is_empty() => Rank::Power,
        ExpressionKind::Binary(Operator::Power, ..) => Rank::Power,
        ExpressionKind::Number(_) | ExpressionKind::Name(_) | ExpressionKind::Call(..) => Rank::Atom,
        ExpressionKind::Table(_) | ExpressionKind::If(..) => Rank::Atom,
    }
}

fn at_least(needed: Rank, expression: &Expression) -> String {
    if rank(expression) < needed {
        format!("({expression})")
    } else {
        expression.to_string()
    }
}

impl Display for Expression {
    fn fmt(&self, f: &mut Formatter) -> fmt::Result {
        match &self.kind {
            ExpressionKind::Number(number) => write!(f, "{number}"),
            ExpressionKind::Name(name) => write!(f, "{name}"),
            ExpressionKind::Negative(operand) => write!(f, "-{}", at_least(Rank::Sign, operand)),
            ExpressionKind::Binary(operator, left, right) => f.write_str(&binary(*operator, left, right)),
            ExpressionKind::Call(name, arguments) => {
                let arguments: Vec<String> = arguments.iter().map(ToString::to_string).collect();
                write!(f, "{}({})", name.text, arguments.join(", "))
            }
            ExpressionKind::Table(table) => write!(f, "table({}, {}, {})", table.x, table.knots, table.values),
            ExpressionKind::If(condition, then, otherwise) => match otherwise.kind {
                ExpressionKind::If(..) => write!(f, "if {condition} {{ {then} }} else {otherwise}"),
                _ => write!(f, "if {condition} {{ {then} }} else {{ {otherwise} }}"),
            },
        }
    }
}

impl Display for List {
    fn fmt(&self, f: &mut Formatter) -> fmt::Result {
        let entries: Vec<String> = self.entries.iter().map(ToString::to_string).collect();
        write!(f, "[{}]", entries.join(", "))
    }
}

fn binary(operator: Operator, left: &Expression, right: &Expression) -> String {
    match operator {
        Operator::Add => format!("{} + {}", at_least(Rank::Sum, left), at_least(Rank::Product, right)),
        Operator::Subtract => format!("{} - {}", at_least(Rank::Sum, left), at_least(Rank::Product, right)),
        Operator::Multiply => format!("{}*{}", at_least(Rank::Product, left), at_least(Rank::Sign, right)),
        Operator::Divide => quotient(left, right),
        Operator::Power => format!("{}^{}", at_least(Rank::Atom, left), at_least(Rank::Sign, right)),
    }
}

/// Brackets keep a divisor from being read as a part of the unit of the number before it: `2 N/(m)`. A product is in
/// brackets already and could be a unit nevertheless, so there they enclose the number: `(2 N)/(m*s)`.
fn quotient(left: &Expression, right: &Expression) -> String {
    let (above, below) = (at_least(Rank::Product, left), at_least(Rank::Sign, right));
    let follows_unit = ends_in_unit(left);
    if follows_unit && begins_like_unit(right) {
        format!("{above}/({below})")
    } else if follows_unit && reads_as_unit(right) {
        format!("({above})/{below}")
    } else {
        format!("{above}/{below}")
    }
}

fn ends_in_unit(expression: &Expression) -> bool {
    match &expression.kind {
        ExpressionKind::Number(number) => !number.unit.factors.is_empty(),
        ExpressionKind::Negative(last) | ExpressionKind::Binary(_, _, last) => ends_in_unit(last),
        _ => false,
    }
}

fn begins_like_unit(expression: &Expression) -> bool {
    match &expression.kind {
        ExpressionKind::Name(name) => units::symbol(&name.names[0].text).is_some(),
        ExpressionKind::Binary(Operator::Power, base, _) => begins_like_unit(base),
        _ => false,
    }
}

/// True for products, quotients and powers of nothing but symbols of units and plain numbers.
fn reads_as_unit(expression: &Expression) -> bool {
    match &expression.kind {
        ExpressionKind::Name(name) => units::symbol(&name.names[0].text).is_some(),
        ExpressionKind::Number(number) => number.unit.factors.is_empty(),
        ExpressionKind::Binary(Operator::Multiply | Operator::Divide, left, right) => {
            reads_as_unit(left) && reads_as_unit(right)
        }
        ExpressionKind::Binary(Operator::Power, base, _) => reads_as_unit(base),
        _ => false,
    }
}

impl Display for Comparison {
    fn fmt(&self, f: &mut Formatter) -> fmt::Result {
        let order = match self.order {
            Order::Less => "<",
            Order::LessEqual => "<=",
            Order::Greater => ">",
            Order::GreaterEqual => ">=",
        };
        write!(f, "{} {order} {}", self.left, self.right)
    }
}

impl Display for OptionTest {
    fn fmt(&self, f: &mut Formatter) -> fmt::Result {
        let order = if self.equal { "==" } else { "!=" };
        write!(f, "{} {order} {}", self.option.text, self.value.text)
    }
}

impl<Test: Display> Display for Logic<Test> {
    fn fmt(&self, f: &mut Formatter) -> fmt::Result {
        let bracketed = |part: &Logic<Test>, needs: bool| if needs { format!("({part})") } else { part.to_string() };
        let is_or = |part: &Logic<Test>| matches!(part, Logic::Or(..));
        let is_and = |part: &Logic<Test>| matches!(part, Logic::And(..));
        match self {
            Logic::Test(test) => write!(f, "{test}"),
            Logic::Not(part) => write!(f, "!({part})"),
            Logic::And(a, b) => {
                write!(
                    f,
                    "{} && {}",
                    bracketed(a, is_or(a)),
                    bracketed(b, is_or(b) || is_and(b))
                )
            }
            Logic::Or(a, b) => write!(f, "{a} || {}", bracketed(b, is_or(b))),
        }
    }
}

impl Display for Number {
    fn fmt(&self, f: &mut Formatter) -> fmt::Result {
        match self.unit.factors.is_empty() {
            true => write!(f, "{}", self.digits),
            false => write!(f, "{} {}", self.digits, self.unit),
        }
    }
}

impl UnitText {
    /// The usual name of the coherent unit that is written here. `Hz` stays `Hz`, since a cycle is not a radian, and so
    /// do coherent units with `rad`.
    pub fn name(&self, unit: units::Unit) -> String {
        let written = self.to_string();
        let is_coherent =
            |own: &UnitFactor| units::symbol(&own.symbol.text).is_some_and(|own| own.multiply == own.divide);
        let has_angle = self.factors.iter().any(|own| own.symbol.text == "rad");
        if written == "Hz" || has_angle && self.factors.iter().all(is_coherent) {
            written
        } else {
            unit.to_string()
        }
    }
}

impl Display for UnitText {
    /// Positive exponents first, the rest after one `/`.
    fn fmt(&self, f: &mut Formatter) -> fmt::Result {
        let raised = |above: bool| -> Vec<String> {
            self.factors
                .iter()
                .filter(|factor| (factor.numerator > 0) == above)
                .map(raised)
                .collect()
        };
        let (above, below) = (raised(true), raised(false));
        match (above.as_slice(), below.as_slice()) {
            ([], []) => f.write_str("1"),
            ([], _) => f.write_str(&spelled_out(&self.factors)),
            (_, []) => f.write_str(&above.join(" ")),
            (_, [one]) => write!(f, "{}/{one}", above.join(" ")),
            _ => write!(f, "{}/({})", above.join(" "), below.join(" ")),
        }
    }
}

/// A unit without a numerator, after a number: `5 s^-1`.
fn spelled_out(factors: &[UnitFactor]) -> String {
    let spelled = |factor: &UnitFactor| match factor.denominator {
        1 => format!("{}^{}", factor.symbol.text, factor.numerator),
        below => format!("{}^({}/{below})", factor.symbol.text, factor.numerator),
    };
    factors.iter().map(spelled).collect::<Vec<_>>().join(" ")
}

/// A symbol with the absolute value of its exponent.
fn raised(factor: &UnitFactor) -> String {
    let symbol = &factor.symbol.text;
    match (factor.numerator.abs(), factor.denominator) {
        (1, 1) => symbol.clone(),
        (above, 1) => format!("{symbol}^{above}"),
        (above, below) => format!("{symbol}^({above}/{below})"),
    }
}
