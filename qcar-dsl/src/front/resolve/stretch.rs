//! The stretch of a link: a linear combination of coordinates with coefficients in parameters.

use super::names::{DirectionName, Moving};
use super::value::{Locals, Value};
use super::{Resolved, Resolver};
use crate::diagnostic::units as mistakes;
use crate::expr::{CoordinateId, Expr};
use crate::front::syntax::{Expression, ExpressionKind, Operator};
use crate::source::Span;
use crate::units::Unit;

/// Coordinates with their coefficients, each coordinate once, and the unit of the sum.
pub struct Combination {
    /// In the order of the text.
    pub terms: Vec<(CoordinateId, Expr)>,
    /// Unit of the sum; `None` for a sum that is always zero.
    pub unit: Option<Unit>,
}

impl Resolver<'_> {
    /// Extracts the combination from an expression; names without a direction are those of `direction`.
    pub fn combination(&mut self, expression: &Expression, direction: &str) -> Resolved<Combination> {
        match &expression.kind {
            ExpressionKind::Name(name) => {
                let Some(moving) = self.moving_of(name, direction)? else {
                    return Err(self.report(mistakes::stretch_has_constant(expression.span)));
                };
                let one = self.model.graph.constant(1.0);
                let (terms, angle) = match moving {
                    Moving::Coordinate(c) => (vec![(c, one)], self.model.coordinates[usize::from(c.0)].angle),
                    Moving::Point(place) => {
                        let point = &self.model.points[usize::from(place)];
                        (point.combination.clone(), point.angle)
                    }
                };
                let unit = Some(if angle { Unit::ONE } else { Unit::METER });
                Ok(Combination { terms, unit })
            }
            ExpressionKind::Negative(operand) => {
                let operand = self.combination(operand, direction)?;
                Ok(self.negative(operand))
            }
            ExpressionKind::Binary(operator, left, right) if self.moves(expression, direction) => {
                self.combine(*operator, left, right, direction)
            }
            _ if self.moves(expression, direction) => Err(self.report(mistakes::stretch_not_linear(expression.span))),
            _ => self.constant_part(expression),
        }
    }

    fn combine(
        &mut self,
        operator: Operator,
        left: &Expression,
        right: &Expression,
        direction: &str,
    ) -> Resolved<Combination> {
        let (moves_left, moves_right) = (self.moves(left, direction), self.moves(right, direction));
        match operator {
            Operator::Add | Operator::Subtract => {
                let (a, b) = (self.combination(left, direction), self.combination(right, direction));
                let (a, mut b) = (a?, b?);
                if operator == Operator::Subtract {
                    b = self.negative(b);
                }
                self.sum(a, left.span, b, right.span)
            }
            Operator::Multiply if moves_left && !moves_right => self.scaled(left, right, false, direction),
            Operator::Multiply if moves_right && !moves_left => self.scaled(right, left, false, direction),
            Operator::Divide if moves_left && !moves_right => self.scaled(left, right, true, direction),
            _ => Err(self.report(mistakes::stretch_not_linear(left.span.join(right.span)))),
        }
    }

    /// A part of a stretch without coordinates: only a literal zero is allowed.
    fn constant_part(&mut self, expression: &Expression) -> Resolved<Combination> {
        match self.value(expression, &Locals::default())?.unit {
            None => Ok(Combination {
                terms: vec![],
                unit: None,
            }),
            Some(_) => Err(self.report(mistakes::stretch_has_constant(expression.span))),
        }
    }

    fn negative(&mut self, combination: Combination) -> Combination {
        let graph = &mut self.model.graph;
        let terms = combination
            .terms
            .into_iter()
            .map(|(coordinate, c)| (coordinate, graph.neg(c)))
            .collect();
        Combination { terms, ..combination }
    }

    fn sum(&mut self, a: Combination, a_span: Span, b: Combination, b_span: Span) -> Resolved<Combination> {
        let expr = self.model.graph.constant(0.0);
        let (left, right) = (Value { expr, unit: a.unit }, Value { expr, unit: b.unit });
        let unit = self.agree(left, a_span, right, b_span, "the stretch is a sum")?;
        let mut terms = a.terms;
        for (coordinate, coefficient) in b.terms {
            match terms.iter_mut().find(|(known, _)| *known == coordinate) {
                Some((_, own)) => *own = self.model.graph.add(*own, coefficient),
                None => terms.push((coordinate, coefficient)),
            }
        }
        terms.retain(|(_, coefficient)| self.model.graph.as_constant(*coefficient) != Some(0.0));
        Ok(Combination { terms, unit })
    }

    fn scaled(&mut self, moving: &Expression, by: &Expression, divide: bool, direction: &str) -> Resolved<Combination> {
        let (combination, factor) = (self.combination(moving, direction), self.value(by, &Locals::default()));
        let (combination, factor) = (combination?, factor?);
        let graph = &mut self.model.graph;
        if divide && graph.as_constant(factor.expr) == Some(0.0) {
            return Err(self.report(mistakes::division_by_zero(by.span)));
        }
        let factor_unit = factor.unit.unwrap_or(Unit::ONE);
        let scale = |unit: Unit| {
            if divide {
                unit.per(factor_unit)
            } else {
                unit.times(factor_unit)
            }
        };
        let mut terms = Vec::new();
        for (coordinate, c) in combination.terms {
            let c = if divide {
                graph.div(c, factor.expr)
            } else {
                graph.mul(c, factor.expr)
            };
            if graph.as_constant(c) != Some(0.0) {
                terms.push((coordinate, c));
            }
        }
        Ok(Combination {
            terms,
            unit: combination.unit.map(scale),
        })
    }

    /// True if the expression contains a coordinate.
    fn moves(&self, expression: &Expression, direction: &str) -> bool {
        match &expression.kind {
            ExpressionKind::Number(_) => false,
            ExpressionKind::Name(name) => {
                let found = self.names.find(name, direction);
                matches!(found, Some((_, DirectionName::Coordinate(_) | DirectionName::Point(_))))
            }
            ExpressionKind::Negative(operand) => self.moves(operand, direction),
            ExpressionKind::Binary(_, a, b) => self.moves(a, direction) || self.moves(b, direction),
            ExpressionKind::Call(_, arguments) => arguments.iter().any(|argument| self.moves(argument, direction)),
            ExpressionKind::Table(table) => {
                let entries = table.knots.entries.iter().chain(&table.values.entries);
                [&table.x]
                    .into_iter()
                    .chain(entries)
                    .any(|part| self.moves(part, direction))
            }
            ExpressionKind::If(_, a, b) => self.moves(a, direction) || self.moves(b, direction),
        }
    }
}
