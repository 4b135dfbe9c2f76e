//! Trees with names replaced.

use crate::front::syntax::{
    Comparison, Coordinate, CoordinateKind, Dotted, Expression, ExpressionKind, LawStatement, Let, List, Logic, Table,
};

/// The replacement of a name; `None` keeps it.
pub type Rename<'a, Mistake> = &'a mut dyn FnMut(&Dotted) -> Result<Option<Expression>, Mistake>;

/// The replacement of a name or number; `None` keeps it.
type Replace<'a, Mistake> = &'a mut dyn FnMut(&Expression) -> Result<Option<Expression>, Mistake>;

/// An expression with its names replaced.
pub fn expression<Mistake>(e: &Expression, rename: Rename<'_, Mistake>) -> Result<Expression, Mistake> {
    leaves(e, &mut |leaf| match &leaf.kind {
        ExpressionKind::Name(name) => rename(name),
        _ => Ok(None),
    })
}

/// An expression with its names and numbers replaced.
pub fn leaves<Mistake>(e: &Expression, replace: Replace<'_, Mistake>) -> Result<Expression, Mistake> {
    let mut of = |part: &Expression| leaves(part, replace);
    let kind = match &e.kind {
        ExpressionKind::Name(_) | ExpressionKind::Number(_) => return Ok(replace(e)?.unwrap_or_else(|| e.clone())),
        ExpressionKind::Negative(a) => ExpressionKind::Negative(Box::new(of(a)?)),
        ExpressionKind::Binary(operator, a, b) => ExpressionKind::Binary(*operator, Box::new(of(a)?), Box::new(of(b)?)),
        ExpressionKind::Call(function, arguments) => {
            ExpressionKind::Call(function.clone(), arguments.iter().map(of).collect::<Result<_, _>>()?)
        }
        ExpressionKind::Table(table) => {
            let mut list = |own: &List| -> Result<List, Mistake> {
                let entries = own.entries.iter().map(&mut of).collect::<Result<_, _>>()?;
                Ok(List { entries, ..own.clone() })
            };
            let (knots, values) = (list(&table.knots)?, list(&table.values)?);
            let x = of(&table.x)?;
            ExpressionKind::Table(Box::new(Table { x, knots, values }))
        }
        ExpressionKind::If(condition, then, otherwise) => {
            let condition = logic(condition, replace)?;
            let mut of = |part: &Expression| leaves(part, replace);
            ExpressionKind::If(Box::new(condition), Box::new(of(then)?), Box::new(of(otherwise)?))
        }
    };
    Ok(Expression { kind, span: e.span })
}

fn logic<Mistake>(of: &Logic<Comparison>, replace: Replace<'_, Mistake>) -> Result<Logic<Comparison>, Mistake> {
    let mut boxed = |part: &Logic<Comparison>| Ok(Box::new(logic(part, replace)?));
    Ok(match of {
        Logic::Not(a) => Logic::Not(boxed(a)?),
        Logic::And(a, b) => Logic::And(boxed(a)?, boxed(b)?),
        Logic::Or(a, b) => Logic::Or(boxed(a)?, boxed(b)?),
        Logic::Test(test) => Logic::Test(Comparison {
            left: leaves(&test.left, replace)?,
            order: test.order,
            right: leaves(&test.right, replace)?,
        }),
    })
}

/// A law with its expressions changed.
pub fn law<Mistake>(
    body: &[LawStatement],
    change: &mut dyn FnMut(&Expression) -> Result<Expression, Mistake>,
) -> Result<Vec<LawStatement>, Mistake> {
    let mut changed = Vec::new();
    for statement in body {
        changed.push(match statement {
            LawStatement::Spring(k) => LawStatement::Spring(change(k)?),
            LawStatement::Damper(c) => LawStatement::Damper(change(c)?),
            LawStatement::Inerter(b) => LawStatement::Inerter(change(b)?),
            LawStatement::Force(force) => LawStatement::Force(change(force)?),
            LawStatement::Rate(name, rate) => LawStatement::Rate(name.clone(), change(rate)?),
            LawStatement::Let(definition) => LawStatement::Let(Let {
                value: change(&definition.value)?,
                ..definition.clone()
            }),
            LawStatement::Use(element) => {
                let mut element = element.clone();
                element.arguments = element.arguments.iter().map(&mut *change).collect::<Result<_, _>>()?;
                LawStatement::Use(element)
            }
            LawStatement::Rolling(span, body) => LawStatement::Rolling(*span, law(body, change)?),
            LawStatement::State(..) | LawStatement::Active | LawStatement::If(_) => statement.clone(),
        });
    }
    Ok(changed)
}

/// A coordinate with its inertia changed.
pub fn coordinate<Mistake>(
    of: &Coordinate,
    change: &mut dyn FnMut(&Expression) -> Result<Expression, Mistake>,
) -> Result<Coordinate, Mistake> {
    let kind = match &of.kind {
        CoordinateKind::Mass(mass) => CoordinateKind::Mass(change(mass)?),
        CoordinateKind::Inertia(inertia) => CoordinateKind::Inertia(change(inertia)?),
        other => other.clone(),
    };
    Ok(Coordinate { kind, ..of.clone() })
}

/// Calls a function for every name in an expression.
pub fn names_in(e: &Expression, each: &mut dyn FnMut(&Dotted)) {
    let mut look = |name: &Dotted| {
        each(name);
        Ok::<_, std::convert::Infallible>(None)
    };
    let Ok(_) = expression(e, &mut look);
}

/// An expression that comes from no file.
pub fn made(kind: ExpressionKind) -> Expression {
    Expression {
        kind,
        span: crate::source::Span::default(),
    }
}

/// A name as an expression.
pub fn named(name: &str) -> Expression {
    made(ExpressionKind::Name(Dotted {
        names: vec![crate::front::syntax::Name::new(name)],
    }))
}

/// `a operator b`
pub fn binary(operator: crate::front::syntax::Operator, a: Expression, b: Expression) -> Expression {
    made(ExpressionKind::Binary(operator, Box::new(a), Box::new(b)))
}
