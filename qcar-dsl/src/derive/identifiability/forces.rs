//! Identifiability of laws whose parameters need not change a slope.

use std::collections::BTreeSet;

use num_complex::Complex64;

use super::observable::Observable;
use crate::check::Checked;
use crate::check::sample::{Point, Values};
use crate::check::slopes::{Slopes, slopes};
use crate::derive::linear::by_forces;
use crate::derive::motion::Motion;
use crate::expr::{Differential, Expr, Graph, LinkId, Symbol};
use crate::model::Signal;

/// The laws whose force itself is observed. A parameter that only shifts the position of rest changes no response, but
/// it changes the force.
pub struct Forces {
    forces: Vec<ObservedForce>,
    /// True if a law is nonlinear.
    pub bends: bool,
}

/// The force of a law that is observed.
struct ObservedForce {
    /// Its terms.
    parts: Vec<Part>,
    /// What shows it: the rate of each state for a force of 1 N, since only the ratios of forces and masses may be seen; or
    /// the force itself.
    seen_by: Vec<Value>,
}

/// A term of an observed force: a factor times a value.
struct Part {
    factor: Expr,
    value: Value,
}

/// A value with its derivatives by the estimated parameters.
struct Value {
    value: Expr,
    gradient: Vec<(usize, Expr)>,
}

impl Forces {
    /// The laws of a model; their derivatives are added to the graph.
    pub fn of(model: &Checked, motion: &Motion, graph: &mut Graph, estimated: &[u16]) -> Forces {
        let equations = Equations::of(motion, graph);
        let slopes = slopes(model, graph);
        let one = graph.constant(1.0);
        let less = graph.constant(-1.0);
        let is_output = |id| {
            model
                .outputs
                .iter()
                .any(|output| output.signal == Signal::LinkForce(id))
        };
        let is_reached = |slopes: &Slopes, id| slopes.nonlinear && equations.reach_outputs(Symbol::LinkForce(id));
        let all = || (0..).map(LinkId).zip(&slopes);
        let measured = all().filter(|&(id, _)| is_output(id)).map(|(id, _)| id);
        let reached = all().filter(|&(id, slopes)| !is_output(id) && is_reached(slopes, id));
        let reached: Vec<LinkId> = reached.map(|(id, _)| id).collect();
        let rates = by_forces(motion, graph, &reached);
        let mut observed: Vec<(LinkId, Vec<Expr>)> = measured.map(|id| (id, vec![one])).collect();
        for (&id, rates) in reached.iter().zip(rates) {
            let rates: Vec<Expr> = rates.into_iter().map(|(_, rate)| rate).collect();
            observed.push((id, if rates.is_empty() { vec![one] } else { rates }));
        }
        let mut value = |e| Value::of(e, graph, estimated);
        let force = |(id, seen_by): (LinkId, Vec<Expr>)| {
            let (slopes, law) = (&slopes[usize::from(id.0)], &model.links[usize::from(id.0)].law);
            let rates = slopes.inner.iter().zip(&law.inner);
            let rates = rates.map(|(slopes, inner)| (slopes.force, inner.rate));
            let rest = (!is_output(id)).then_some((less, slopes.rest));
            let parts = [(one, slopes.force)].into_iter().chain(rates).chain(rest);
            ObservedForce {
                parts: parts
                    .map(|(factor, e)| Part {
                        factor,
                        value: value(e),
                    })
                    .collect(),
                seen_by: seen_by.into_iter().map(&mut value).collect(),
            }
        };
        let forces = observed.into_iter().map(force).collect();
        Forces {
            forces,
            bends: slopes.iter().any(|slopes| slopes.nonlinear),
        }
    }

    /// What is seen of the forces at a point; `parameters` is the number of estimated parameters.
    pub fn seen(&self, graph: &Graph, point: &Point, parameters: usize) -> Vec<Observable> {
        let leaf = |symbol| point.leaf(symbol);
        let values = Values::new(graph, &leaf);
        let of_force = |observed: &ObservedForce| {
            let mut force = Observable {
                value: Complex64::default(),
                gradient: vec![Complex64::default(); parameters],
            };
            for Part { factor, value } in &observed.parts {
                let factor = values.of(*factor);
                force.value += factor * values.of(value.value);
                for &(place, slope) in &value.gradient {
                    force.gradient[place] += factor * values.of(slope);
                }
            }
            let seen_by = |by: &Value| {
                let mut seen = force.scaled(values.of(by.value).into());
                for &(place, slope) in &by.gradient {
                    seen.gradient[place] += force.value * values.of(slope);
                }
                seen
            };
            observed.seen_by.iter().map(seen_by).collect::<Vec<_>>()
        };
        self.forces.iter().flat_map(of_force).collect()
    }
}

impl Value {
    /// An expression with its derivatives, which are added to the graph.
    fn of(value: Expr, graph: &mut Graph, estimated: &[u16]) -> Self {
        let mut gradient = Vec::new();
        for symbol in graph.symbols([value]) {
            if let Symbol::Parameter(index) = symbol
                && let Ok(place) = estimated.binary_search(&index)
            {
                gradient.push((place, Differential::by(graph, symbol).of(graph, value)));
            }
        }
        Value { value, gradient }
    }
}

/// Dependencies of each definition and of the rate of each state.
struct Equations {
    depends: Vec<(Symbol, BTreeSet<Symbol>)>,
    outputs: BTreeSet<Symbol>,
}

impl Equations {
    fn of(motion: &Motion, graph: &Graph) -> Self {
        let rates = motion.states.iter().copied().zip(motion.rates.iter().copied());
        let equations = motion.definitions.iter().copied().chain(rates);
        Equations {
            depends: equations.map(|(symbol, e)| (symbol, graph.symbols([e]))).collect(),
            outputs: graph.symbols(motion.outputs.iter().copied()),
        }
    }

    /// True if a change of this symbol changes an output at some time.
    fn reach_outputs(&self, from: Symbol) -> bool {
        let mut reached = BTreeSet::from([from]);
        loop {
            let next = self.depends.iter().filter(|(symbol, _)| !reached.contains(symbol));
            let next = next.filter(|(_, on)| !on.is_disjoint(&reached));
            let next: Vec<Symbol> = next.map(|(symbol, _)| *symbol).collect();
            if next.is_empty() {
                return !self.outputs.is_disjoint(&reached);
            }
            reached.extend(next);
        }
    }
}
