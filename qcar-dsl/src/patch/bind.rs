//! Meaning of the names of an effect at a place: its variable, the ends and coefficients of links, its parameters.

use std::collections::BTreeMap;

use super::model_tree::{ModelTree, links};
use super::place::Place;
use super::rewrite::{self, binary, named};
use super::roles::Roles;
use super::scale::Scale;
use super::stretch::{lever, lower, upper};
use super::terms::is_term;
use super::{PatchResult, refused};
use crate::diagnostic::effects;
use crate::front::syntax::{
    CoordinateKind, Dotted, Effect, EffectParameter, Expression, ExpressionKind, LawStatement, Link, Name, Number,
    Operator, PlaceKind,
};

/// Properties of a link or mass, as written after a dot.
const FIELDS: [&str; 12] = [
    "upper",
    "lower",
    "stretch",
    "strut",
    "spring",
    "damper",
    "inerter",
    "mass",
    "force_scale",
    "travel_scale",
    "speed_scale",
    "acceleration_scale",
];

/// An effect at a place of a model, before any change.
pub struct Bindings<'a> {
    /// The model.
    pub base: &'a ModelTree,
    /// The roles of its parts.
    pub roles: &'a Roles,
    /// The effect.
    pub effect: &'a Effect,
    /// The place.
    pub place: &'a Place,
    /// New names of parameters whose names the model already uses.
    pub renamed: BTreeMap<String, String>,
    lever: Option<Expression>,
}

impl<'a> Bindings<'a> {
    /// Binds the names of an effect at a place.
    pub fn new(base: &'a ModelTree, roles: &'a Roles, effect: &'a Effect, place: &'a Place) -> Bindings<'a> {
        let link = base.link(&place.direction, &place.name);
        let lever = link.zip(effect.pattern.seen_from.as_ref());
        let lever = lever.and_then(|(link, point)| lever_of(base, roles, place, link, &point.text));
        Bindings {
            base,
            roles,
            effect,
            place,
            renamed: BTreeMap::new(),
            lever,
        }
    }

    /// The name in the model for a name in the effect; the variable means the place.
    pub fn name<'n>(&'n self, name: &'n Name) -> &'n str {
        if name.text == self.effect.pattern.variable.text {
            &self.place.name
        } else {
            &name.text
        }
    }

    /// The same along a direction. A word that is a role, and not a name in the model, means the part with this role.
    pub fn name_along(&self, name: &Name, direction: &str) -> String {
        let own = self.name(name);
        let meant = self.roles.meant(self.base, self.place.key(), direction, own);
        meant.filter(|_| own == name.text).unwrap_or(own.to_string())
    }

    /// An expression in the names of the model.
    pub fn expression(&self, e: &Expression, direction: &str) -> PatchResult<Expression> {
        rewrite::expression(e, &mut |name| self.meaning(name, direction))
    }

    fn meaning(&self, name: &Dotted, direction: &str) -> PatchResult<Option<Expression>> {
        match name.names.as_slice() {
            [own] => {
                let renamed = self.renamed.get(&own.text).cloned();
                let new = renamed.unwrap_or_else(|| self.name_along(own, direction));
                Ok((new != own.text).then(|| named(&new)))
            }
            [owner, field] if FIELDS.contains(&field.text.as_str()) => Ok(Some(self.field(owner, field, direction)?)),
            _ => Ok(None),
        }
    }

    /// The name of a point: `body`, `m` or `l.upper`.
    pub fn point(&self, name: &Dotted, direction: &str) -> PatchResult<String> {
        let meant = self.meaning(name, direction)?;
        Ok(match meant.map(|meant| meant.kind) {
            Some(ExpressionKind::Name(name)) => name.to_string(),
            _ => name.to_string(),
        })
    }

    /// The description of a parameter. One `at the wheel` is that of the place itself in a model without a wheel.
    pub fn doc(&self, of: &EffectParameter) -> String {
        let along = &self.place.direction;
        let lacks = |point: &&Name| {
            let meant = self.roles.meant(self.base, self.place.key(), along, &point.text);
            self.base
                .coordinate(along, meant.as_deref().unwrap_or(&point.text))
                .is_none()
        };
        let absent = self.effect.pattern.seen_from.as_ref().filter(lacks);
        let own = absent.and_then(|point| of.doc.strip_suffix(&format!(", at the {}", point.text)));
        own.unwrap_or(&of.doc).to_string()
    }

    fn field(&self, owner: &Name, field: &Name, direction: &str) -> PatchResult<Expression> {
        let name = &self.name_along(owner, direction);
        // The place belongs to its own direction; other directions may have points of the same names.
        let home = if *name == self.place.name {
            &self.place.direction
        } else {
            direction
        };
        if let Some(scale) = Scale::written(&field.text) {
            return Ok(self.scale(home, name, scale));
        }
        let found = match field.text.as_str() {
            "mass" => self.mass(direction, name),
            "upper" => self
                .link(home, name)
                .and_then(|link| Some(named(&upper(self.base, home, link)?))),
            "lower" => self
                .link(home, name)
                .and_then(|link| Some(named(&lower(self.base, home, link)?))),
            "stretch" => self.link(home, name).map(|link| link.stretch.clone()),
            "strut" => self.link(home, name).and_then(|link| self.strut(home, link)),
            kind => self.link(home, name).and_then(|link| self.coefficient(link, kind)),
        };
        found.ok_or_else(|| {
            let said = Dotted {
                names: vec![owner.clone(), field.clone()],
            };
            refused(effects::place_lacks(said.span(), &said.to_string(), name))
        })
    }

    /// A reference value. That of the place is per travel of the pattern's point; the force of a mass is its inertia
    /// force.
    fn scale(&self, direction: &str, name: &str, scale: Scale) -> Expression {
        if let (Scale::Force, Some(mass)) = (scale, self.mass(direction, name)) {
            return binary(
                Operator::Multiply,
                mass,
                named(&Scale::Acceleration.name(direction, name)),
            );
        }
        let own = named(&scale.name(direction, name));
        let lever = self.lever.as_ref().filter(|_| name == self.place.name);
        match (lever, scale) {
            (None, _) => own,
            (Some(lever), Scale::Force) => binary(Operator::Multiply, own, lever.clone()),
            (Some(lever), _) => binary(Operator::Divide, own, lever.clone()),
        }
    }

    /// The stretch of a link in series with the mount on its upper end.
    fn strut(&self, direction: &str, link: &Link) -> Option<Expression> {
        let end = |end: Option<String>| end.map(|end| self.base.pointed_at(direction, &end));
        let top = end(upper(self.base, direction, link))?;
        let mut mounts = links(self.base.direction(direction)?).filter(|mount| {
            self.roles.is_link(direction, &mount.name.text, "mount")
                && end(lower(self.base, direction, mount)).as_ref() == Some(&top)
        });
        let mount = mounts.next()?;
        Some(binary(Operator::Add, link.stretch.clone(), mount.stretch.clone()))
    }

    fn link(&self, direction: &str, name: &str) -> Option<&Link> {
        self.base.link(direction, name)
    }

    fn mass(&self, direction: &str, name: &str) -> Option<Expression> {
        match &self.base.coordinate(direction, name)?.kind {
            CoordinateKind::Mass(mass) | CoordinateKind::Inertia(mass) => Some(mass.clone()),
            _ => None,
        }
    }

    /// The sum of a link's linear terms of a kind; that of the place is per travel of the pattern's point.
    fn coefficient(&self, link: &Link, kind: &str) -> Option<Expression> {
        let terms = link.body.iter().filter(|statement| is_term(statement, kind));
        let values = terms.filter_map(|term| match term {
            LawStatement::Spring(value) | LawStatement::Damper(value) | LawStatement::Inerter(value) => {
                Some(value.clone())
            }
            _ => None,
        });
        let sum = values.reduce(|a, b| binary(Operator::Add, a, b))?;
        match &self.lever {
            Some(lever) if link.name.text == self.place.name => Some(per_square(sum, lever)),
            _ => Some(sum),
        }
    }

    /// True if a stretch contains that of the place; such a link has the same motion ratio.
    pub fn asks_for_stretch(&self, stretch: &Expression) -> bool {
        let mut found = false;
        rewrite::names_in(stretch, &mut |name| {
            let [owner, field] = name.names.as_slice() else { return };
            found |= ["stretch", "strut"].contains(&field.text.as_str()) && self.name(owner) == self.place.name;
        });
        found
    }

    /// A law in the names of the model, its stretch and forces per travel of the link itself.
    pub fn law(&self, body: &[LawStatement], link: &str, direction: &str) -> PatchResult<Vec<LawStatement>> {
        let own = rewrite::law(body, &mut |e| self.expression(e, direction))?;
        Ok(match (&self.lever, &self.effect.pattern.seen_from) {
            (Some(lever), Some(point)) if link == self.place.name => through_lever(own, lever, &point.text),
            _ => own,
        })
    }
}

fn lever_of(base: &ModelTree, roles: &Roles, place: &Place, link: &Link, point: &str) -> Option<Expression> {
    let meant = roles.meant(base, place.key(), &place.direction, point);
    lever(base, &place.direction, link, meant.as_deref().unwrap_or(point))
}

impl Bindings<'_> {
    /// True if the place of the effect moves in a direction: the mass, or the upper end of the link.
    pub fn moves_along(&self, direction: &str) -> bool {
        let name = match self.effect.pattern.kind {
            PlaceKind::Link => {
                let link = self.base.link(&self.place.direction, &self.place.name);
                let upper = link.and_then(|link| upper(self.base, &self.place.direction, link));
                self.base.pointed_at(&self.place.direction, &upper.unwrap_or_default())
            }
            PlaceKind::Mass | PlaceKind::Sensor | PlaceKind::Force => self.place.name.clone(),
        };
        self.base.coordinate(direction, &name).is_some()
    }
}

/// `k` if the coefficient is `k / r^2`, else `coefficient * r^2`.
fn per_square(coefficient: Expression, lever: &Expression) -> Expression {
    let square = squared(lever);
    match coefficient.kind {
        ExpressionKind::Binary(Operator::Divide, above, below) if *below == square => *above,
        _ => binary(Operator::Multiply, coefficient, square),
    }
}

fn squared(lever: &Expression) -> Expression {
    let two = Number {
        digits: "2".to_string(),
        ..Number::new(2.0)
    };
    binary(
        Operator::Power,
        lever.clone(),
        rewrite::made(ExpressionKind::Number(two)),
    )
}

/// Converts a law per travel of a point to one per travel of the link: `s_wheel = s / r`, and forces divided by `r`.
fn through_lever(law: Vec<LawStatement>, lever: &Expression, point: &str) -> Vec<LawStatement> {
    let mut lets = Vec::new();
    let mut body = in_travel_of_point(law, lever, point, &mut lets);
    lets.dedup();
    lets.append(&mut body);
    lets
}

fn in_travel_of_point(
    law: Vec<LawStatement>,
    lever: &Expression,
    point: &str,
    lets: &mut Vec<LawStatement>,
) -> Vec<LawStatement> {
    let mut rename = |name: &Dotted| {
        let own = name.to_string();
        let moves = own == "s" || own == "v";
        Ok::<_, std::convert::Infallible>(moves.then(|| {
            let new = format!("{own}_{point}");
            let definition = travel(&new, &own, lever);
            if !lets.contains(&definition) {
                lets.push(definition);
            }
            named(&new)
        }))
    };
    let Ok(law) = rewrite::law(&law, &mut |e| rewrite::expression(e, &mut rename));
    law.into_iter().map(|statement| divided(statement, lever)).collect()
}

fn travel(new: &str, own: &str, lever: &Expression) -> LawStatement {
    LawStatement::Let(crate::front::syntax::Let {
        name: Name::new(new),
        value: binary(Operator::Divide, named(own), lever.clone()),
        doc: String::new(),
    })
}

fn divided(statement: LawStatement, lever: &Expression) -> LawStatement {
    let over = |e: Expression, by: Expression| binary(Operator::Divide, e, by);
    match statement {
        LawStatement::Force(force) => LawStatement::Force(over(force, lever.clone())),
        LawStatement::Spring(k) => LawStatement::Spring(over(k, squared(lever))),
        LawStatement::Damper(c) => LawStatement::Damper(over(c, squared(lever))),
        LawStatement::Inerter(b) => LawStatement::Inerter(over(b, squared(lever))),
        LawStatement::Rolling(span, body) => {
            LawStatement::Rolling(span, body.into_iter().map(|inner| divided(inner, lever)).collect())
        }
        other => other,
    }
}
