//! Names of the values of a program: derived quantities, inertias, stretches and forces of links.
//!
//! A program stores no names. They are found by searching the program for the expressions that have names in the model.

use std::collections::BTreeMap;

use crate::back::equations::named_quantities;
use crate::expr::{Curve, Expr, LinkId, Node, Symbol};
use crate::model::Term;
use crate::program::schedule::Compiled;
use crate::program::{Op, Program, Value};

/// The values of a program that have a name.
pub fn labels(compiled: &Compiled, program: &Program) -> BTreeMap<Value, String> {
    let mut finder = Finder::new(compiled, program);
    let mut labels = BTreeMap::new();
    for (name, expression) in named_quantities(&compiled.model)
        .into_iter()
        .chain(of_laws(compiled))
        .chain(of_motion(compiled))
    {
        if let Some(value) = finder.value(expression) {
            labels.entry(value).or_insert(name);
        }
    }
    for (place, op) in program.ops.iter().enumerate() {
        if let Some(name) = reciprocal_name(compiled, program, &labels, *op) {
            labels.entry(Value(place as u32)).or_insert(name);
        }
    }
    labels
}

/// `per_m_wheel` for `1 / m_wheel`.
fn reciprocal_name(compiled: &Compiled, program: &Program, labels: &BTreeMap<Value, String>, op: Op) -> Option<String> {
    let at = |value: Value| program.ops[value.0 as usize];
    match op {
        Op::Div(one, of) if at(one) == Op::Constant(1.0) => match at(of) {
            Op::Input(Symbol::Parameter(place)) => {
                Some(format!("per_{}", compiled.about.parameters[place as usize].name))
            }
            _ => labels.get(&of).map(|name| format!("per_{name}")),
        },
        _ => None,
    }
}

/// Names of the constants of a parameter set.
pub fn of_constants(compiled: &Compiled) -> Vec<String> {
    let prepare = &compiled.programs.prepare;
    let labels = labels(compiled, prepare);
    let name = |(place, value): (usize, &Value)| match prepare.ops[value.0 as usize] {
        Op::Input(Symbol::Parameter(parameter)) => compiled.model.parameters[parameter as usize].name.clone(),
        _ => labels.get(value).cloned().unwrap_or_else(|| format!("c{place}")),
    };
    prepare.outputs.iter().enumerate().map(name).collect()
}

/// Stiffness and damping of links that the text gives as expressions: `k_spring`, `c_damper`.
fn of_laws(compiled: &Compiled) -> Vec<(String, Expr)> {
    let links = compiled.model.links.iter();
    let terms = links.flat_map(|link| link.law.terms.iter().map(|term| (&link.name, *term)));
    let labels = terms.filter_map(|(link, term)| match term {
        Term::Spring(k) => Some((format!("k_{link}"), k)),
        Term::Damper(c) => Some((format!("c_{link}"), c)),
        Term::Inerter(_) | Term::Force(_) => None,
    });
    let is_compound = |e: Expr| !matches!(compiled.graph.node(e), Node::Constant(_) | Node::Symbol(_));
    labels.filter(|&(_, e)| is_compound(e)).collect()
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

/// Finds the value of an expression in a program.
struct Finder<'a> {
    compiled: &'a Compiled,
    program: &'a Program,
    found: BTreeMap<Expr, Option<Value>>,
    /// The finder of `prepare`, if the program reads prepared constants.
    prepare: Option<Box<Finder<'a>>>,
}

impl<'a> Finder<'a> {
    fn new(compiled: &'a Compiled, program: &'a Program) -> Self {
        let prepared = program.ops.iter().any(|op| matches!(op, Op::Prepared(_)));
        let prepare = prepared.then(|| Box::new(Finder::new(compiled, &compiled.programs.prepare)));
        Finder {
            compiled,
            program,
            found: BTreeMap::new(),
            prepare,
        }
    }

    fn value(&mut self, e: Expr) -> Option<Value> {
        if let Some(&known) = self.found.get(&e) {
            return known;
        }
        let value = self.prepared(e).or_else(|| self.look_up(e));
        self.found.insert(e, value);
        value
    }

    fn prepared(&mut self, e: Expr) -> Option<Value> {
        let value = self.prepare.as_mut()?.value(e)?;
        let place = self
            .compiled
            .programs
            .prepare
            .outputs
            .iter()
            .position(|&output| output == value)?;
        self.place(&[Op::Prepared(place as u32)])
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
                self.place(&[Op::Div(a, b)]).or_else(|| {
                    let reciprocal = self.reciprocal(b)?;
                    self.place(&[Op::Mul(a, reciprocal), Op::Mul(reciprocal, a)])
                })
            }
            Node::Table(order, x, curve) => {
                let x = self.value(x)?;
                let curve = self.compiled.graph.curve(curve);
                let entries: Vec<Value> = curve.entries().map(|&entry| self.value(entry)).collect::<Option<_>>()?;
                let is_it = |own: &Curve<Value>| own.knots().eq(curve.knots()) && own.entries().eq(&entries);
                let place = self.program.curves.iter().position(is_it)?;
                self.place(&[Op::Table(order, x, place as u32)])
            }
            Node::Powi(a, 2) => {
                let a = self.value(a)?;
                self.place(&[Op::Mul(a, a)])
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

    fn reciprocal(&self, of: Value) -> Option<Value> {
        let one = self.place(&[Op::Constant(1.0)])?;
        self.place(&[Op::Div(one, of)])
    }

    fn place(&self, ops: &[Op]) -> Option<Value> {
        let place = self.program.ops.iter().position(|op| ops.contains(op))?;
        Some(Value(place as u32))
    }
}
