//! Removes declarations that a patch leaves unused: the coefficient of a replaced term, or a point without links.

use std::cell::LazyCell;
use std::collections::BTreeSet;

use super::model_tree::ModelTree;
use super::rewrite::names_in;
use crate::front::syntax::{Dotted, Expression, ExpressionKind, ParameterDefault, Statement};

/// Removes unused parameters, derived quantities and points, repeatedly until all are used. Points that were unused in
/// `base` stay: effects find places by them.
pub fn tidy(tree: &mut ModelTree, base: &ModelTree) {
    let spare = LazyCell::new(|| unused_points(base));
    let is_spare = |statement: &Statement| matches!(statement, Statement::Point(name, _) if spare.contains(&name.text));
    loop {
        let used = used(tree);
        let mut removed = 0;
        let mut keep = |statement: &Statement| {
            let kept = is_used(statement, &used) || is_spare(statement);
            removed += usize::from(!kept);
            kept
        };
        tree.axle.body.retain(&mut keep);
        for statement in &mut tree.axle.body {
            if let Statement::Direction(direction) = statement {
                direction.body.retain(&mut keep);
            }
        }
        if removed == 0 {
            return;
        }
    }
}

fn unused_points(base: &ModelTree) -> BTreeSet<String> {
    let used = used(base);
    let statements = base.directions().flat_map(|direction| &direction.body);
    let unused = statements.filter(|statement| !is_used(statement, &used));
    let point = |statement: &Statement| match statement {
        Statement::Point(name, _) => Some(name.text.clone()),
        _ => None,
    };
    unused.filter_map(point).collect()
}

fn is_used(statement: &Statement, used: &BTreeSet<String>) -> bool {
    match statement {
        Statement::Parameter(parameter) => used.contains(&parameter.name.text),
        Statement::Let(definition) => used.contains(&definition.name.text),
        // The acceleration of a point that several coordinates move is an output, even if nothing else uses the point.
        Statement::Point(name, target) => used.contains(&name.text) || !matches!(target.kind, ExpressionKind::Name(_)),
        _ => true,
    }
}

/// Every part of every name in an expression, a default or a path.
fn used(tree: &ModelTree) -> BTreeSet<String> {
    let mut used = BTreeSet::new();
    let mut asked = tree.clone();
    asked.change_expressions(&mut |e: &Expression| {
        names_in(e, &mut |name| add(name, &mut used));
        e.clone()
    });
    let inside = tree.directions().flat_map(|direction| &direction.body);
    for statement in tree.axle.body.iter().chain(inside) {
        match statement {
            Statement::Parameter(parameter) => {
                if let Some(ParameterDefault::Same(other)) = &parameter.default {
                    used.insert(other.text.clone());
                }
            }
            Statement::Output(_, path) => add(path, &mut used),
            Statement::Channel(_, above, below) => {
                add(above, &mut used);
                add(below, &mut used);
            }
            _ => {}
        }
    }
    used
}

fn add(name: &Dotted, used: &mut BTreeSet<String>) {
    used.extend(name.names.iter().map(|name| name.text.clone()));
}
