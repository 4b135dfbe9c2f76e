//! Applies the changes of an effect to the tree of a model.

use super::bind::Bindings;
use super::model_tree::{ModelTree, rolling};
use super::rewrite::{self, binary, named};
use super::terms::is_term;
use super::{PatchResult, Signal, SignalChange, refused};
use crate::diagnostic::effects;
use crate::front::syntax::{
    Change, Dotted, EffectParameter, Expression, ExpressionKind, LawStatement, Let, Link, Name, Operator, Parameter,
    PlaceKind, Statement,
};
use crate::source::Span;

/// A model to which changes are applied.
pub struct Patching<'a> {
    bindings: Bindings<'a>,
    /// The model so far.
    pub tree: ModelTree,
    /// The effect's parameters so far, with their names in the model.
    pub parameters: Vec<(&'a EffectParameter, String)>,
    /// Errors of sensors, which do not change the model.
    pub signals: Vec<SignalChange>,
}

/// Applies all changes of an effect. Starts and ranges of its parameters are not set.
pub fn apply<'a>(mut bindings: Bindings<'a>) -> PatchResult<Patching<'a>> {
    let all = changes(&bindings);
    for (_, change) in &all {
        if let Change::Parameter(parameter) = change {
            rename(&mut bindings, parameter)?;
        }
    }
    let mut patching = Patching {
        tree: bindings.base.clone(),
        bindings,
        parameters: vec![],
        signals: vec![],
    };
    for (direction, change) in all {
        patching.change(&direction, change)?;
    }
    Ok(patching)
}

/// Every change with its direction.
fn changes<'a>(bindings: &Bindings<'a>) -> Vec<(String, &'a Change)> {
    let mut all = Vec::new();
    for change in bindings.effect.changes() {
        match change {
            Change::Direction { name, without, body } => {
                let absent = without
                    .iter()
                    .all(|name_| !bindings.base.declares(&name.text, &name_.text));
                let is_another = name.text != bindings.place.direction;
                if is_another && absent && bindings.moves_along(&name.text) {
                    all.extend(body.iter().map(|inner| (name.text.clone(), inner)));
                }
            }
            other => all.push((bindings.place.direction.clone(), other)),
        }
    }
    all
}

/// Renames a parameter whose name the model already uses: the name of the place is added.
fn rename(bindings: &mut Bindings, parameter: &EffectParameter) -> PatchResult<()> {
    let name = &parameter.name;
    let same = match bindings.base.global(&name.text) {
        None => return Ok(()),
        Some(Statement::Parameter(_)) if parameter.shared => return Ok(()),
        Some(Statement::Parameter(own)) => own.doc == parameter.doc,
        Some(_) => false,
    };
    let new = format!("{}_{}", name.text, bindings.place.name);
    if same || bindings.base.global(&new).is_some() {
        let mistake = effects::already_in_model(name.span, &name.text, &bindings.base.axle.name.text);
        return Err(refused(mistake));
    }
    bindings.renamed.insert(name.text.clone(), new);
    Ok(())
}

impl<'a> Patching<'a> {
    fn change(&mut self, direction: &str, change: &'a Change) -> PatchResult<()> {
        match change {
            Change::Parameter(parameter) => self.parameter(parameter),
            Change::Declare(statement) => return self.declare(direction, statement),
            Change::Take(part, mass) => return self.take(direction, part, mass),
            Change::Add(link, law) => return self.add(direction, link, law),
            Change::ReplaceTerm(term, link, law) => return self.replace_term(direction, (term, link), law),
            Change::ReplacePoint { point, of, by } => return self.replace_point(direction, point, of.as_ref(), by),
            Change::ReplaceStretch { of, by, rolling } => {
                return self.replace_stretch(direction, of, by, rolling.as_ref());
            }
            Change::PlaceSensor { end, of, at } => return self.place_sensor(direction, end.as_ref(), of, at),
            Change::Remove(link) => return self.remove(direction, link),
            Change::Delay(place, by) => self.sense(place, Signal::Delay, by),
            Change::Scale(place, by) if self.bindings.effect.pattern.kind == PlaceKind::Force => {
                self.scale_force(direction, place, by);
            }
            Change::Scale(place, by) => self.sense(place, Signal::Gain, by),
            Change::Direction { .. } => {}
        }
        Ok(())
    }

    fn parameter(&mut self, parameter: &'a EffectParameter) {
        let own = &parameter.name.text;
        let name = self.bindings.renamed.get(own).unwrap_or(own).clone();
        self.parameters.push((parameter, name));
    }

    /// Declares the parameters that the model's equations use, with their starts and ranges.
    pub fn declare_parameters(&mut self, declared: Vec<Parameter>) {
        let sensed = |p: &Parameter| self.signals.iter().any(|signal| signal.parameter == p.name.text);
        let declared: Vec<Statement> = declared
            .into_iter()
            .filter(|parameter| !sensed(parameter) && self.tree.global(&parameter.name.text).is_none())
            .map(Statement::Parameter)
            .collect();
        let body = &mut self.tree.axle.body;
        let place = after_last(body, |statement| matches!(statement, Statement::Parameter(_)));
        body.splice(place..place, declared);
    }

    fn declare(&mut self, direction: &str, statement: &Statement) -> PatchResult<()> {
        let bound = self.bound(direction, statement)?;
        if let Some(name) = statement.name() {
            let global = matches!(statement, Statement::Let(_)) && self.tree.global(&name.text).is_some();
            if global || self.tree.declares(direction, &name.text) {
                return Err(self.already(name));
            }
        }
        if let Statement::Let(_) = bound {
            let is_global = |s: &Statement| matches!(s, Statement::Parameter(_) | Statement::Let(_));
            let place = after_last(&self.tree.axle.body, is_global);
            self.tree.axle.body.insert(place, bound);
            return Ok(());
        }
        let Some(home) = self.tree.direction_mut(direction) else {
            return Ok(());
        };
        let same = std::mem::discriminant(&bound);
        let place = after_last(&home.body, |statement| std::mem::discriminant(statement) == same);
        home.body.insert(place, bound);
        Ok(())
    }

    fn bound(&self, direction: &str, statement: &Statement) -> PatchResult<Statement> {
        let bindings = &self.bindings;
        let mut value = |e: &Expression| bindings.expression(e, direction);
        Ok(match statement {
            Statement::Let(definition) => Statement::Let(Let {
                value: value(&definition.value)?,
                ..definition.clone()
            }),
            Statement::Coordinate(own) => Statement::Coordinate(rewrite::coordinate(own, &mut value)?),
            Statement::Link(link) => {
                let moves_with_place = bindings.asks_for_stretch(&link.stretch);
                let like = if moves_with_place {
                    &bindings.place.name
                } else {
                    &link.name.text
                };
                Statement::Link(Link {
                    stretch: value(&link.stretch)?,
                    body: bindings.law(&link.body, like, direction)?,
                    ..link.clone()
                })
            }
            Statement::Point(name, target) => Statement::Point(name.clone(), self.end(target, direction)?),
            Statement::Output(name, signal) => Statement::Output(name.clone(), self.signal(signal)),
            Statement::Channel(name, a, b) => Statement::Channel(name.clone(), self.signal(a), self.signal(b)),
            other => other.clone(),
        })
    }

    /// The expression of a point of the effect: a mass, an end of the place, or a combination of them.
    fn end(&self, target: &Expression, direction: &str) -> PatchResult<Expression> {
        let ExpressionKind::Name(name) = &target.kind else {
            return self.bindings.expression(target, direction);
        };
        let meant = self.bindings.point(name, direction)?;
        if meant != name.to_string() {
            return Ok(named(&meant));
        }
        let kind = ExpressionKind::Name(self.signal(name));
        Ok(Expression { kind, ..target.clone() })
    }

    /// `m.acceleration` of the place.
    fn signal(&self, path: &Dotted) -> Dotted {
        let name = |name: &Name| Name {
            text: self.bindings.name(name).to_string(),
            span: name.span,
        };
        Dotted {
            names: path.names.iter().map(name).collect(),
        }
    }

    fn already(&self, name: &Name) -> super::Refusal {
        refused(effects::already_in_model(
            name.span,
            &name.text,
            &self.tree.axle.name.text,
        ))
    }

    fn take(&mut self, direction: &str, part: &Expression, mass: &Dotted) -> PatchResult<()> {
        let part = self.bindings.expression(part, direction)?;
        let name = self.bindings.point(mass, direction)?;
        match self.tree.inertia_mut(direction, &name) {
            Some(whole) => *whole = binary(Operator::Subtract, whole.clone(), part),
            None => return Err(refused(effects::place_lacks(mass.span(), &mass.to_string(), &name))),
        }
        Ok(())
    }

    fn add(&mut self, direction: &str, name: &Name, law: &[LawStatement]) -> PatchResult<()> {
        let (direction, link) = self.meant_link(direction, name)?;
        let law = self.bindings.law(law, &link, &direction)?;
        if let Some(link) = self.tree.link_mut(&direction, &link) {
            if let Some(state) = law.iter().find(|statement| has_state(&link.body, statement)) {
                return Err(refused(effects::already_in_link(
                    state_span(state),
                    &state_name(state),
                    &link.name.text,
                )));
            }
            extend(&mut link.body, law);
        }
        Ok(())
    }

    fn replace_term(&mut self, direction: &str, (term, name): (&Name, &Name), law: &[LawStatement]) -> PatchResult<()> {
        let (home, link) = self.meant_link(direction, name)?;
        let law = self.bindings.law(law, &link, &home)?;
        let Some(link) = self.tree.link_mut(&home, &link) else {
            return Ok(());
        };
        if !link.body.iter().any(|statement| is_term(statement, &term.text)) {
            let expected = format!("{}.{}", name.text, term.text);
            return Err(refused(effects::place_lacks(term.span, &expected, &link.name.text)));
        }
        link.body.retain(|statement| !is_term(statement, &term.text));
        if let Some(body) = rolling_mut(&mut link.body) {
            body.retain(|statement| !is_term(statement, &term.text));
        }
        extend(&mut link.body, law);
        Ok(())
    }

    /// The direction and name of the link that a name means; for the variable, those of the place.
    fn meant_link(&self, direction: &str, name: &Name) -> PatchResult<(String, String)> {
        let link = &self.bindings.name_along(name, direction);
        let home = if *link == self.bindings.place.name {
            &self.bindings.place.direction
        } else {
            direction
        };
        match self.tree.link(home, link) {
            Some(_) => Ok((home.to_string(), link.to_string())),
            None => Err(refused(effects::place_lacks(name.span, &name.text, link))),
        }
    }

    fn replace_point(
        &mut self,
        direction: &str,
        point: &Dotted,
        of: Option<&Name>,
        by: &Expression,
    ) -> PatchResult<()> {
        let (old, new) = (
            self.bindings.point(point, direction)?,
            self.bindings.expression(by, direction)?,
        );
        let only = match of {
            Some(link) => Some(self.meant_link(direction, link)?),
            None => None,
        };
        let home = only.as_ref().map_or(direction, |(home, _)| home).to_string();
        let declared = self.bindings.base.direction(&home);
        let known: Vec<String> = declared
            .into_iter()
            .flat_map(super::model_tree::links)
            .map(|link| link.name.text.clone())
            .collect();
        let Some(home) = self.tree.direction_mut(&home) else {
            return Ok(());
        };
        for statement in &mut home.body {
            let Statement::Link(link) = statement else { continue };
            // Links that the effect itself declares keep their points.
            let is_meant = only.as_ref().is_none_or(|(_, only)| link.name.text == *only);
            if is_meant && known.contains(&link.name.text) {
                link.stretch = with_point(&link.stretch, &old, &new, only.is_some());
            }
        }
        Ok(())
    }

    /// Replaces the stretch in the law of a link. Linear terms do not contain `s`, so they do not change.
    fn replace_stretch(
        &mut self,
        direction: &str,
        of: &Name,
        by: &Expression,
        rolling: Option<&Expression>,
    ) -> PatchResult<()> {
        let (home, link) = self.meant_link(direction, of)?;
        let by = self.bindings.expression(by, &home)?;
        let rolling = rolling.map(|by| self.bindings.expression(by, &home)).transpose()?;
        let Some(link) = self.tree.link_mut(&home, &link) else {
            return Ok(());
        };
        if link
            .body
            .iter()
            .any(|statement| matches!(statement, LawStatement::Use(_)))
        {
            let expected = "a law without elements";
            return Err(refused(effects::place_lacks(of.span, expected, &link.name.text)));
        }
        for statement in &mut link.body {
            let by = match statement {
                LawStatement::Rolling(..) => rolling.as_ref(),
                _ => Some(&by),
            };
            if let Some(by) = by {
                *statement = in_other_stretch(statement, by);
            }
        }
        Ok(())
    }

    fn remove(&mut self, direction: &str, name: &Name) -> PatchResult<()> {
        let (home, link) = self.meant_link(direction, name)?;
        if let Some(home) = self.tree.direction_mut(&home) {
            home.body
                .retain(|statement| !matches!(statement, Statement::Link(own) if own.name.text == link));
        }
        Ok(())
    }

    /// Adds the point at which a sensor is mounted. If the model declares outputs, its acceleration becomes one.
    fn place_sensor(&mut self, direction: &str, end: Option<&Name>, of: &Dotted, at: &Expression) -> PatchResult<()> {
        let mass = self.bindings.point(of, direction)?;
        let mass = self.bindings.base.pointed_at(direction, &mass);
        if self.bindings.base.coordinate(direction, &mass).is_none() {
            return Err(refused(effects::place_lacks(of.span(), &of.to_string(), &mass)));
        }
        let point = Name {
            text: format!("{mass}_{}", end.map_or("sensor", |end| &end.text)),
            span: of.span(),
        };
        self.declare(direction, &Statement::Point(point.clone(), at.clone()))?;
        if !self.tree.declares_outputs() {
            return Ok(());
        }
        let acceleration = Dotted {
            names: vec![point, Name::new("acceleration")],
        };
        self.declare(direction, &Statement::Output(None, acceleration))
    }

    /// Multiplies a force input by a factor.
    fn scale_force(&mut self, direction: &str, place: &Name, by: &Name) {
        let name = self.bindings.name(place).to_string();
        let by = self.bindings.renamed.get(&by.text).unwrap_or(&by.text).clone();
        let body = self.tree.direction_mut(direction).map(|home| &mut home.body);
        for statement in body.into_iter().flatten() {
            if let Statement::Force(own, Some(on)) = statement
                && own.text == name
            {
                *on = binary(Operator::Multiply, named(&by), on.clone());
            }
        }
    }

    fn sense(&mut self, place: &Name, kind: Signal, by: &Name) {
        self.signals.push(SignalChange {
            location: self.bindings.name(place).to_string(),
            axis: self.bindings.place.direction.clone(),
            kind,
            parameter: by.text.clone(),
        });
    }

    /// The description of a parameter of the effect.
    pub fn doc(&self, of: &EffectParameter) -> String {
        self.bindings.doc(of)
    }

    /// An expression of the effect in the names of the model.
    pub fn meaning(&self, e: &Expression) -> PatchResult<Expression> {
        self.bindings.expression(e, &self.bindings.place.direction)
    }
}

/// A stretch in which an expression replaces a point: only its first occurrence if `once`, else all.
fn with_point(stretch: &Expression, old: &str, new: &Expression, once: bool) -> Expression {
    let mut left = if once { 1 } else { usize::MAX };
    let mut rename = |name: &Dotted| {
        let found = name.to_string() == old && left > 0;
        left -= usize::from(found);
        Ok::<_, std::convert::Infallible>(found.then(|| new.clone()))
    };
    let Ok(changed) = rewrite::expression(stretch, &mut rename);
    changed
}

/// A statement of a law in which an expression replaces the stretch.
fn in_other_stretch(statement: &LawStatement, by: &Expression) -> LawStatement {
    let mut rename = |name: &Dotted| {
        let found = name.to_string() == "s";
        Ok::<_, std::convert::Infallible>(found.then(|| by.clone()))
    };
    let one = std::slice::from_ref(statement);
    let Ok(mut changed) = rewrite::law(one, &mut |e| rewrite::expression(e, &mut rename));
    changed.pop().unwrap_or_else(|| statement.clone())
}

/// Adds statements to a law. Its `rolling` block gets their forces for rolling, or the same forces if they have none.
fn extend(body: &mut Vec<LawStatement>, law: Vec<LawStatement>) {
    let own_rolling = rolling(&law).cloned();
    let (_, standing): (Vec<_>, Vec<_>) = law.into_iter().partition(|s| matches!(s, LawStatement::Rolling(..)));
    if let Some(rolls) = rolling_mut(body) {
        let forces = standing.iter().filter(|statement| is_force(statement)).cloned();
        rolls.extend(own_rolling.unwrap_or_else(|| forces.collect()));
    }
    let place = body
        .iter()
        .position(|s| matches!(s, LawStatement::Rolling(..)))
        .unwrap_or(body.len());
    let new = standing
        .into_iter()
        .filter(|statement| !body.contains(statement) || is_force(statement))
        .collect::<Vec<_>>();
    body.splice(place..place, new);
}

fn is_force(statement: &LawStatement) -> bool {
    use LawStatement::*;
    matches!(statement, Spring(_) | Damper(_) | Inerter(_) | Force(_) | Use(_))
}

fn rolling_mut(law: &mut [LawStatement]) -> Option<&mut Vec<LawStatement>> {
    law.iter_mut().find_map(|statement| match statement {
        LawStatement::Rolling(_, body) => Some(body),
        _ => None,
    })
}

fn has_state(law: &[LawStatement], statement: &LawStatement) -> bool {
    let LawStatement::State(name, _) = statement else {
        return false;
    };
    law.iter()
        .any(|own| matches!(own, LawStatement::State(known, _) if known.text == name.text))
}

fn state_name(statement: &LawStatement) -> String {
    match statement {
        LawStatement::State(name, _) => name.text.clone(),
        _ => String::new(),
    }
}

fn state_span(statement: &LawStatement) -> Span {
    match statement {
        LawStatement::State(name, _) => name.span,
        _ => Span::default(),
    }
}

/// The position after the last statement of a kind; before the first direction if there is none.
fn after_last(body: &[Statement], kind: impl Fn(&Statement) -> bool) -> usize {
    let last = body.iter().rposition(kind).map(|place| place + 1);
    let first_direction = || body.iter().position(|s| matches!(s, Statement::Direction(_)));
    last.or_else(first_direction).unwrap_or(body.len())
}
