//! Parameters, derived quantities, coordinates and gravity.

use super::names::{DirectionName, Global};
use super::value::Locals;
use super::{Resolved, Resolver, StatementOfDirection};
use crate::diagnostic::{names, units as mistakes};
use crate::expr::CoordinateId;
use crate::front::print::one_line;
use crate::front::syntax::{self, Name, ParameterDefault, Statement};
use crate::model::{Coordinate, CoordinateKind, Declaration, Default, Definition, Direction, Gravity, Parameter};
use crate::units::Unit;

/// The position of a declared name, and the text of its statement.
pub fn declared(name: &Name, statement: &Statement) -> Declaration {
    Declaration {
        span: name.span,
        line: one_line(statement),
    }
}

impl Resolver<'_> {
    /// Parameters are declared first, since any expression may use them.
    pub fn parameters(&mut self, placed: &[StatementOfDirection]) {
        for (_, statement) in placed {
            let Statement::Parameter(parameter) = statement else {
                continue;
            };
            let global = match self.parameter(parameter, statement) {
                Ok(parameter) => {
                    self.model.parameters.push(parameter);
                    Global::Parameter(self.model.parameters.len() as u16 - 1)
                }
                Err(_) => Global::Broken,
            };
            self.declare_global(&parameter.name, global);
        }
        self.shared_defaults(placed);
    }

    fn parameter(&mut self, parameter: &syntax::Parameter, statement: &Statement) -> Resolved<Parameter> {
        let name = &parameter.name.text;
        let in_coherent = |coherent: &str| in_coherent_unit(parameter, coherent);
        let unit = self.coherent(&parameter.unit, parameter.unit.span, in_coherent)?;
        let default = match &parameter.default {
            Some(ParameterDefault::Number(number)) => {
                Default::Value(self.number_in(number, unit, &format!("the default of `{name}`"))?)
            }
            _ => Default::None,
        };
        let range = match &parameter.range {
            Some((low, high)) => Some(self.range(low, high, unit, name)?),
            None => None,
        };
        if let (Default::Value(value), Some((low, high)), Some(ParameterDefault::Number(number))) =
            (default, range, &parameter.default)
            && !(low..=high).contains(&value)
        {
            self.report(mistakes::default_outside_range(number.span, name));
        }
        let (known, doc, declared) = (
            parameter.known,
            parameter.doc.clone(),
            declared(&parameter.name, statement),
        );
        Ok(Parameter {
            name: name.clone(),
            unit,
            unit_name: parameter.unit.name(unit),
            doc,
            default,
            range,
            known,
            clock: parameter.clock,
            declared,
        })
    }

    fn range(&mut self, low: &syntax::Number, high: &syntax::Number, unit: Unit, name: &str) -> Resolved<(f64, f64)> {
        let what = format!("the range of `{name}`");
        let (from, to) = (self.number_in(low, unit, &what)?, self.number_in(high, unit, &what)?);
        if from < to {
            return Ok((from, to));
        }
        let span = low.span.join(high.span);
        Err(self.report(mistakes::range_reversed(span, &low.to_string(), &high.to_string())))
    }

    /// Defaults that refer to other parameters; all parameters are known by now.
    fn shared_defaults(&mut self, placed: &[StatementOfDirection]) {
        for (_, statement) in placed {
            let Statement::Parameter(parameter) = statement else {
                continue;
            };
            let Some(ParameterDefault::Same(other)) = &parameter.default else {
                continue;
            };
            // The called function reports a mistake; the parameter then has no default.
            let _ = self.shared_default(&parameter.name, other);
        }
    }

    fn shared_default(&mut self, name: &Name, other: &Name) -> Resolved<()> {
        let dotted = syntax::Dotted {
            names: vec![other.clone()],
        };
        let value = self.named(&dotted, &Locals::default())?;
        let Some((_, Global::Parameter(own))) = self.names.globals.get(&name.text).copied() else {
            return Ok(());
        };
        let Some((_, Global::Parameter(same))) = self.names.globals.get(&other.text).copied() else {
            let example = format!("param {}: … = 1.0;", name.text);
            let mistake = names::wrong_kind(other.span, &other.text, "a derived quantity", "a parameter", &example);
            return Err(self.report(mistake));
        };
        let unit = self.model.parameters[usize::from(own)].unit;
        self.require_unit(value, other.span, unit, &format!("the default of `{}`", name.text))?;
        self.model.parameters[usize::from(own)].default = Default::Same(same);
        self.follow_defaults(own, name)
    }

    /// Refuses a circular chain of defaults.
    fn follow_defaults(&mut self, from: u16, name: &Name) -> Resolved<()> {
        let mut chain = vec![name.text.clone()];
        let mut at = from;
        while let Default::Same(next) = self.model.parameters[usize::from(at)].default {
            if next == from {
                self.model.parameters[usize::from(from)].default = Default::None;
                return Err(self.report(names::circular_default(name.span, &chain)));
            }
            chain.push(self.model.parameters[usize::from(next)].name.clone());
            at = next;
        }
        Ok(())
    }

    /// Derived quantities. Each may use parameters and the derived quantities above it.
    pub fn definitions(&mut self, placed: &[StatementOfDirection]) {
        let lets = placed.iter().filter_map(|(_, statement)| match statement {
            Statement::Let(definition) => Some((definition, *statement)),
            _ => None,
        });
        let lets: Vec<_> = lets.collect();
        self.later = lets
            .iter()
            .map(|(definition, _)| (definition.name.span, definition.name.text.clone()))
            .collect();
        for (definition, statement) in lets {
            let value = self.value(&definition.value, &Locals::default());
            let global = match value {
                Ok(value) => {
                    let (name, declared) = (definition.name.text.clone(), declared(&definition.name, statement));
                    let unit = value.unit.unwrap_or(Unit::ONE);
                    self.model.definitions.push(Definition {
                        name,
                        unit,
                        value: value.expr,
                        declared,
                    });
                    self.definitions.push(value);
                    Global::Definition(self.definitions.len() as u16 - 1)
                }
                Err(_) => Global::Broken,
            };
            self.declare_global(&definition.name, global);
        }
    }

    /// Masses, nodes, roads and motions.
    pub fn coordinates(&mut self, placed: &[StatementOfDirection]) {
        for (direction, statement) in placed {
            let Statement::Coordinate(coordinate) = statement else {
                continue;
            };
            let kind = self.coordinate_kind(coordinate);
            let thing = match kind {
                Ok(_) => DirectionName::Coordinate(CoordinateId(self.model.coordinates.len() as u16)),
                Err(_) => DirectionName::Broken,
            };
            self.declare_thing(&coordinate.name, direction, thing);
            let Ok(kind) = kind else { continue };
            self.model.coordinates.push(Coordinate {
                name: coordinate.name.text.clone(),
                also: Vec::new(),
                direction: Direction(direction.to_string()),
                kind,
                angle: coordinate.angle,
                doc: coordinate.doc.clone(),
                declared: declared(&coordinate.name, statement),
            });
        }
    }

    fn coordinate_kind(&mut self, coordinate: &syntax::Coordinate) -> Resolved<CoordinateKind> {
        let name = &coordinate.name.text;
        let locals = Locals::default();
        match &coordinate.kind {
            syntax::CoordinateKind::Mass(mass) if !coordinate.angle => {
                let what = format!("the mass of `{name}`");
                Ok(CoordinateKind::Mass(self.value_in(
                    mass,
                    &locals,
                    Unit::KILOGRAM,
                    &what,
                )?))
            }
            syntax::CoordinateKind::Mass(inertia) | syntax::CoordinateKind::Inertia(inertia) => {
                let what = format!("the rotational inertia of `{name}`");
                Ok(CoordinateKind::Mass(self.value_in(
                    inertia,
                    &locals,
                    Unit::ROTATIONAL_INERTIA,
                    &what,
                )?))
            }
            syntax::CoordinateKind::Node => Ok(CoordinateKind::Node),
            syntax::CoordinateKind::Road => Ok(CoordinateKind::Road),
            syntax::CoordinateKind::Motion => Ok(CoordinateKind::Motion),
        }
    }

    /// Gravities, at most one for each direction.
    pub fn gravities(&mut self, placed: &[StatementOfDirection]) {
        for (direction, statement) in placed {
            let Statement::Gravity(name) = statement else { continue };
            let first = self
                .model
                .gravities
                .iter()
                .find(|gravity| gravity.direction.0 == *direction);
            if let Some(first) = first {
                let mistake = names::second_gravity(name.span, first.declared.span, direction);
                self.report(mistake);
                continue;
            }
            self.declare_thing(name, direction, DirectionName::Gravity);
            let (direction, declared) = (Direction(direction.to_string()), declared(name, statement));
            self.model.gravities.push(Gravity {
                name: name.text.clone(),
                direction,
                declared,
            });
        }
    }
}

/// The declaration in a coherent unit; its plain numbers get the unit in which it was written.
fn in_coherent_unit(parameter: &syntax::Parameter, coherent: &str) -> String {
    let mut rewritten = parameter.clone();
    let with_unit = |number: &mut syntax::Number| {
        if number.unit.factors.is_empty() {
            number.unit = parameter.unit.clone();
        }
    };
    if let Some(ParameterDefault::Number(number)) = &mut rewritten.default {
        with_unit(number);
    }
    if let Some((low, high)) = &mut rewritten.range {
        with_unit(low);
        with_unit(high);
    }
    let line = one_line(&Statement::Parameter(rewritten));
    line.replacen(&format!(": {}", parameter.unit), &format!(": {coherent}"), 1)
}
