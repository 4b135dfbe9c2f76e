//! Points, forces and links, which act on the coordinates.

use super::declare::declared;
use super::law::force_unit;
use super::names::{DirectionName, Moving};
use super::{Reported, Resolved, Resolver, StatementOfDirection};
use crate::diagnostic::{Diagnostic, names, units as mistakes};
use crate::expr::{CoordinateId, Expr, LinkId};
use crate::front::syntax::{self, Expression, ExpressionKind, LawStatement, Name, Statement};
use crate::model::{CoordinateKind, Direction, ForceInput, Law, Link, Point, Term};
use crate::units::Unit;

impl Resolver<'_> {
    /// Points: other names of coordinates, and combinations of several coordinates. A point may use those that are
    /// declared above it.
    pub fn points(&mut self, placed: &[StatementOfDirection]) {
        for (direction, statement) in placed {
            let Statement::Point(name, target) = statement else {
                continue;
            };
            let thing = match self.point(name, target, direction, statement) {
                Ok(Moving::Coordinate(coordinate)) => DirectionName::Coordinate(coordinate),
                Ok(Moving::Point(place)) => DirectionName::Point(place),
                Err(_) => DirectionName::Broken,
            };
            self.declare_thing(name, direction, thing);
        }
    }

    fn point(&mut self, name: &Name, target: &Expression, direction: &str, statement: &Statement) -> Resolved<Moving> {
        if let ExpressionKind::Name(own) = &target.kind
            && let Some(Moving::Coordinate(coordinate)) = self.moving_of(own, direction)?
        {
            let meant = &mut self.model.coordinates[usize::from(coordinate.0)];
            if meant.direction.0 == *direction {
                meant.also.push(name.text.clone());
            }
            return Ok(Moving::Coordinate(coordinate));
        }
        let (combination, unit) = self.travel(target, direction, ("point", &name.text))?;
        self.model.points.push(Point {
            name: name.text.clone(),
            direction: Direction(direction.to_string()),
            combination,
            angle: unit == Unit::ONE,
            declared: declared(name, statement),
        });
        Ok(Moving::Point(self.model.points.len() as u16 - 1))
    }

    /// Force inputs.
    pub fn forces(&mut self, placed: &[StatementOfDirection]) {
        for (direction, statement) in placed {
            let Statement::Force(name, on) = statement else {
                continue;
            };
            let thing = match self.force(name, on.as_ref(), direction, statement) {
                Ok(force) => {
                    self.model.forces.push(force);
                    DirectionName::Force(self.model.forces.len() as u16 - 1)
                }
                Err(_) => DirectionName::Broken,
            };
            self.declare_thing(name, direction, thing);
        }
    }

    fn force(
        &mut self,
        name: &Name,
        on: Option<&Expression>,
        direction: &str,
        statement: &Statement,
    ) -> Resolved<ForceInput> {
        let Some(on) = on else {
            return Ok(ForceInput {
                name: name.text.clone(),
                direction: Direction(direction.to_string()),
                on: Vec::new(),
                unit: Unit::NEWTON,
                declared: declared(name, statement),
            });
        };
        let (terms, unit) = self.travel(on, direction, ("force", &name.text))?;
        let moving = |(coordinate, _): &(CoordinateId, Expr)| {
            let kind = self.model.coordinates[usize::from(coordinate.0)].kind;
            !matches!(kind, CoordinateKind::Road | CoordinateKind::Motion)
        };
        if !terms.iter().any(moving) {
            return Err(self.report(names::force_on_prescribed(on.span, &on.to_string())));
        }
        let home = terms.iter().find(|term| moving(term));
        let home = home.map(|(coordinate, _)| self.model.coordinates[usize::from(coordinate.0)].direction.clone());
        Ok(ForceInput {
            name: name.text.clone(),
            direction: home.unwrap_or_else(|| Direction(direction.to_string())),
            on: terms,
            unit: force_unit(unit),
            declared: declared(name, statement),
        })
    }

    /// Links with their laws. All stretches come first, since a law may use those of other links.
    pub fn links(&mut self, placed: &[StatementOfDirection]) {
        let mut laws = Vec::new();
        for (direction, statement) in placed {
            let Statement::Link(link) = statement else { continue };
            let id = LinkId(self.model.links.len() as u16);
            let thing = match self.stretch(link, direction) {
                Ok((stretch, unit)) => {
                    self.model.links.push(Link {
                        name: link.name.text.clone(),
                        direction: Direction(direction.to_string()),
                        stretch,
                        unit,
                        law: Law::default(),
                        rolling: None,
                        doc: link.doc.clone(),
                        declared: declared(&link.name, statement),
                    });
                    DirectionName::Link(id)
                }
                Err(Reported) => DirectionName::Broken,
            };
            let stretched = matches!(thing, DirectionName::Link(_)).then_some(id);
            self.declare_thing(&link.name, direction, thing);
            laws.push((*direction, link, stretched));
        }
        for (direction, link, stretched) in laws {
            // The called functions report the mistakes of a law.
            let _ = match stretched {
                Some(id) => self.law_of_link(link, direction, id),
                None => self.law_of_unknown(&link.body, direction).map(drop),
            };
        }
    }

    fn law_of_link(&mut self, link: &syntax::Link, direction: &str, id: LinkId) -> Resolved<()> {
        let unit = self.model.links[usize::from(id.0)].unit;
        let (law, rolling) = self.law(&link.body, direction, id, unit)?;
        if law.terms.is_empty() {
            return Err(self.report(mistakes::empty_law(link.name.span, &link.name.text)));
        }
        let is_road = |coordinate: usize| self.model.coordinates[coordinate].kind == CoordinateKind::Road;
        let mut stretch = self.model.links[usize::from(id.0)].stretch.iter();
        let on_road = stretch.any(|(coordinate, _)| is_road(usize::from(coordinate.0)));
        if let Some(span) = rolling_block(&link.body).filter(|_| !on_road) {
            return Err(self.report(mistakes::rolling_without_road(span, &link.name.text)));
        }
        let resolved = &mut self.model.links[usize::from(id.0)];
        (resolved.law, resolved.rolling) = (law, rolling);
        Ok(())
    }

    /// Checks the law of a link whose stretch is wrong: as the law of a length, unless its units fit only an angle.
    fn law_of_unknown(&mut self, body: &[LawStatement], direction: &str) -> Resolved<(Law, Option<Vec<Term>>)> {
        let id = LinkId(self.model.links.len() as u16);
        let before = self.found.len();
        let law = self.law(body, direction, id, Unit::METER);
        let of_length = self.found.split_off(before);
        // Mistakes other than those of units are known from the first pass.
        let _ = self.law(body, direction, id, Unit::ONE);
        let of_angle = self.found.split_off(before);
        let is_angle = !of_angle.iter().any(|mistake| mistake.code.is_of_units());
        let stands = |mistake: &Diagnostic| !(is_angle && mistake.code.is_of_units());
        self.found.extend(of_length.into_iter().filter(stands));
        law
    }

    fn stretch(&mut self, link: &syntax::Link, direction: &str) -> Resolved<(Stretch, Unit)> {
        self.travel(&link.stretch, direction, ("link", &link.name.text))
    }

    /// A combination of coordinates that is a length or an angle; `of` is the kind and the name of its owner.
    fn travel(&mut self, expression: &Expression, direction: &str, of: (&str, &str)) -> Resolved<(Stretch, Unit)> {
        let combination = self.combination(expression, direction)?;
        let unit = combination.unit.unwrap_or(Unit::METER);
        if combination.terms.is_empty() {
            return Err(self.report(mistakes::stretch_vanishes(expression.span, of.0, of.1)));
        }
        if unit != Unit::METER && unit != Unit::ONE {
            return Err(self.report(mistakes::stretch_unit(expression.span, &unit.to_string())));
        }
        Ok((combination.terms, unit))
    }
}

type Stretch = Vec<(CoordinateId, Expr)>;

fn rolling_block(body: &[LawStatement]) -> Option<crate::source::Span> {
    body.iter().find_map(|statement| match statement {
        LawStatement::Rolling(span, _) => Some(*span),
        _ => None,
    })
}
