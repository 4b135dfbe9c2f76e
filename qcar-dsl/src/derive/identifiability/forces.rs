//! Identifiability of laws whose parameters need not change a slope.

use std::collections::BTreeSet;

use num_complex::Complex64;

use super::observable::Observable;
use crate::check::Checked;
use crate::check::sample::{Point, Values};
use crate::check::slopes::slopes;
use crate::derive::motion::Motion;
use crate::expr::{Differential, Expr, Graph, LinkId, Symbol};
use crate::model::Signal;

/// The laws whose force itself is observed. A parameter that only shifts the position of rest changes no response, but
/// it changes the force.
pub struct Forces {
    laws: Vec<Vec<Part>>,
    /// True if a law is nonlinear.
    pub bends: bool,
}

/// A term of an observed force: a factor times a value, with the derivatives of the value by the estimated parameters.
struct Part {
    factor: Expr,
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
        let mut laws = Vec::new();
        for (slopes, id) in slopes.iter().zip((0..).map(LinkId)) {
            let is_output = model
                .outputs
                .iter()
                .any(|output| output.signal == Signal::LinkForce(id));
            let is_reached = slopes.nonlinear && equations.reach_outputs(Symbol::LinkForce(id));
            if !is_output && !is_reached {
                continue;
            }
            let inner = model.links[usize::from(id.0)].law.inner.iter().zip(&slopes.inner);
            let rates = inner.map(|(inner, slopes)| (slopes.force, inner.rate));
            let rest = (!is_output).then_some((less, slopes.rest));
            let parts = [(one, slopes.force)].into_iter().chain(rates).chain(rest);
            let parts = parts.map(|(factor, value)| Part {
                factor,
                value,
                gradient: gradient(graph, value, estimated),
            });
            laws.push(parts.collect());
        }
        Forces {
            laws,
            bends: slopes.iter().any(|slopes| slopes.nonlinear),
        }
    }

    /// The forces at a point, with their derivatives; `parameters` is the number of estimated parameters.
    pub fn seen(&self, graph: &Graph, point: &Point, parameters: usize) -> Vec<Observable> {
        let leaf = |symbol| point.leaf(symbol);
        let values = Values::new(graph, &leaf);
        let force = |parts: &Vec<Part>| {
            let mut seen = Observable {
                value: Complex64::default(),
                gradient: vec![Complex64::default(); parameters],
            };
            for part in parts {
                let factor = values.of(part.factor);
                seen.value += factor * values.of(part.value);
                for &(place, slope) in &part.gradient {
                    seen.gradient[place] += factor * values.of(slope);
                }
            }
            seen
        };
        self.laws.iter().map(force).collect()
    }
}

/// The derivatives of an expression by the estimated parameters in it.
fn gradient(graph: &mut Graph, e: Expr, estimated: &[u16]) -> Vec<(usize, Expr)> {
    let mut gradient = Vec::new();
    for symbol in graph.symbols([e]) {
        if let Symbol::Parameter(index) = symbol
            && let Ok(place) = estimated.binary_search(&index)
        {
            gradient.push((place, Differential::by(graph, symbol).of(graph, e)));
        }
    }
    gradient
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
