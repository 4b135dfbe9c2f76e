//! The curves of an effect: the tables in its laws, and which of its parameters are points of them.

use crate::front::syntax::{Change, Effect, Expression, ExpressionKind, LawStatement, Operator, Statement, Table};

/// A table in a law.
#[derive(Clone, Debug, PartialEq)]
pub struct Curve {
    /// The argument: `s`, `v` or another name of the law.
    pub over: String,
    /// The parameter that scales the abscissae; `None` if these are in the unit of the argument.
    pub scale: Option<String>,
    /// Abscissae and ordinates.
    pub points: Vec<(f64, Ordinate)>,
}

/// An ordinate of a curve.
#[derive(Clone, Debug, PartialEq)]
pub enum Ordinate {
    /// A number, in SI.
    Number(f64),
    /// A product of parameters of the effect, by their names in the effect.
    Product(Vec<String>),
}

impl Curve {
    /// True for a parameter that is its scale or a factor of a point.
    pub fn holds(&self, name: &String) -> bool {
        let is_factor =
            |(_, ordinate): &(f64, Ordinate)| matches!(ordinate, Ordinate::Product(names) if names.contains(name));
        self.scale.as_ref() == Some(name) || self.points.iter().any(is_factor)
    }
}

/// The curves of an effect in its usual form, in the order of its text, without those of a rolling tyre.
pub fn curves(effect: &Effect) -> Vec<Curve> {
    let laws = effect.changes().flat_map(|change| match change {
        Change::Add(_, law) | Change::ReplaceTerm(_, _, law) => law.as_slice(),
        Change::Declare(Statement::Link(link)) => link.body.as_slice(),
        _ => &[],
    });
    let mut found = Vec::new();
    for statement in laws {
        let value = match statement {
            LawStatement::Force(value) | LawStatement::Rate(_, value) => value,
            LawStatement::Let(own) => &own.value,
            _ => continue,
        };
        tables(value, &mut |table| found.extend(curve(table)));
    }
    found
}

fn tables(of: &Expression, each: &mut dyn FnMut(&Table)) {
    match &of.kind {
        ExpressionKind::Table(table) => each(table),
        ExpressionKind::Negative(a) => tables(a, each),
        ExpressionKind::Binary(_, a, b) | ExpressionKind::If(_, a, b) => {
            tables(a, each);
            tables(b, each);
        }
        ExpressionKind::Call(_, arguments) => arguments.iter().for_each(|argument| tables(argument, each)),
        ExpressionKind::Number(_) | ExpressionKind::Name(_) => {}
    }
}

/// `None` if an abscissa is not a number, or an ordinate is neither a number nor a product of names.
fn curve(table: &Table) -> Option<Curve> {
    let (over, scale) = match &table.x.kind {
        ExpressionKind::Binary(Operator::Divide, of, by) => (of, Some(name(by)?)),
        _ => (&Box::new(table.x.clone()), None),
    };
    let (sign, over) = match &over.kind {
        ExpressionKind::Negative(inner) => (-1.0, name(inner)?),
        _ => (1.0, name(over)?),
    };
    let both = table.knots.entries.iter().zip(&table.values.entries);
    let mut points = both
        .map(|(x, y)| Some((sign * number(x)?, ordinate(y)?)))
        .collect::<Option<Vec<_>>>()?;
    points.sort_by(|a, b| a.0.total_cmp(&b.0));
    Some(Curve { over, scale, points })
}

fn ordinate(e: &Expression) -> Option<Ordinate> {
    number(e)
        .map(Ordinate::Number)
        .or_else(|| factors(e).map(Ordinate::Product))
}

fn factors(e: &Expression) -> Option<Vec<String>> {
    match &e.kind {
        ExpressionKind::Binary(Operator::Multiply, a, b) => Some([factors(a)?, factors(b)?].concat()),
        _ => Some(vec![name(e)?]),
    }
}

fn name(e: &Expression) -> Option<String> {
    match &e.kind {
        ExpressionKind::Name(name) if name.names.len() == 1 => Some(name.names[0].text.clone()),
        _ => None,
    }
}

/// The value of a number, in SI.
fn number(e: &Expression) -> Option<f64> {
    match &e.kind {
        ExpressionKind::Number(number) => Some(number.value),
        ExpressionKind::Negative(inner) => number(inner).map(|value| -value),
        _ => None,
    }
}
