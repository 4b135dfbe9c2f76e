//! Slopes of laws: derivatives of the force of each link by its stretch, its rate and its inner states.

use super::sample::{Values, tag, uniform};
use crate::expr::{Differential, Expr, Graph, LinkId, Substitution, Symbol};
use crate::model::{Model, Term};

/// A law as a function of its own arguments.
pub struct Slopes {
    /// The force without inerters.
    pub force: Expr,
    /// ∂force/∂s
    pub stiffness: Expr,
    /// ∂force/∂v
    pub damping: Expr,
    /// The factor of dv/dt.
    pub inertance: Expr,
    /// The inner states.
    pub inner: Vec<InnerSlopes>,
    /// ∂force/∂s of the other links in the law.
    pub others: Vec<(LinkId, Expr)>,
    /// The force at rest: a preload.
    pub rest: Expr,
    /// True if the force or a rate is nonlinear in the motion.
    pub nonlinear: bool,
}

impl Slopes {
    /// Every expression.
    pub fn all(&self) -> Vec<Expr> {
        let inner = self.inner.iter().flat_map(InnerSlopes::all);
        let direct = [self.force, self.rest, self.stiffness, self.damping, self.inertance];
        direct.into_iter().chain(inner).collect()
    }
}

impl InnerSlopes {
    fn all(&self) -> Vec<Expr> {
        let first = [self.force, self.by_stretch, self.by_rate];
        [&first, self.by_inner.as_slice()].concat()
    }
}

/// An inner state in terms of its law.
pub struct InnerSlopes {
    /// ∂force/∂z
    pub force: Expr,
    /// ∂(dz/dt)/∂s
    pub by_stretch: Expr,
    /// ∂(dz/dt)/∂v
    pub by_rate: Expr,
    /// ∂(dz/dt)/∂z of each state.
    pub by_inner: Vec<Expr>,
}

/// The slopes of every link, in the order of the model.
pub fn slopes(model: &Model, g: &mut Graph) -> Vec<Slopes> {
    (0..model.links.len() as u16)
        .map(|link| of_link(model, g, LinkId(link)))
        .collect()
}

fn of_link(model: &Model, g: &mut Graph, id: LinkId) -> Slopes {
    let law = &model.links[usize::from(id.0)].law;
    let (force, inertance) = summed(&law.terms, g, id);
    let by = |g: &mut Graph, e: Expr, leaf: Symbol| Differential::by(g, leaf).of(g, e);
    let states: Vec<Symbol> = (0..law.inner.len() as u16)
        .map(|index| Symbol::Inner(id, index))
        .collect();
    let inner = law.inner.iter().zip(&states).map(|(inner, &state)| InnerSlopes {
        force: by(g, force, state),
        by_stretch: by(g, inner.rate, Symbol::Stretch(id)),
        by_rate: by(g, inner.rate, Symbol::Rate(id)),
        by_inner: states.iter().map(|&other| by(g, inner.rate, other)).collect(),
    });
    let inner = inner.collect();
    let others = law.other_links(g, id).into_iter();
    let others = others.map(|link| (link, by(g, force, Symbol::Stretch(link))));
    let others = others.collect();
    let (stiffness, damping) = (by(g, force, Symbol::Stretch(id)), by(g, force, Symbol::Rate(id)));
    let mut slopes = Slopes {
        force,
        stiffness,
        damping,
        inertance,
        inner,
        others,
        rest: at_rest(g, force),
        nonlinear: false,
    };
    let laws: Vec<Expr> = [force]
        .into_iter()
        .chain(law.inner.iter().map(|inner| inner.rate))
        .collect();
    slopes.nonlinear = laws.into_iter().any(|law| is_nonlinear(g, law));
    slopes
}

/// An expression at rest.
fn at_rest(g: &mut Graph, e: Expr) -> Expr {
    let zero = g.constant(0.0);
    let moves = g
        .symbols([e])
        .into_iter()
        .filter(|leaf| !matches!(leaf, Symbol::Parameter(_)));
    Substitution::new(moves.map(|leaf| (leaf, zero)).collect()).apply(g, e)
}

/// True if twice the motion does not give twice the change, or the opposite motion not the opposite change.
fn is_nonlinear(g: &mut Graph, e: Expr) -> bool {
    let rest = at_rest(g, e);
    let change = g.of(e - rest);
    let value = |seed: u64, size: f64| {
        let leaf = |symbol| match symbol {
            Symbol::Parameter(_) => 0.5 + uniform(1, tag(symbol)),
            _ => size * (2.0 * uniform(seed, tag(symbol)) - 1.0),
        };
        Values::new(g, &leaf).of(change)
    };
    // Small and large motions: all large ones may reach a stop, and small ones may all stay within a gap.
    let sizes = [1.0, 0.1, 0.01, 0.001, 10.0, 100.0];
    let mut points = sizes.into_iter().flat_map(|size| (1..=4).map(move |seed| (seed, size)));
    points.any(|(seed, size)| {
        let (once, twice, back) = (value(seed, size), value(seed, 2.0 * size), value(seed, -size));
        let differ = |a: f64, b: f64| (a - b).abs() > 1e-9 * b.abs();
        differ(2.0 * once, twice) || differ(-once, back)
    })
}

/// The force of terms without inerters, and the sum of the inerters.
pub fn summed(terms: &[Term], g: &mut Graph, id: LinkId) -> (Expr, Expr) {
    let (s, v) = (g.symbol(Symbol::Stretch(id)), g.symbol(Symbol::Rate(id)));
    let (mut force, mut inertance) = (g.constant(0.0), g.constant(0.0));
    for &term in terms {
        match term {
            Term::Inerter(b) => inertance = g.of(inertance + b),
            Term::Spring(k) => force = g.of(force + k * s),
            Term::Damper(c) => force = g.of(force + c * v),
            Term::Force(law) => force = g.of(force + law),
        }
    }
    (force, inertance)
}
