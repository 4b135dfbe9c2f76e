//! Values of expressions in a model: each expression is added to the model as a derived quantity and evaluated.

use super::model_tree::ModelTree;
use crate::diagnostic::{Diagnostic, effects};
use crate::expr::Symbol;
use crate::front::resolve::options::select;
use crate::front::resolve::resolve;
use crate::front::syntax::{Axle, AxleKind, Expression, Let, Name, Statement};
use crate::model::{Default, Model};

/// Known values of the model's parameters and of its [reference values](super::Scale), by name.
pub type Values<'a> = &'a dyn Fn(&str) -> Option<f64>;

/// An expression as a derived quantity of a model.
pub fn as_quantity(name: &str, value: &Expression) -> Statement {
    let (name, value, doc) = (Name::new(name), value.clone(), String::new());
    Statement::Let(Let { name, value, doc })
}

/// The parameters and derived quantities of a model with further quantities, and the diagnostics about these. Parts of a
/// direction are left out, since no quantity can use them.
pub fn with_quantities(base: &ModelTree, quantities: Vec<Statement>) -> (Model, Vec<Diagnostic>) {
    let own = base.axle.body.iter();
    let own = own.filter(|statement| !matches!(statement, Statement::Direction(_)));
    let axle = Axle {
        kind: AxleKind::Plain,
        name: base.axle.name.clone(),
        doc: String::new(),
        body: own.cloned().chain(quantities).collect(),
    };
    let mut found = Vec::new();
    let member = select(&axle, None, &mut found);
    let (model, more) = resolve(&axle, &member, &[]);
    found.extend(more);
    // The added quantities are unused on purpose.
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
pub fn numbers(base: &ModelTree, asked: &[Expression], values: Values) -> Vec<f64> {
    let name = |place: usize| format!("quantity {place}");
    let quantities = asked.iter().enumerate();
    let (model, _) = with_quantities(
        base,
        quantities.map(|(place, e)| as_quantity(&name(place), e)).collect(),
    );
    let answer = |place: usize| {
        let (mut definitions, name) = (model.definitions.iter(), name(place));
        let own = definitions.find(|definition| definition.name == name)?;
        Some(value(&model, own.value, values))
    };
    (0..asked.len())
        .map(|place| answer(place).unwrap_or(f64::NAN))
        .collect()
}

/// The value of a parameter: the known one, its default, or the middle of its range.
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
