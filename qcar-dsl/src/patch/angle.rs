//! Effects where the motion is an angle. A law of a travel and a force holds for an angle and a moment in other units:
//! rad instead of m, N m instead of N, kg m² instead of kg. Coherent values do not change.

use std::convert::Infallible;

use super::rewrite;
use crate::front::syntax::{
    Change, Coordinate, CoordinateKind, Effect, EffectParameter, Expression, ExpressionKind, Form, LawStatement, Let,
    Link, Name, Number, Role, Statement, UnitFactor, UnitText, VanishesAt,
};
use crate::units::{Unit, symbol};

/// An effect on lengths, masses and forces as one on angles, inertias and moments. Changes along other directions stay
/// as they are.
pub fn of_angles(effect: &Effect) -> Effect {
    let forms = effect.forms.iter().map(|form| Form {
        body: changes(&form.body),
        ..form.clone()
    });
    Effect {
        body: changes(&effect.body),
        forms: forms.collect(),
        ..effect.clone()
    }
}

/// The unit of a quantity of angles that corresponds to that of a quantity of lengths: a length to the power of two is
/// added for each kg, and each length becomes an angle.
pub fn unit(written: &UnitText) -> UnitText {
    let (mut lengths, mut beside) = (0, 0);
    let mut factors: Vec<UnitFactor> = Vec::new();
    for own in &written.factors {
        let unit = symbol(&own.symbol.text).map_or(Unit::ONE, |symbol| symbol.unit);
        let [masses, meters, _] = unit.sixths.map(|sixths| i32::from(sixths) / 6);
        if own.symbol.text == "m" {
            factors.push(with_symbol(own, "rad"));
        } else {
            factors.push(own.clone());
            // Exponents of units in an effect are whole numbers.
            lengths += (2 * masses - meters) * own.numerator / own.denominator;
            if masses != 0 {
                beside = factors.len();
            }
        }
    }
    if lengths != 0 {
        let place = if lengths > 0 { beside } else { factors.len() };
        let meters = UnitFactor {
            symbol: Name::new("m"),
            numerator: lengths,
            denominator: 1,
        };
        factors.insert(place, meters);
    }
    UnitText {
        factors,
        span: written.span,
    }
}

fn with_symbol(factor: &UnitFactor, symbol: &str) -> UnitFactor {
    UnitFactor {
        symbol: Name {
            text: symbol.to_string(),
            span: factor.symbol.span,
        },
        ..factor.clone()
    }
}

fn changes(all: &[Change]) -> Vec<Change> {
    all.iter().map(change).collect()
}

fn change(of: &Change) -> Change {
    match of {
        Change::Parameter(own) => Change::Parameter(parameter(own)),
        Change::Declare(statement) => Change::Declare(declared(statement)),
        Change::Take(part, mass) => Change::Take(expression(part), mass.clone()),
        Change::Add(link, own) => Change::Add(link.clone(), law(own)),
        Change::ReplaceTerm(term, link, own) => Change::ReplaceTerm(term.clone(), link.clone(), law(own)),
        Change::ReplacePoint { point, of, by } => Change::ReplacePoint {
            point: point.clone(),
            of: of.clone(),
            by: expression(by),
        },
        Change::ReplaceStretch { of, by, rolling } => Change::ReplaceStretch {
            of: of.clone(),
            by: expression(by),
            rolling: rolling.as_ref().map(expression),
        },
        Change::PlaceSensor { end, of, at } => Change::PlaceSensor {
            end: end.clone(),
            of: of.clone(),
            at: expression(at),
        },
        Change::Remove(_) | Change::Direction { .. } | Change::Delay(..) | Change::Scale(..) => of.clone(),
    }
}

fn parameter(of: &EffectParameter) -> EffectParameter {
    let (low, high) = &of.range;
    let role = match &of.role {
        Role::Strength(VanishesAt::Value(value)) => Role::Strength(VanishesAt::Value(expression(value))),
        other => other.clone(),
    };
    EffectParameter {
        role,
        unit: unit(&of.unit),
        start: expression(&of.start),
        range: (expression(low), expression(high)),
        ..of.clone()
    }
}

fn declared(statement: &Statement) -> Statement {
    match statement {
        Statement::Let(own) => Statement::Let(Let {
            value: expression(&own.value),
            ..own.clone()
        }),
        Statement::Coordinate(own) => Statement::Coordinate(Coordinate {
            angle: true,
            kind: match &own.kind {
                CoordinateKind::Mass(mass) | CoordinateKind::Inertia(mass) => CoordinateKind::Inertia(expression(mass)),
                other => other.clone(),
            },
            ..own.clone()
        }),
        Statement::Point(name, target) => Statement::Point(name.clone(), expression(target)),
        Statement::Link(own) => Statement::Link(Link {
            stretch: expression(&own.stretch),
            body: law(&own.body),
            ..own.clone()
        }),
        other => other.clone(),
    }
}

fn law(body: &[LawStatement]) -> Vec<LawStatement> {
    let Ok(mut changed) = rewrite::law(body, &mut |e| Ok::<_, Infallible>(expression(e)));
    for statement in &mut changed {
        if let LawStatement::State(_, written) = statement {
            *written = unit(written);
        }
    }
    changed
}

fn expression(e: &Expression) -> Expression {
    let mut in_angles = |leaf: &Expression| {
        Ok::<_, Infallible>(match &leaf.kind {
            ExpressionKind::Number(number) => Some(Expression {
                kind: ExpressionKind::Number(Number {
                    unit: unit(&number.unit),
                    ..number.clone()
                }),
                span: leaf.span,
            }),
            _ => None,
        })
    };
    let Ok(changed) = rewrite::leaves(e, &mut in_angles);
    changed
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Reads a unit as the parser does, from the declaration of a parameter.
    fn written(text: &str) -> UnitText {
        let text = format!("axle a {{ param p: {text}; }}");
        let source = crate::source::Source {
            name: "a.axle".to_string(),
            text,
        };
        let file = crate::front::parse::parse_text(&source, 0).file;
        let crate::front::syntax::Item::Axle(axle) = &file.items[0] else {
            panic!("no axle: {file}")
        };
        let Statement::Parameter(parameter) = &axle.body[0] else {
            panic!("no parameter: {file}")
        };
        parameter.unit.clone()
    }

    #[test]
    fn forces_become_moments_and_lengths_angles() {
        let of_angle = [
            ("N", "N m"),
            ("kN", "kN m"),
            ("m", "rad"),
            ("mm", "mm/m"),
            ("kg", "kg m^2"),
            ("N/m", "N m/rad"),
            ("N s/m", "N m s/rad"),
            ("m/s", "rad/s"),
            ("N/m^2", "N m/rad^2"),
            ("1/m", "rad^-1"),
            ("Hz", "Hz"),
            ("1", "1"),
            ("J", "J"),
        ];
        for (length, angle) in of_angle {
            assert_eq!(unit(&written(length)).to_string(), angle, "{length}");
        }
    }
}
