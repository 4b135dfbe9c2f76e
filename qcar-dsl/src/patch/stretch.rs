//! The ends of a link, and the motion ratio between it and a point.

use super::model_tree::ModelTree;
use super::rewrite::binary;
use crate::front::syntax::{Expression, ExpressionKind, Link, Operator};

/// A summand of a stretch: a point as written, its factor (`None` for 1), and true if it is subtracted.
struct Part {
    point: String,
    factor: Option<Expression>,
    negative: bool,
}

/// The upper end of a link: the first point that is added without a factor.
pub fn upper(base: &ModelTree, direction: &str, link: &Link) -> Option<String> {
    end(base, direction, link, false)
}

/// The lower end of a link: the first point that is subtracted without a factor.
pub fn lower(base: &ModelTree, direction: &str, link: &Link) -> Option<String> {
    end(base, direction, link, true)
}

fn end(base: &ModelTree, direction: &str, link: &Link, negative: bool) -> Option<String> {
    let mut parts = parts(base, direction, &link.stretch).into_iter();
    let found = parts.find(|part| part.negative == negative && part.factor.is_none())?;
    Some(found.point)
}

/// Travel of the link over travel of a point: the absolute value of the point's factor in the stretch. `None` if the
/// factor is one, or if the stretch does not contain the point.
pub fn lever(base: &ModelTree, direction: &str, link: &Link, point: &str) -> Option<Expression> {
    let parts = parts(base, direction, &link.stretch);
    let point = base.pointed_at(direction, point);
    let mut own = parts
        .into_iter()
        .filter(|part| base.pointed_at(direction, &part.point) == point);
    own.next().and_then(|part| part.factor)
}

/// The points that have a factor in a stretch, as written: the moving ends and the pivots of levers.
pub fn levered(base: &ModelTree, direction: &str, link: &Link) -> Vec<String> {
    let parts = parts(base, direction, &link.stretch).into_iter();
    let levered = parts.filter(|part| part.factor.is_some());
    levered.map(|part| part.point).collect()
}

fn parts(base: &ModelTree, direction: &str, stretch: &Expression) -> Vec<Part> {
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

/// True if an expression contains a point.
fn moves(base: &ModelTree, direction: &str, e: &Expression) -> bool {
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
