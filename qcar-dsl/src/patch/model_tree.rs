//! A model as a tree that can be queried and changed. Its options are resolved, and parts that are zero are left out.

use super::rewrite;
use crate::check::Checked;
use crate::front::syntax::{
    Axle, AxleKind, Coordinate, CoordinateKind, Direction, Element, Expression, ExpressionKind, File, Item,
    LawStatement, Link, Name, Operator, Parameter, Statement,
};
use crate::hash::HashSet;
use crate::units::Unit;

/// The tree of a plain axle.
#[derive(Clone, Debug)]
pub struct ModelTree {
    /// The axle.
    pub axle: Axle,
    /// The elements that its laws use.
    elements: Vec<Element>,
    /// The links and coordinates whose motion is an angle, with their directions.
    angles: HashSet<(String, String)>,
}

impl ModelTree {
    /// The tree of a model's text; empty for a model without text.
    pub fn of(model: &Checked) -> ModelTree {
        let mut base = ModelTree {
            axle: Axle {
                kind: AxleKind::Plain,
                name: Name::new(&model.name),
                doc: String::new(),
                body: vec![],
            },
            elements: vec![],
            angles: angles(model),
        };
        for item in &model.tree().items {
            match item {
                Item::Axle(axle) => base.axle = axle.clone(),
                Item::Element(element) => base.elements.push(element.clone()),
                Item::Effect(_) => {}
            }
        }
        base.leave_out_zeros();
        base
    }

    /// The model as a file.
    pub fn file(&self) -> File {
        let elements = self.elements.iter().cloned().map(Item::Element);
        File {
            items: elements.chain([Item::Axle(self.axle.clone())]).collect(),
        }
    }

    /// The directions, in the order of the text.
    pub fn directions(&self) -> impl Iterator<Item = &Direction> {
        self.axle.body.iter().filter_map(|statement| match statement {
            Statement::Direction(direction) => Some(direction),
            _ => None,
        })
    }

    /// A direction.
    pub fn direction(&self, name: &str) -> Option<&Direction> {
        self.directions().find(|direction| direction.name.text == name)
    }

    /// A direction, to be changed.
    pub fn direction_mut(&mut self, name: &str) -> Option<&mut Direction> {
        self.axle.body.iter_mut().find_map(|statement| match statement {
            Statement::Direction(direction) if direction.name.text == name => Some(direction),
            _ => None,
        })
    }

    /// A link of a direction.
    pub fn link(&self, direction: &str, name: &str) -> Option<&Link> {
        let mut links = links(self.direction(direction)?);
        links.find(|link| link.name.text == name)
    }

    /// A link of a direction, to be changed.
    pub fn link_mut(&mut self, direction: &str, name: &str) -> Option<&mut Link> {
        let body = &mut self.direction_mut(direction)?.body;
        body.iter_mut().find_map(|statement| match statement {
            Statement::Link(link) if link.name.text == name => Some(link),
            _ => None,
        })
    }

    /// A coordinate, by its name or that of a point of it.
    pub fn coordinate(&self, direction: &str, name: &str) -> Option<&Coordinate> {
        let name = self.pointed_at(direction, name);
        coordinates(self.direction(direction)?).find(|coordinate| coordinate.name.text == name)
    }

    /// True if the stretch of this link, or the motion of this coordinate or point, is an angle.
    pub fn turns(&self, direction: &str, name: &str) -> bool {
        let name = self.pointed_at(direction, name);
        self.angles.contains(&(direction.to_string(), name))
    }

    /// The inertia of a mass, to be changed.
    pub fn inertia_mut(&mut self, direction: &str, name: &str) -> Option<&mut Expression> {
        let name = self.pointed_at(direction, name);
        let body = &mut self.direction_mut(direction)?.body;
        body.iter_mut().find_map(|statement| match statement {
            Statement::Coordinate(Coordinate {
                name: own,
                kind: CoordinateKind::Mass(inertia) | CoordinateKind::Inertia(inertia),
                ..
            }) if own.text == name => Some(inertia),
            _ => None,
        })
    }

    /// The coordinate that a point renames, directly or through other points; any other name is returned unchanged.
    pub fn pointed_at(&self, direction: &str, name: &str) -> String {
        let target = match self.point(direction, name).map(|target| &target.kind) {
            Some(ExpressionKind::Name(target)) => target.names.last(),
            _ => None,
        };
        match target {
            Some(target) => self.pointed_at(direction, &target.text),
            None => name.to_string(),
        }
    }

    /// The expression of a named point; `None` if there is no such point.
    pub fn point(&self, direction: &str, name: &str) -> Option<&Expression> {
        self.direction(direction)?
            .body
            .iter()
            .find_map(|statement| match statement {
                Statement::Point(point, target) if point.text == name => Some(target),
                _ => None,
            })
    }

    /// True if the model declares outputs.
    pub fn declares_outputs(&self) -> bool {
        let inside = self.directions().flat_map(|direction| &direction.body);
        let mut all = self.axle.body.iter().chain(inside);
        all.any(|statement| matches!(statement, Statement::Output(..)))
    }

    /// Parameters and derived quantities, in the order of the text.
    pub fn globals(&self) -> impl Iterator<Item = &Statement> {
        let inside = self.directions().flat_map(|direction| &direction.body);
        let all = self.axle.body.iter().chain(inside);
        all.filter(|statement| matches!(statement, Statement::Parameter(_) | Statement::Let(_)))
    }

    /// The parameters, to be changed.
    pub fn parameters_mut(&mut self) -> impl Iterator<Item = &mut Parameter> {
        let statements = self.axle.body.iter_mut().flat_map(|statement| match statement {
            Statement::Direction(direction) => direction.body.iter_mut().collect(),
            other => vec![other],
        });
        statements.filter_map(|statement| match statement {
            Statement::Parameter(parameter) => Some(parameter),
            _ => None,
        })
    }

    /// The parameter or derived quantity of a name.
    pub fn global(&self, name: &str) -> Option<&Statement> {
        self.globals()
            .find(|statement| statement.name().is_some_and(|own| own.text == name))
    }

    /// True if a direction declares a name.
    pub fn declares(&self, direction: &str, name: &str) -> bool {
        let body = self.direction(direction).map(|direction| direction.body.as_slice());
        let mut names = body.unwrap_or_default().iter().filter_map(Statement::name);
        names.any(|own| own.text == name)
    }

    /// Changes every expression of the model, stretches and laws included.
    pub fn change_expressions(&mut self, change: &mut dyn FnMut(&Expression) -> Expression) {
        change_all(&mut self.axle.body, change);
    }

    /// Removes quantities that are zero: an option that removes a part leaves `let m_part = 0 kg;`, whose name an
    /// effect may use.
    fn leave_out_zeros(&mut self) {
        let is_zero = |statement: &Statement| matches!(statement, Statement::Let(let_) if is_zero(&let_.value));
        let (zeros, body): (Vec<_>, Vec<_>) = std::mem::take(&mut self.axle.body).into_iter().partition(is_zero);
        self.axle.body = body;
        for zero in &zeros {
            if let Statement::Let(zero) = zero {
                self.change_expressions(&mut |e| without(e, &zero.name.text, &zero.value));
            }
        }
    }
}

fn angles(model: &Checked) -> HashSet<(String, String)> {
    let links = model.links.iter().filter(|link| link.unit == Unit::ONE);
    let links = links.map(|link| (link.direction.0.clone(), link.name.clone()));
    let coordinates = model.coordinates.iter().filter(|coordinate| coordinate.angle);
    let coordinates = coordinates.map(|own| (own.direction.0.clone(), own.name.clone()));
    let points = model.points.iter().filter(|point| point.angle);
    let points = points.map(|point| (point.direction.0.clone(), point.name.clone()));
    links.chain(coordinates).chain(points).collect()
}

/// The links of a direction.
pub fn links(direction: &Direction) -> impl Iterator<Item = &Link> {
    direction.body.iter().filter_map(|statement| match statement {
        Statement::Link(link) => Some(link),
        _ => None,
    })
}

/// The coordinates of a direction.
pub fn coordinates(direction: &Direction) -> impl Iterator<Item = &Coordinate> {
    direction.body.iter().filter_map(|statement| match statement {
        Statement::Coordinate(coordinate) => Some(coordinate),
        _ => None,
    })
}

/// The `rolling` block of a law.
pub fn rolling(law: &[LawStatement]) -> Option<&Vec<LawStatement>> {
    law.iter().find_map(|statement| match statement {
        LawStatement::Rolling(_, body) => Some(body),
        _ => None,
    })
}

fn change_all(body: &mut [Statement], change: &mut dyn FnMut(&Expression) -> Expression) {
    let mut safe = |e: &Expression| Ok::<_, std::convert::Infallible>(change(e));
    for statement in body {
        match statement {
            Statement::Let(definition) => {
                let Ok(value) = safe(&definition.value);
                definition.value = value;
            }
            Statement::Coordinate(coordinate) => {
                let Ok(changed) = rewrite::coordinate(coordinate, &mut safe);
                *coordinate = changed;
            }
            Statement::Force(_, Some(on)) | Statement::Point(_, on) => {
                let Ok(changed) = safe(on);
                *on = changed;
            }
            Statement::Link(link) => {
                let (Ok(stretch), Ok(law)) = (safe(&link.stretch), rewrite::law(&link.body, &mut safe));
                (link.stretch, link.body) = (stretch, law);
            }
            Statement::Direction(direction) => change_all(&mut direction.body, &mut |e| {
                let Ok(changed) = safe(e);
                changed
            }),
            _ => {}
        }
    }
}

fn is_zero(e: &Expression) -> bool {
    matches!(&e.kind, ExpressionKind::Number(number) if number.value == 0.0)
}

/// An expression without the summands that are a name of zero; elsewhere, zero replaces the name.
fn without(e: &Expression, name: &str, zero: &Expression) -> Expression {
    let is_it = |e: &Expression| matches!(&e.kind, ExpressionKind::Name(own) if own.to_string() == name);
    if let ExpressionKind::Binary(operator @ (Operator::Add | Operator::Subtract), a, b) = &e.kind {
        return match (is_it(a), is_it(b)) {
            (_, true) => without(a, name, zero),
            (true, false) if *operator == Operator::Add => without(b, name, zero),
            _ => rewrite::binary(*operator, without(a, name, zero), without(b, name, zero)),
        };
    }
    let mut rename = |own: &crate::front::syntax::Dotted| {
        let found = own.to_string() == name;
        Ok::<_, std::convert::Infallible>(found.then(|| zero.clone()))
    };
    let Ok(replaced) = rewrite::expression(e, &mut rename);
    replaced
}
