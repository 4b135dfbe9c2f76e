//! Values of expressions in a model: each is evaluated as one of its derived quantities.

use super::base::Base;
use crate::diagnostic::{Diagnostic, effects};
use crate::expr::Symbol;
use crate::front::resolve::options::select;
use crate::front::resolve::resolve;
use crate::front::syntax::{Expression, Let, Name, Statement};
use crate::model::{Default, Model};

/// What somebody knows: values of the model's parameters by name, and of its
/// [reference values](super::Scale) by theirs.
pub type Values<'a> = &'a dyn Fn(&str) -> Option<f64>;

/// A derived quantity that a model is asked for.
pub fn question(name: &str, value: &Expression) -> Statement {
    let (name, value, doc) = (Name::new(name), value.clone(), String::new());
    Statement::Let(Let { name, value, doc })
}

/// The model with questions in it, and why it cannot answer.
pub fn with_questions(base: &Base, questions: Vec<Statement>) -> (Model, Vec<Diagnostic>) {
    let mut axle = base.axle.clone();
    axle.body.extend(questions);
    let mut found = Vec::new();
    let member = select(&axle, None, &mut found);
    let (model, more) = resolve(&axle, &member, &base.elements());
    found.extend(more);
    // The questions themselves are used by nothing.
    found.retain(|diagnostic| !effects::is_about_use(diagnostic));
    (model, found)
}

/// The value of an expression; NaN if unknown.
pub fn value(model: &Model, e: crate::expr::Expr, values: Values) -> f64 {
    let leaf = |symbol| match symbol {
        Symbol::Parameter(index) => known(model, index, values),
        _ => f64::NAN,
    };
    model.graph.evaluate(e, &leaf)
}

/// The values of expressions, in their order; NaN if unknown or if the model has mistakes.
pub fn numbers(base: &Base, asked: &[Expression], values: Values) -> Vec<f64> {
    let name = |place: usize| format!("question {place}");
    let questions = asked.iter().enumerate();
    let (model, _) = with_questions(base, questions.map(|(place, e)| question(&name(place), e)).collect());
    let answer = |place: usize| {
        let mut definitions = model.definitions.iter();
        let own = definitions.find(|definition| definition.name == name(place))?;
        Some(value(&model, own.value, values))
    };
    (0..asked.len())
        .map(|place| answer(place).unwrap_or(f64::NAN))
        .collect()
}

/// The value of a parameter: what somebody knows, its default, or the middle of its range.
fn known(model: &Model, index: u16, values: Values) -> f64 {
    let parameter = &model.parameters[usize::from(index)];
    let default = match parameter.default {
        Default::Value(value) => Some(value),
        Default::Same(other) => Some(known(model, other, values)),
        Default::None => None,
    };
    values(&parameter.name)
        .or(default)
        .or(parameter.range.map(middle))
        .unwrap_or(f64::NAN)
}

fn middle((low, high): (f64, f64)) -> f64 {
    if low > 0.0 {
        (low * high).sqrt()
    } else {
        (low + high) / 2.0
    }
}
