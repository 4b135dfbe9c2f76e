//! What a reviewer calls the values of a program: derived quantities, inertias, stretches and forces of links.
//!
//! A program keeps no names. They are found again by following the expressions that names stand for.

use std::collections::BTreeMap;

use crate::equations::named_quantities;
use crate::expr::{Expr, LinkId, Node, Symbol};
use crate::program::{Op, Program, Value};
use crate::schedule::Compiled;

/// The values of a program that have a name.
pub fn labels(compiled: &Compiled, program: &Program) -> BTreeMap<Value, String> {
    let mut finder = Finder {
        compiled,
        program,
        found: BTreeMap::new(),
    };
    let mut labels = BTreeMap::new();
    for (name, expression) in named_quantities(&compiled.model).into_iter().chain(of_motion(compiled)) {
        if let Some(value) = finder.value(expression) {
            labels.entry(value).or_insert(name);
        }
    }
    labels
}

/// What a reviewer calls each constant of a parameter set.
pub fn of_constants(compiled: &Compiled) -> Vec<String> {
    let prepare = &compiled.programs.prepare;
    let labels = labels(compiled, prepare);
    let name = |(place, value): (usize, &Value)| match prepare.ops[value.0 as usize] {
        Op::Input(Symbol::Parameter(parameter)) => compiled.model.parameters[parameter as usize].name.clone(),
        _ => labels.get(value).cloned().unwrap_or_else(|| format!("c{place}")),
    };
    prepare.outputs.iter().enumerate().map(name).collect()
}

fn of_motion(compiled: &Compiled) -> Vec<(String, Expr)> {
    let link = |id: LinkId| &compiled.model.links[id.0 as usize].name;
    let name = |symbol: Symbol| match symbol {
        Symbol::Stretch(id) => Some(format!("s_{}", link(id))),
        Symbol::Rate(id) => Some(format!("v_{}", link(id))),
        Symbol::LinkForce(id) => Some(format!("f_{}", link(id))),
        _ => None,
    };
    compiled
        .motion
        .definitions
        .iter()
        .filter_map(|&(symbol, value)| Some((name(symbol)?, value)))
        .collect()
}

/// Finds the value that an expression became.
struct Finder<'a> {
    compiled: &'a Compiled,
    program: &'a Program,
    found: BTreeMap<Expr, Option<Value>>,
}

impl Finder<'_> {
    fn value(&mut self, e: Expr) -> Option<Value> {
        if let Some(&known) = self.found.get(&e) {
            return known;
        }
        let value = self.look_up(e);
        self.found.insert(e, value);
        value
    }

    fn look_up(&mut self, e: Expr) -> Option<Value> {
        match self.compiled.graph.node(e) {
            Node::Constant(bits) => self.place(&[Op::Constant(f64::from_bits(bits))]),
            Node::Symbol(symbol) => self.symbol(symbol),
            Node::Neg(a) => {
                let a = self.value(a)?;
                self.place(&[Op::Neg(a)])
            }
            Node::Add(a, b) => {
                let (a, b) = (self.value(a)?, self.value(b)?);
                self.place(&[Op::Add(a, b), Op::Add(b, a)])
            }
            Node::Sub(a, b) => {
                let (a, b) = (self.value(a)?, self.value(b)?);
                self.place(&[Op::Sub(a, b)])
            }
            Node::Mul(a, b) => {
                let (a, b) = (self.value(a)?, self.value(b)?);
                self.place(&[Op::Mul(a, b), Op::Mul(b, a)])
            }
            Node::Div(a, b) => {
                let (a, b) = (self.value(a)?, self.value(b)?);
                self.place(&[Op::Div(a, b)])
            }
            _ => None,
        }
    }

    fn symbol(&mut self, symbol: Symbol) -> Option<Value> {
        let definitions = &self.compiled.motion.definitions;
        match definitions.iter().find(|(defined, _)| *defined == symbol) {
            Some(&(_, value)) => self.value(value),
            None => self.place(&[Op::Input(symbol)]),
        }
    }

    fn place(&self, ops: &[Op]) -> Option<Value> {
        let place = self.program.ops.iter().position(|op| ops.contains(op))?;
        Some(Value(place as u32))
    }
}
