//! Laws: terms, inner states and expanded elements.

use super::value::{Locals, Value};
use super::{Reported, Resolved, Resolver};
use crate::diagnostic::{names, reading, units as mistakes};
use crate::expr::{Expr, LinkId, Symbol};
use crate::front::syntax::{Element, ElementUse, Expression, LawStatement, Name, UnitText};
use crate::model::{Inner, Law, Term};
use crate::units::Unit;

/// A law that is being built.
struct LawBuilder {
    link: LinkId,
    /// Unit of the stretch, m or 1.
    stretch: Unit,
    terms: Vec<Term>,
    inner: Vec<Inner>,
    /// For each inner state, whether its rate has been given.
    rated: Vec<bool>,
    /// True inside `rolling`, which replaces forces but keeps the states.
    rolling: bool,
    /// True if it is declared `active`.
    active: bool,
    /// True if a part of it has a mistake, or uses a name whose declaration has one.
    mistaken: bool,
}

impl LawBuilder {
    /// The unit of the force, by virtual work.
    fn force(&self) -> Unit {
        force_unit(self.stretch)
    }

    fn state(&self, name: &str) -> Option<usize> {
        self.inner.iter().position(|inner| inner.name == name)
    }
}

/// The unit of the force of a stretch, by virtual work: N, or N m for an angle.
pub fn force_unit(stretch: Unit) -> Unit {
    Unit::NEWTON.times(Unit::METER).per(stretch)
}

/// A position in a law: the visible names, and the elements that are being expanded.
#[derive(Clone)]
struct Place {
    locals: Locals,
    /// Prefix of the names of states, such as `dahl.`.
    prefix: String,
    /// The enclosing elements, outermost first.
    inside: Vec<String>,
}

impl Resolver<'_> {
    /// The law of a link, and its terms while rolling if it has a `rolling` block.
    pub fn law(
        &mut self,
        body: &[LawStatement],
        direction: &str,
        link: LinkId,
        stretch: Unit,
    ) -> Resolved<(Law, Option<Vec<Term>>)> {
        let (terms, inner, rated) = (vec![], vec![], vec![]);
        let mut builder = LawBuilder {
            link,
            stretch,
            terms,
            inner,
            rated,
            rolling: false,
            active: false,
            mistaken: false,
        };
        let mut place = Place {
            locals: Locals {
                home: Some(direction.to_string()),
                ..Locals::default()
            },
            prefix: String::new(),
            inside: vec![],
        };
        self.add_stretch(&mut place.locals, &builder);
        self.add_statements(body, &mut place, &mut builder);
        let terms = std::mem::take(&mut builder.terms);
        let rolling = self.rolling(body, &place, &mut builder);
        if builder.mistaken {
            return Err(Reported);
        }
        Ok((
            Law {
                terms,
                inner: builder.inner,
                active: builder.active,
            },
            rolling,
        ))
    }

    /// The terms of the `rolling` block; `None` without one.
    fn rolling(&mut self, body: &[LawStatement], place: &Place, builder: &mut LawBuilder) -> Option<Vec<Term>> {
        builder.rolling = true;
        let mut terms = None;
        for statement in body {
            let LawStatement::Rolling(span, body) = statement else {
                continue;
            };
            if terms.is_some() {
                self.report(mistakes::second_rolling(*span));
                builder.mistaken = true;
            }
            self.add_statements(body, &mut place.clone(), builder);
            terms = Some(std::mem::take(&mut builder.terms));
        }
        terms
    }

    /// Adds the names `s` and `v`.
    fn add_stretch(&mut self, locals: &mut Locals, builder: &LawBuilder) {
        let graph = &mut self.model.graph;
        let (s, v) = (
            graph.symbol(Symbol::Stretch(builder.link)),
            graph.symbol(Symbol::Rate(builder.link)),
        );
        locals.add(
            "s",
            Ok(Value {
                expr: s,
                unit: Some(builder.stretch),
            }),
        );
        locals.add(
            "v",
            Ok(Value {
                expr: v,
                unit: Some(builder.stretch.per(Unit::SECOND)),
            }),
        );
    }

    /// Adds the terms, states and rates of statements. Statements with mistakes are reported and left out.
    fn add_statements(&mut self, body: &[LawStatement], place: &mut Place, builder: &mut LawBuilder) {
        for statement in body {
            if let LawStatement::State(name, unit) = statement {
                let value = self.state(name, unit, place, builder);
                builder.mistaken |= value.is_err();
                place.locals.add(&name.text, value);
            }
        }
        for statement in body {
            // A mistake leaves out its own statement only.
            builder.mistaken |= self.add_statement(statement, place, builder).is_err();
        }
        self.require_rates(body, place, builder);
    }

    fn add_statement(&mut self, statement: &LawStatement, place: &mut Place, builder: &mut LawBuilder) -> Resolved<()> {
        let stiffness = builder.force().per(builder.stretch);
        let damping = stiffness.times(Unit::SECOND);
        match statement {
            LawStatement::Spring(k) => {
                let k = self.coefficient(k, place, stiffness, "the stiffness of a spring")?;
                builder.terms.push(Term::Spring(k));
            }
            LawStatement::Damper(c) => {
                let c = self.coefficient(c, place, damping, "the damping of a damper")?;
                builder.terms.push(Term::Damper(c));
            }
            LawStatement::Inerter(b) => {
                let b = self.coefficient(b, place, damping.times(Unit::SECOND), "the inertance of an inerter")?;
                builder.terms.push(Term::Inerter(b));
            }
            LawStatement::Force(force) => {
                let force = self.value_in(force, &place.locals, builder.force(), "a force")?;
                builder.terms.push(Term::Force(force));
            }
            LawStatement::Let(definition) => {
                let value = self.value(&definition.value, &place.locals);
                builder.mistaken |= value.is_err();
                place.locals.add(&definition.name.text, value);
            }
            LawStatement::Rate(name, rate) => self.rate(name, rate, place, builder)?,
            LawStatement::Use(element) => self.expand_element(element, place, builder)?,
            LawStatement::Rolling(span, _) if builder.rolling || !place.inside.is_empty() => {
                return Err(self.report(mistakes::second_rolling(*span)));
            }
            LawStatement::If(choice) => {
                let span = choice
                    .branches
                    .first()
                    .map(|(condition, _)| condition.first_test().option.span);
                let home = "a link: an element has no options";
                return Err(self.report(reading::misplaced_statement(span.unwrap_or_default(), "if", home)));
            }
            LawStatement::Active => builder.active = true,
            LawStatement::State(..) | LawStatement::Rolling(..) => {}
        }
        Ok(())
    }

    /// The factor of a linear term, which must not vary with the motion.
    fn coefficient(&mut self, expression: &Expression, place: &Place, unit: Unit, what: &str) -> Resolved<Expr> {
        let expr = self.value_in(expression, &place.locals, unit, what)?;
        let leaves = self.model.graph.symbols([expr]);
        if !leaves.iter().all(|leaf| matches!(leaf, Symbol::Parameter(_))) {
            return Err(self.report(mistakes::coefficient_varies(expression.span, what)));
        }
        Ok(expr)
    }

    fn state(&mut self, name: &Name, unit: &UnitText, place: &Place, builder: &mut LawBuilder) -> Resolved<Value> {
        let unit = self.coherent(unit, unit.span, |coherent| format!("state {}: {coherent};", name.text))?;
        let full = format!("{}{}", place.prefix, name.text);
        let index = match (builder.state(&full), builder.rolling) {
            (Some(index), true) if !place.inside.is_empty() => index,
            (_, true) => return Err(self.report(mistakes::rolling_changes_states(name.span))),
            (Some(_), false) => return Err(self.report(mistakes::second_state(name.span, &full, None))),
            (None, false) => {
                let rate = self.model.graph.constant(0.0);
                builder.inner.push(Inner { name: full, unit, rate });
                builder.rated.push(false);
                builder.inner.len() - 1
            }
        };
        let expr = self.model.graph.symbol(Symbol::Inner(builder.link, index as u16));
        Ok(Value { expr, unit: Some(unit) })
    }

    fn rate(&mut self, name: &Name, rate: &Expression, place: &Place, builder: &mut LawBuilder) -> Resolved<()> {
        if builder.rolling {
            // Inside `rolling`, the states of an element keep their rates, and the block itself cannot give rates.
            let is_own = place.inside.is_empty();
            return if is_own {
                Err(self.report(mistakes::rolling_changes_states(name.span)))
            } else {
                Ok(())
            };
        }
        let Some(index) = builder.state(&format!("{}{}", place.prefix, name.text)) else {
            if matches!(place.locals.get(&name.text), Some(Err(Reported))) {
                return Err(Reported);
            }
            let unit = self
                .value(rate, &place.locals)
                .map(|rate| rate.unit.unwrap_or(Unit::ONE).times(Unit::SECOND));
            let unit = unit.unwrap_or(Unit::NEWTON).to_string();
            return Err(self.report(mistakes::rate_without_state(name.span, &name.text, &unit)));
        };
        if std::mem::replace(&mut builder.rated[index], true) {
            return Err(self.report(mistakes::second_rate(name.span, &name.text)));
        }
        let unit = builder.inner[index].unit.per(Unit::SECOND);
        builder.inner[index].rate =
            self.value_in(rate, &place.locals, unit, &format!("the rate of `{}`", name.text))?;
        Ok(())
    }

    fn require_rates(&mut self, body: &[LawStatement], place: &Place, builder: &LawBuilder) {
        for statement in body {
            let LawStatement::State(name, _) = statement else {
                continue;
            };
            let index = builder.state(&format!("{}{}", place.prefix, name.text));
            if index.is_some_and(|index| !builder.rated[index]) {
                self.report(mistakes::state_without_rate(name.span, &name.text));
            }
        }
    }

    fn expand_element(&mut self, used: &ElementUse, place: &Place, builder: &mut LawBuilder) -> Resolved<()> {
        let name = &used.element;
        let Some(element) = self.elements.get(name.text.as_str()).copied() else {
            if !self.names.unknown.insert(("the elements".into(), name.text.clone())) {
                return Err(Reported);
            }
            let known: Vec<String> = self.elements.keys().map(ToString::to_string).collect();
            return Err(self.report(names::unknown_element(name.span, &name.text, &known)));
        };
        self.names.used.insert(name.text.clone());
        let mut inside = place.inside.clone();
        inside.push(name.text.clone());
        if place.inside.contains(&name.text) {
            inside.reverse();
            return Err(self.report(names::recursive_element(name.span, &inside)));
        }
        let prefix = format!("{}{}.", place.prefix, used.label().text);
        if let Some(state) = builder
            .inner
            .iter()
            .find(|inner| inner.name.starts_with(&prefix) && !builder.rolling)
        {
            let mistake = mistakes::second_state(used.label().span, &state.name, Some(&name.text));
            return Err(self.report(mistake));
        }
        let mut locals = self.element_arguments(element, used, place)?;
        self.add_stretch(&mut locals, builder);
        self.add_statements(&element.body, &mut Place { locals, prefix, inside }, builder);
        Ok(())
    }

    fn element_arguments(&mut self, element: &Element, used: &ElementUse, place: &Place) -> Resolved<Locals> {
        let values: Vec<_> = used
            .arguments
            .iter()
            .map(|argument| self.value(argument, &place.locals))
            .collect();
        if values.len() != element.arguments.len() {
            let expected: Vec<String> = element
                .arguments
                .iter()
                .map(|(name, unit)| format!("{}: {unit}", name.text))
                .collect();
            let name = &used.element;
            return Err(self.report(names::wrong_arguments(name.span, &name.text, &expected, values.len())));
        }
        let mut locals = Locals {
            closed: true,
            ..Locals::default()
        };
        for (((name, unit), value), given) in element.arguments.iter().zip(values).zip(&used.arguments) {
            let unit = self.coherent(unit, unit.span, |coherent| format!("{}: {coherent}", name.text));
            let what = format!("argument `{}` of `{}`", name.text, used.element.text);
            let fits = value.and_then(|value| self.require_unit(value, given.span, unit?, &what).map(|()| value));
            locals.add(&name.text, fits);
        }
        Ok(locals)
    }
}
