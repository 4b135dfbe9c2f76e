//! The names of a model: parameters and derived quantities, and in each direction coordinates, points, links and
//! forces.

use std::collections::{BTreeMap, BTreeSet};

use super::value::{Locals, Value};
use super::{Reported, Resolved, Resolver};
use crate::diagnostic::{Diagnostic, names as mistakes};
use crate::expr::{CoordinateId, LinkId, Symbol};
use crate::front::syntax::{Dotted, Name};
use crate::source::Span;
use crate::units::Unit;

/// The meaning of a name without a direction.
#[derive(Clone, Copy, Debug)]
pub enum Global {
    /// By its place in `Model::parameters`.
    Parameter(u16),
    /// By its place in `Model::definitions`.
    Definition(u16),
    /// Its declaration has a mistake, so its uses are not reported.
    Broken,
}

/// The meaning of a name of a direction.
#[derive(Clone, Copy, Debug)]
pub enum DirectionName {
    /// A mass, node, road or motion, or a point of it.
    Coordinate(CoordinateId),
    /// A point that several coordinates move, by its place in `Model::points`.
    Point(u16),
    /// A link.
    Link(LinkId),
    /// A force input, by its place in `Model::forces`.
    Force(u16),
    /// A gravity.
    Gravity,
    /// Its declaration has a mistake, so its uses are not reported.
    Broken,
}

/// The meaning of a name in a stretch.
#[derive(Clone, Copy, Debug)]
pub enum Moving {
    /// A mass, node, road or motion.
    Coordinate(CoordinateId),
    /// A point that several of them move, by its place in `Model::points`.
    Point(u16),
}

impl DirectionName {
    fn kind(self) -> &'static str {
        match self {
            DirectionName::Coordinate(_) | DirectionName::Point(_) => "a point that moves",
            DirectionName::Link(_) => "a link",
            DirectionName::Force(_) => "a force input",
            DirectionName::Gravity => "a gravity",
            DirectionName::Broken => "mistaken",
        }
    }
}

/// The names of a direction, with the positions of their declarations.
pub type DirectionNames = BTreeMap<String, (Span, DirectionName)>;

/// The names of a model.
#[derive(Debug, Default)]
pub struct Names {
    /// Parameters and derived quantities, with the positions of their declarations.
    pub globals: BTreeMap<String, (Span, Global)>,
    /// In the order of the text.
    pub directions: Vec<(String, DirectionNames)>,
    /// Names that options have switched off, with the options.
    pub off: BTreeMap<String, String>,
    /// Parameters, derived quantities and elements that are used.
    pub used: BTreeSet<String>,
    /// Undeclared names, with the place where they were expected. Only the first use is reported, since one missing
    /// declaration is one mistake.
    pub unknown: BTreeSet<(String, String)>,
}

impl Names {
    /// The meaning of a name used in a direction. Outside of directions, it is that of the first direction which has
    /// the name.
    pub fn find(&self, name: &Dotted, direction: &str) -> Option<(Span, DirectionName)> {
        match name.names.as_slice() {
            [name] if direction.is_empty() => self.everywhere(&name.text).first().map(|(_, found)| *found),
            [name] => self.direction(direction)?.get(&name.text).copied(),
            [home, name] => self.direction(&home.text)?.get(&name.text).copied(),
            _ => None,
        }
    }

    fn direction(&self, name: &str) -> Option<&DirectionNames> {
        self.directions
            .iter()
            .find(|(known, _)| known == name)
            .map(|(_, names)| names)
    }

    /// The directions that have a name.
    fn everywhere(&self, name: &str) -> Vec<(&str, (Span, DirectionName))> {
        self.directions
            .iter()
            .filter_map(|(home, names)| Some((home.as_str(), *names.get(name)?)))
            .collect()
    }

    fn known_things(&self, direction: &str) -> Vec<String> {
        self.direction(direction)
            .map(|names| names.keys().cloned().collect())
            .unwrap_or_default()
    }
}

impl Resolver<'_> {
    /// Declares a parameter or derived quantity. If a name is declared twice, its uses are ambiguous and not reported.
    pub fn declare_global(&mut self, name: &Name, global: Global) {
        if let Some((first, known)) = self.names.globals.get_mut(&name.text) {
            *known = Global::Broken;
            let mistake = mistakes::duplicate_name(name.span, *first, &name.text, "the model");
            self.report(mistake);
            return;
        }
        self.names.globals.insert(name.text.clone(), (name.span, global));
    }

    /// Declares a name in a direction. A stretch can use coordinates and parameters, so these must have different
    /// names.
    pub fn declare_thing(&mut self, name: &Name, direction: &str, thing: DirectionName) {
        if !self.names.directions.iter().any(|(known, _)| known == direction) {
            self.names.directions.push((direction.to_string(), BTreeMap::new()));
        }
        let own = self
            .names
            .direction(direction)
            .and_then(|names| names.get(&name.text))
            .map(|(span, _)| *span);
        let moves = matches!(thing, DirectionName::Coordinate(_) | DirectionName::Point(_));
        let global = self
            .names
            .globals
            .get(&name.text)
            .map(|(span, _)| *span)
            .filter(|_| moves);
        if let Some(first) = own.or(global) {
            let place = if own.is_some() {
                format!("direction {direction}")
            } else {
                "the model".to_string()
            };
            self.report(mistakes::duplicate_name(name.span, first, &name.text, &place));
        }
        let home = self.names.directions.iter_mut().find(|(known, _)| known == direction);
        if let Some((_, names)) = home {
            let known = names.entry(name.text.clone()).or_insert((name.span, thing));
            if own.is_some() {
                known.1 = DirectionName::Broken;
            }
        }
    }

    /// The value of a name in an expression.
    pub fn named(&mut self, name: &Dotted, locals: &Locals) -> Resolved<Value> {
        if let Some(input) = self.input(name, locals) {
            return Ok(input);
        }
        if let Some(motion) = self.motion_of_link(name, locals) {
            return motion;
        }
        let [single] = name.names.as_slice() else {
            return Err(self.no_value(name, locals));
        };
        if let Some(value) = locals.get(&single.text) {
            return value;
        }
        if locals.closed {
            return Err(self.no_value(name, locals));
        }
        self.names.used.insert(single.text.clone());
        match self.names.globals.get(&single.text) {
            Some((_, Global::Parameter(index))) => {
                let unit = self.model.parameters[usize::from(*index)].unit;
                Ok(Value {
                    expr: self.model.graph.symbol(Symbol::Parameter(*index)),
                    unit: Some(unit),
                })
            }
            Some((_, Global::Definition(index))) => Ok(self.definitions[usize::from(*index)]),
            Some((_, Global::Broken)) => Err(Reported),
            None => Err(self.no_value(name, locals)),
        }
    }

    /// The force input of a name, in a law that can use it. Names of the law and of the model take precedence.
    fn input(&mut self, name: &Dotted, locals: &Locals) -> Option<Value> {
        let home = locals.home.as_ref().filter(|_| !locals.closed)?;
        if let [single] = name.names.as_slice()
            && (locals.get(&single.text).is_some() || self.names.globals.contains_key(&single.text))
        {
            return None;
        }
        let Some((_, DirectionName::Force(place))) = self.names.find(name, home) else {
            return None;
        };
        Some(Value {
            expr: self.model.graph.symbol(Symbol::Force(place)),
            unit: Some(self.model.forces[usize::from(place)].unit),
        })
    }

    /// `x.bushing.stretch` or `x.bushing.rate`, in a law that can use the links of the model.
    fn motion_of_link(&mut self, name: &Dotted, locals: &Locals) -> Option<Resolved<Value>> {
        let home = locals.home.as_ref().filter(|_| !locals.closed)?;
        let (quantity, owner) = name.names.split_last()?;
        let owner = Dotted { names: owner.to_vec() };
        let (_, DirectionName::Link(id)) = self.names.find(&owner, home)? else {
            return None;
        };
        let unit = self.model.links[usize::from(id.0)].unit;
        let (symbol, unit) = match quantity.text.as_str() {
            "stretch" => (Symbol::Stretch(id), unit),
            "rate" => (Symbol::Rate(id), unit.per(Unit::SECOND)),
            other => {
                let known = ["stretch", "rate"];
                let mistake = mistakes::unknown_quantity(quantity.span, other, &owner.to_string(), &known);
                return Some(Err(self.report(mistake)));
            }
        };
        let expr = self.model.graph.symbol(symbol);
        Some(Ok(Value { expr, unit: Some(unit) }))
    }

    /// Reports why a name has no value here.
    fn no_value(&mut self, name: &Dotted, locals: &Locals) -> Reported {
        let (span, text) = (name.span(), name.to_string());
        let global = self.names.globals.get(&text).copied();
        let in_model = (String::new(), text.clone());
        if !locals.closed && self.names.unknown.contains(&in_model) {
            return Reported;
        }
        if let Some((_, DirectionName::Broken)) = self.names.find(name, "") {
            return Reported;
        }
        let mistake = if let Some((_, global)) = global {
            mistakes::element_is_closed(span, &text, &self.unit_of(global))
        } else if text == "s" || text == "v" {
            mistakes::law_variable_outside(span, &text)
        } else if let Some((_, DirectionName::Coordinate(_) | DirectionName::Point(_))) = self.names.find(name, "") {
            mistakes::coordinate_in_expression(span, &text)
        } else if let Some(options) = self.names.off.get(&text) {
            mistakes::switched_off(span, &text, options)
        } else if let Some((declared, _)) = self.later.iter().find(|(_, later)| *later == text) {
            mistakes::used_before_declared(span, *declared, &text)
        } else {
            let place = if locals.closed { "the element" } else { "the model" };
            if !locals.closed {
                self.names.unknown.insert(in_model);
            }
            mistakes::unknown_name(span, &text, place, &self.values_in_sight(locals))
        };
        self.report(mistake)
    }

    fn unit_of(&self, global: Global) -> String {
        match global {
            Global::Parameter(index) => self.model.parameters[usize::from(index)].unit.to_string(),
            Global::Definition(index) => self.model.definitions[usize::from(index)].unit.to_string(),
            Global::Broken => "1".to_string(),
        }
    }

    fn values_in_sight(&self, locals: &Locals) -> Vec<String> {
        let local = locals.names.iter().map(|(name, _)| name.clone());
        let global = self.names.globals.keys().filter(|_| !locals.closed).cloned();
        local.chain(global).collect()
    }

    /// The coordinate or point of a name in a stretch; `None` for a parameter or derived quantity.
    pub fn moving_of(&mut self, name: &Dotted, direction: &str) -> Resolved<Option<Moving>> {
        match self.names.find(name, direction) {
            Some((_, DirectionName::Coordinate(coordinate))) => Ok(Some(Moving::Coordinate(coordinate))),
            Some((_, DirectionName::Point(point))) => Ok(Some(Moving::Point(point))),
            None if name.names.len() == 1 && self.names.globals.contains_key(&name.names[0].text) => Ok(None),
            _ => Err(self.no_thing(name, direction, "a point that moves", "link spring: body - wheel { … }")),
        }
    }

    /// Reports why a name is not what is expected in a direction.
    pub fn no_thing(&mut self, name: &Dotted, direction: &str, expected: &str, example: &str) -> Reported {
        let (span, text) = (name.span(), name.to_string());
        let last = name.names.last().map(|name| name.text.clone()).unwrap_or_default();
        let home = match name.names.as_slice() {
            [home, _, ..] => &home.text,
            _ => direction,
        };
        let mistake = match self.names.find(name, direction) {
            Some((_, DirectionName::Broken)) => return Reported,
            Some((_, thing)) => mistakes::wrong_kind(span, &text, thing.kind(), expected, example),
            None => match self.names.off.get(&last) {
                Some(options) => mistakes::switched_off(span, &last, options),
                // An unknown factor of a stretch has been reported as an unknown value.
                None if self.names.unknown.contains(&(String::new(), last.clone())) => return Reported,
                None if !self.names.unknown.insert((home.to_string(), last)) => return Reported,
                None => self.unknown(name, direction),
            },
        };
        self.report(mistake)
    }

    fn unknown(&self, name: &Dotted, direction: &str) -> Diagnostic {
        let (home, last) = match name.names.as_slice() {
            [home, last, ..] if self.names.direction(&home.text).is_none() => {
                let known: Vec<String> = self.names.directions.iter().map(|(known, _)| known.clone()).collect();
                return mistakes::unknown_direction(home.span.join(last.span), &home.text, &known);
            }
            [home, last, ..] => (home.text.as_str(), last),
            [last] => (direction, last),
            [] => (direction, &Name::default()),
        };
        let place = if home.is_empty() {
            "the model".to_string()
        } else {
            format!("direction {home}")
        };
        mistakes::unknown_name(last.span, &last.text, &place, &self.names.known_things(home))
    }

    /// Fails if a name that is used outside of directions exists in several of them.
    pub fn unambiguous(&mut self, name: &Dotted) -> Resolved<()> {
        let [name] = name.names.as_slice() else { return Ok(()) };
        let homes: Vec<String> = self
            .names
            .everywhere(&name.text)
            .iter()
            .map(|(home, _)| home.to_string())
            .collect();
        if homes.len() < 2 {
            return Ok(());
        }
        Err(self.report(mistakes::ambiguous_direction(name.span, &name.text, &homes)))
    }
}
