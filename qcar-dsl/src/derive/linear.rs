//! Equations to matrices and their parameter Jacobians.
//!
//! Derivatives follow the factored equations: the law of a link is differentiated once by its own arguments, and the
//! chain rule goes through the definitions, so that every entry shares the common parts of the links.

use std::collections::{BTreeMap, BTreeSet};

use qcar_model::{Entry, Matrix};

use crate::check::Checked;
use crate::derive::motion::Motion;
use crate::expr::{Differential, Expr, Graph, LinkId, Symbol};

/// The Jacobians of the equations of motion, nonzeros only, in states, inputs, parameters and the definitions of the
/// equations.
#[derive(Clone, Debug)]
pub struct Linear {
    /// True if A, B, C and D depend on the parameters alone, and each law on the stretch of its own link: the impedance
    /// of the model is then symmetric.
    pub linear: bool,
    /// A = ∂f/∂x, B = ∂f/∂u, C = ∂h/∂x and D = ∂h/∂u, matrix after matrix, row after row.
    pub matrices: Vec<(Entry, Expr)>,
    /// Their derivatives by the parameters, parameter by parameter.
    pub sensitivities: Vec<(Entry, u16, Expr)>,
    /// ∂f/∂p and ∂h/∂p, row by row: true for an output, row, parameter.
    pub parameter_jacobian: Vec<(bool, u16, u16, Expr)>,
}

/// Differentiates the equations by states, inputs and parameters.
pub fn linearise(model: &Checked, motion: &Motion, graph: &mut Graph) -> Linear {
    let chain = Chain::new(motion, graph);
    let rows = [&motion.rates, &motion.outputs].map(|rows| Rows::new(graph, rows.clone()));
    let mut matrices = Vec::new();
    for (columns, names) in [
        (&motion.states, [Matrix::A, Matrix::C]),
        (&motion.inputs, [Matrix::B, Matrix::D]),
    ] {
        for (column, &leaf) in columns.iter().enumerate() {
            let mut by = chain.total_derivative(graph, leaf);
            for (matrix, rows) in names.into_iter().zip(&rows) {
                let entry = |row: usize| Entry {
                    matrix,
                    row: row as u16,
                    column: column as u16,
                };
                let nonzeros = rows.nonzeros(graph, &mut by).into_iter();
                matrices.extend(nonzeros.map(|(row, value)| (entry(row), value)));
            }
        }
    }
    matrices.sort_by_key(|&(entry, _)| entry);
    let entries = Rows::new(graph, matrices.iter().map(|&(_, value)| value).collect());
    let mut sensitivities = Vec::new();
    let mut parameter_jacobian = Vec::new();
    for p in 0..model.parameters.len() as u16 {
        let mut by = chain.total_derivative(graph, Symbol::Parameter(p));
        let changed = entries.nonzeros(graph, &mut by).into_iter();
        sensitivities.extend(changed.map(|(place, value)| (matrices[place].0, p, value)));
        for (is_output, rows) in [false, true].into_iter().zip(&rows) {
            let changed = rows.nonzeros(graph, &mut by).into_iter();
            parameter_jacobian.extend(changed.map(|(row, value)| (is_output, row as u16, p, value)));
        }
    }
    parameter_jacobian.sort_by_key(|&(is_output, row, p, _)| (is_output, row, p));
    let leaves = graph.symbols(matrices.iter().map(|&(_, value)| value));
    let linear = leaves.iter().all(|leaf| matches!(leaf, Symbol::Parameter(_))) && !is_coupled(model);
    Linear {
        linear,
        matrices,
        sensitivities,
        parameter_jacobian,
    }
}

/// The derivatives of the rates of the states by the force of each of these links, with the positions of the states.
pub fn by_forces(motion: &Motion, graph: &mut Graph, links: &[LinkId]) -> Vec<Vec<(usize, Expr)>> {
    let chain = Chain::new(motion, graph);
    let rates = Rows::new(graph, motion.rates.clone());
    let of_link = |&link: &LinkId| {
        let mut by = chain.total_derivative(graph, Symbol::LinkForce(link));
        rates.nonzeros(graph, &mut by)
    };
    links.iter().map(of_link).collect()
}

fn is_coupled(model: &Checked) -> bool {
    let mut links = (0..).map(LinkId).zip(&model.links);
    links.any(|(id, link)| !link.law.other_links(&model.graph, id).is_empty())
}

/// For each leaf, the positions of the expressions that depend on it.
type Users = BTreeMap<Symbol, Vec<usize>>;

fn users(graph: &Graph, values: &[Expr]) -> Users {
    let mut users = Users::new();
    for (place, &value) in values.iter().enumerate() {
        for leaf in graph.symbols([value]) {
            users.entry(leaf).or_default().push(place);
        }
    }
    users
}

/// The definitions of the equations; a derivative propagates from each to those that use it.
struct Chain<'a> {
    definitions: &'a [(Symbol, Expr)],
    users: Users,
    /// The slopes of laws by each of their arguments, by the place of their definition.
    slopes: BTreeMap<usize, Vec<(Symbol, Expr)>>,
}

impl<'a> Chain<'a> {
    fn new(motion: &'a Motion, graph: &mut Graph) -> Self {
        let definitions = &motion.definitions;
        let values: Vec<Expr> = definitions.iter().map(|&(_, value)| value).collect();
        let users = users(graph, &values);
        let laws = definitions.iter().enumerate();
        let laws = laws.filter(|(_, (symbol, _))| matches!(symbol, Symbol::LinkForce(_)));
        let slopes = laws.map(|(place, &(_, law))| {
            let arguments = graph.symbols([law]);
            let slope = |leaf| (leaf, Differential::by(graph, leaf).of(graph, law));
            (place, arguments.into_iter().map(slope).collect())
        });
        Chain {
            slopes: slopes.collect(),
            definitions,
            users,
        }
    }

    /// The derivative by one leaf through all definitions.
    fn total_derivative(&self, graph: &mut Graph, leaf: Symbol) -> Differential {
        let users = |leaf: &Symbol| self.users.get(leaf).into_iter().flatten().copied();
        let mut by = Differential::by(graph, leaf);
        let mut waiting: BTreeSet<usize> = users(&leaf).collect();
        while let Some(place) = waiting.pop_first() {
            let (symbol, value) = self.definitions[place];
            let change = match self.slopes.get(&place) {
                Some(slopes) => chain(graph, &by, slopes),
                None => by.of(graph, value),
            };
            if graph.as_constant(change) != Some(0.0) {
                by.set(symbol, change);
                waiting.extend(users(&symbol));
            }
        }
        by
    }
}

/// `Σ slope change(argument)`
fn chain(graph: &mut Graph, by: &Differential, slopes: &[(Symbol, Expr)]) -> Expr {
    let mut sum = graph.constant(0.0);
    for &(argument, slope) in slopes {
        if let Some(change) = by.leaf(argument) {
            sum = graph.of(sum + slope * change);
        }
    }
    sum
}

/// Values to be differentiated.
struct Rows {
    values: Vec<Expr>,
    users: Users,
}

impl Rows {
    fn new(graph: &Graph, values: Vec<Expr>) -> Self {
        let users = users(graph, &values);
        Rows { values, users }
    }

    /// The derivatives that are not structurally zero, with their positions.
    fn nonzeros(&self, graph: &mut Graph, by: &mut Differential) -> Vec<(usize, Expr)> {
        let users = by.leaves().filter_map(|leaf| self.users.get(&leaf));
        let changed: BTreeSet<usize> = users.flatten().copied().collect();
        let slopes = changed
            .into_iter()
            .map(|place| (place, by.of(graph, self.values[place])));
        let slopes: Vec<(usize, Expr)> = slopes.collect();
        let differs = |(_, value): &(usize, Expr)| graph.as_constant(*value) != Some(0.0);
        slopes.into_iter().filter(differs).collect()
    }
}
