//! What a link connects: its ends, and the lever between it and a point.

use super::base::Base;
use super::rewrite::binary;
use crate::front::syntax::{Expression, ExpressionKind, Link, Operator};

/// A summand of a stretch: a point as it is written, its factor (`None` for one), and whether it is subtracted.
struct Part {
    point: String,
    factor: Option<Expression>,
    negative: bool,
}

/// The first point of a stretch that stands for itself: the upper end of the link.
pub fn upper(base: &Base, direction: &str, link: &Link) -> Option<String> {
    end(base, direction, link, false)
}

/// The first point that is subtracted from the stretch as a whole: the lower end of the link.
pub fn lower(base: &Base, direction: &str, link: &Link) -> Option<String> {
    end(base, direction, link, true)
}

fn end(base: &Base, direction: &str, link: &Link, negative: bool) -> Option<String> {
    let mut parts = parts(base, direction, &link.stretch).into_iter();
    let found = parts.find(|part| part.negative == negative && part.factor.is_none())?;
    Some(found.point)
}

/// How far a point travels for a travel of the link: the size of its factor in the stretch. `None` where the link
/// travels as far as the point, or does not hold it.
pub fn lever(base: &Base, direction: &str, link: &Link, point: &str) -> Option<Expression> {
    let parts = parts(base, direction, &link.stretch);
    let point = base.pointed_at(direction, point);
    let mut own = parts
        .into_iter()
        .filter(|part| base.pointed_at(direction, &part.point) == point);
    own.next().and_then(|part| part.factor)
}

/// The points that stand with a factor in a stretch: those that levers turn with, and about.
pub fn levered(base: &Base, direction: &str, link: &Link) -> Vec<String> {
    let parts = parts(base, direction, &link.stretch).into_iter();
    let levered = parts.filter(|part| part.factor.is_some());
    levered.map(|part| base.pointed_at(direction, &part.point)).collect()
}

fn parts(base: &Base, direction: &str, stretch: &Expression) -> Vec<Part> {
    match &stretch.kind {
        ExpressionKind::Name(name) => vec![Part {
            point: name.to_string(),
            factor: None,
            negative: false,
        }],
        ExpressionKind::Negative(a) => opposite(parts(base, direction, a)),
        ExpressionKind::Binary(Operator::Add, a, b) => parts(base, direction, a)
            .into_iter()
            .chain(parts(base, direction, b))
            .collect(),
        ExpressionKind::Binary(Operator::Subtract, a, b) => {
            let minus = opposite(parts(base, direction, b));
            parts(base, direction, a).into_iter().chain(minus).collect()
        }
        ExpressionKind::Binary(Operator::Multiply, a, b) if moves(base, direction, b) => {
            scaled(parts(base, direction, b), |own| times(own, a))
        }
        ExpressionKind::Binary(Operator::Multiply, a, b) => scaled(parts(base, direction, a), |own| times(own, b)),
        ExpressionKind::Binary(Operator::Divide, a, b) => scaled(parts(base, direction, a), |own| {
            let own = own.unwrap_or_else(|| {
                super::rewrite::made(ExpressionKind::Number(crate::front::syntax::Number::new(1.0)))
            });
            binary(Operator::Divide, own, (**b).clone())
        }),
        _ => vec![],
    }
}

fn times(own: Option<Expression>, factor: &Expression) -> Expression {
    match own {
        None => factor.clone(),
        Some(own) => binary(Operator::Multiply, factor.clone(), own),
    }
}

fn scaled(parts: Vec<Part>, by: impl Fn(Option<Expression>) -> Expression) -> Vec<Part> {
    let one = |part: Part| Part {
        factor: Some(by(part.factor)),
        ..part
    };
    parts.into_iter().map(one).collect()
}

fn opposite(parts: Vec<Part>) -> Vec<Part> {
    let one = |part: Part| Part {
        negative: !part.negative,
        ..part
    };
    parts.into_iter().map(one).collect()
}

/// Whether a point stands in an expression.
fn moves(base: &Base, direction: &str, e: &Expression) -> bool {
    let mut found = false;
    super::rewrite::names_in(e, &mut |name| {
        let (home, point) = match name.names.as_slice() {
            [home, point] => (home.text.as_str(), point),
            [.., point] => (direction, point),
            [] => return,
        };
        found |= base.coordinate(home, &point.text).is_some();
    });
    found
}
