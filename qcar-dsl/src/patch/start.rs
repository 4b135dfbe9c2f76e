//! Start values and plausible ranges of an effect's parameters: evaluates their expressions in the model's parameters.

use std::collections::BTreeMap;

use qcar_model::ParameterRole;

use super::model_tree::ModelTree;
use super::query::{Values, as_quantity, value, with_quantities};
use super::rewrite::{made, names_in};
use super::scale::Scale;

use super::{NewParameter, Refusal};
use crate::diagnostic::{Diagnostic, effects};
use crate::front::syntax::{
    Change, Effect, EffectParameter, Expression, ExpressionKind, Name, Number, Parameter, ParameterDefault, Role,
    Statement, VanishesAt,
};
use crate::model::Model;
use crate::units::Unit;

/// A parameter of an effect with its expressions in the names of the model.
pub struct BoundParameter<'a> {
    /// The declaration in the effect.
    pub declared: &'a EffectParameter,
    /// Its description in the model.
    pub doc: String,
    /// Its name in the model.
    pub name: String,
    /// Its expressions, in the order of [`expressions`].
    pub expressions: Vec<Expression>,
}

/// Start, lower and upper bound, and the value at which a strength vanishes if that is an expression.
pub fn expressions(declared: &EffectParameter) -> impl Iterator<Item = &Expression> {
    let vanishes_at = match &declared.role {
        Role::Strength(VanishesAt::Value(value)) => Some(value),
        _ => None,
    };
    let (low, high) = &declared.range;
    [&declared.start, low, high].into_iter().chain(vanishes_at)
}

/// Prefixes of the names of derived quantities, one for each kind of expression.
const ROLES: [&str; 4] = ["start of ", "low end of ", "high end of ", "vanishing value of "];

/// The start, range and declaration of every parameter.
///
/// # Errors
/// Fails for expressions with unknown names, with a unit other than the parameter's, or without a value.
pub fn evaluate(
    base: &ModelTree,
    asked: &[BoundParameter],
    values: Values,
) -> Result<Vec<(NewParameter, Parameter)>, Refusal> {
    let (model, found) = with_expressions(base, asked);
    if !found.is_empty() {
        return Err(found);
    }
    let answers: BTreeMap<&str, (f64, Unit)> = model
        .definitions
        .iter()
        .map(|definition| {
            (
                definition.name.as_str(),
                (value(&model, definition.value, values), definition.unit),
            )
        })
        .collect();
    let mut all = Vec::new();
    let mut found = Vec::new();
    for one in asked {
        match numbers(one, &model, &answers) {
            Ok(numbers) => all.push(declaration(one, numbers, base)),
            Err(mistake) => found.push(*mistake),
        }
    }
    if found.is_empty() { Ok(all) } else { Err(found) }
}

/// Gives the parameters that these expressions use their known values as defaults: a mass that is taken from the body
/// in a share of the known mass could exceed the body's default.
pub fn set_known_defaults(tree: &mut ModelTree, asked: &[BoundParameter], values: Values) {
    let mut used = Vec::new();
    for e in asked.iter().flat_map(|one| &one.expressions) {
        names_in(e, &mut |name| {
            used.extend(name.names.iter().map(|part| part.text.clone()))
        });
    }
    for parameter in tree.parameters_mut().filter(|own| used.contains(&own.name.text)) {
        let inside = |value: &f64| {
            let range = parameter.range.as_ref();
            range.is_none_or(|(low, high)| low.value <= *value && *value <= high.value)
        };
        let known = values(&parameter.name.text).filter(inside);
        if let Some(value) = known.filter(|_| parameter.default.is_some()) {
            parameter.default = Some(ParameterDefault::Number(in_short(value)));
        }
    }
}

/// The model with each expression as a derived quantity, and with the parameters themselves for their units.
fn with_expressions(base: &ModelTree, asked: &[BoundParameter]) -> (Model, Vec<Diagnostic>) {
    let mut quantities: Vec<Statement> = scales(base, asked).into_iter().map(Statement::Parameter).collect();
    for one in asked {
        quantities.push(Statement::Parameter(Parameter {
            known: false,
            clock: false,
            name: Name::new(unit_of(one)),
            unit: one.declared.unit.clone(),
            default: None,
            range: None,
            doc: String::new(),
        }));
        let expressions = ROLES.iter().zip(&one.expressions);
        quantities.extend(expressions.map(|(role, e)| as_quantity(&format!("{role}{}", one.name), e)));
    }
    with_quantities(base, quantities)
}

/// The reference values that expressions use.
fn scales(base: &ModelTree, asked: &[BoundParameter]) -> Vec<Parameter> {
    let mut found: Vec<Parameter> = Vec::new();
    for e in asked.iter().flat_map(|one| &one.expressions) {
        names_in(e, &mut |name| {
            let [name] = name.names.as_slice() else { return };
            let Some((scale, direction, place)) = Scale::of(&name.text) else {
                return;
            };
            if found.iter().all(|own| own.name.text != name.text) {
                found.push(scale.declaration(&name.text, base.turns(direction, place)));
            }
        });
    }
    found
}

fn unit_of(one: &BoundParameter) -> String {
    format!("unit of {}", one.name)
}

/// The numbers of a parameter, in SI.
struct Numbers {
    start: f64,
    range: (f64, f64),
    role: ParameterRole,
    unit: Unit,
}

fn numbers(
    one: &BoundParameter,
    model: &Model,
    answers: &BTreeMap<&str, (f64, Unit)>,
) -> Result<Numbers, Box<Diagnostic>> {
    let name = unit_of(one);
    let unit = model.parameters.iter().find(|parameter| parameter.name == name);
    let unit = unit.map_or(Unit::ONE, |parameter| parameter.unit);
    let mut numbers = [0.0; ROLES.len()];
    for ((number, role), expression) in numbers.iter_mut().zip(ROLES).zip(&one.expressions) {
        let quantity = format!("{role}{}", one.name);
        let (value, own) = answers.get(quantity.as_str()).copied().unwrap_or((f64::NAN, unit));
        if own != unit && !is_plain(expression) {
            let what = format!("the {}`{}`", role, one.declared.name.text);
            return Err(Box::new(effects::start_of_other_unit(
                expression.span,
                &what,
                &unit.to_string(),
                &own.to_string(),
            )));
        }
        *number = value;
    }
    let [start, low, high, vanishes_at] = numbers;
    let [start, low, high] = [start, low, high].map(rounded);
    let name = &one.declared.name;
    if !(low <= start && start <= high && low < high) {
        let mistake = effects::start_outside_range(name.span, &name.text, start, low, high);
        return Err(Box::new(mistake));
    }
    let role = role(one.declared, vanishes_at, (low, high))?;
    Ok(Numbers {
        start,
        range: (low, high),
        role,
        unit,
    })
}

fn role(declared: &EffectParameter, value: f64, (low, high): (f64, f64)) -> Result<ParameterRole, Box<Diagnostic>> {
    let vanishes_at = match &declared.role {
        Role::Shape => return Ok(ParameterRole::Shape),
        Role::Clock => return Ok(ParameterRole::Clock),
        Role::Other => return Ok(ParameterRole::Other),
        Role::Strength(VanishesAt::Zero) => 0.0,
        Role::Strength(VanishesAt::Infinity) => f64::INFINITY,
        Role::Strength(VanishesAt::Value(_)) if value == 0.0 || (low <= value && value <= high) => value,
        Role::Strength(VanishesAt::Value(limit)) => {
            let name = &declared.name.text;
            let mistake = effects::vanishes_outside_range(limit.span, name, value, low, high);
            return Err(Box::new(mistake));
        }
    };
    Ok(ParameterRole::Strength { vanishes_at })
}

/// A number without a unit, which is in the declared one.
fn is_plain(e: &Expression) -> bool {
    match &e.kind {
        ExpressionKind::Number(number) => number.unit.factors.is_empty(),
        ExpressionKind::Negative(inner) => is_plain(inner),
        _ => false,
    }
}

/// Rounds to three digits, so that a file is easy to read.
fn rounded(value: f64) -> f64 {
    format!("{value:.2e}").parse().unwrap_or(value)
}

fn declaration(one: &BoundParameter, numbers: Numbers, base: &ModelTree) -> (NewParameter, Parameter) {
    let declared = one.declared;
    let (low, high) = numbers.range;
    let [from, to] = [(&declared.range.0, low), (&declared.range.1, high)].map(|(e, value)| number(e, value));
    let parameter = Parameter {
        known: declared.known,
        clock: declared.role == Role::Clock,
        name: Name::new(&one.name),
        unit: declared.unit.clone(),
        default: Some(ParameterDefault::Number(number(&declared.start, numbers.start))),
        range: Some((from, to)),
        doc: one.doc.clone(),
    };
    let new = NewParameter {
        name: one.name.clone(),
        effect_name: declared.name.text.clone(),
        unit: declared.unit.name(numbers.unit),
        start: numbers.start,
        range: numbers.range,
        known: declared.known,
        doc: one.doc.clone(),
        role: numbers.role,
        scales_force: numbers.unit.is_proportional_to_mass(),
        is_new: base.global(&one.name).is_none(),
    };
    (new, parameter)
}

/// The number as the effect writes it, or in the declared unit if it is computed.
fn number(e: &Expression, value: f64) -> Number {
    match &e.kind {
        ExpressionKind::Number(number) => number.clone(),
        ExpressionKind::Negative(inner) if matches!(inner.kind, ExpressionKind::Number(_)) => Number {
            digits: format!("-{}", number(inner, -value).digits),
            value,
            ..number(inner, -value)
        },
        _ => in_short(value),
    }
}

/// A number in its shortest form.
fn in_short(value: f64) -> Number {
    Number {
        digits: format!("{value}"),
        ..Number::new(value)
    }
}

/// Sets the starts and ranges of these parameters to numbers in SI; other parameters do not change.
pub fn set_starts(effect: &mut Effect, values: &[NewParameter]) {
    for change in &mut effect.body {
        let Change::Parameter(declared) = change else { continue };
        if let Some(own) = values.iter().find(|own| own.effect_name == declared.name.text) {
            // A plain number is in the declared unit, which is coherent.
            let plain = |value: f64| made(ExpressionKind::Number(Number::new(value)));
            declared.start = plain(own.start);
            declared.range = (plain(own.range.0), plain(own.range.1));
        }
    }
}
