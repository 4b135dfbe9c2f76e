//! Equations of motion from the graph.
//!
//! The physics stays factored: the stretch, the rate and the force of each link are symbols with definitions, and
//! forces are scattered to the coordinates by incidence. Nothing is multiplied out.
//!
//! Massless nodes are not replaced by small masses. If a damper acts on a node, its balance is solved for its velocity,
//! and its position is a state; if only springs do, its balance is solved for its position.

// Tyres that may roll.
mod tyre;
// Force balances of massless nodes.
mod nodes;
// Newton's equations of masses.
mod newton;

use std::collections::{BTreeMap, BTreeSet};

use crate::check::Checked;
use crate::derive::combination::combine;
use crate::derive::law::{self, Law};
use crate::expr::{CoordinateId, Expr, Graph, LinkId, Substitution, Symbol};
use crate::model::{CoordinateKind, Direction, Signal};

pub use tyre::{RollingTyre, rolling_tyre};

/// The equations of motion: definitions, then the rates of the states and the outputs in their terms.
#[derive(Clone, Debug)]
pub struct Motion {
    /// Kind of motion of each coordinate, in the order of the model.
    pub roles: Vec<MotionKind>,
    /// Symbols for expressions in the states, the inputs, the parameters and earlier definitions: stretch, rate and
    /// force of each link, positions and velocities of massless nodes, accelerations.
    pub definitions: Vec<(Symbol, Expr)>,
    /// Symbol of each entry of `x`.
    pub states: Vec<Symbol>,
    /// Symbol of each entry of `u`.
    pub inputs: Vec<Symbol>,
    /// The time derivative of each state.
    pub rates: Vec<Expr>,
    /// The outputs of the model.
    pub outputs: Vec<Expr>,
}

impl Motion {
    /// Expressions with all definitions substituted.
    pub fn expand(&self, graph: &mut Graph, values: &[Expr]) -> Vec<Expr> {
        let mut definitions = Substitution::of_definitions(graph, &self.definitions);
        values.iter().map(|&value| definitions.apply(graph, value)).collect()
    }
}

/// Kind of motion of a coordinate.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum MotionKind {
    /// A road or another motion: an input.
    Prescribed,
    /// Newton: position and velocity are states, for a mass or a node with an inerter.
    Inertial,
    /// A massless node with a damper: its position is a state, its balance gives its velocity.
    Damped,
    /// A massless node with springs only: its balance gives its position.
    Static,
}

/// The equations of motion of a model on its roads.
pub fn derive(model: &Checked, graph: &mut Graph) -> Motion {
    Derivation::new(model, graph, None).run()
}

/// The equations of motion of a model with a rolling tyre, whose stretch, rate and forces on the wheel are inputs.
pub fn derive_rolling(model: &Checked, graph: &mut Graph, tyre: &RollingTyre) -> Motion {
    Derivation::new(model, graph, Some(tyre)).run()
}

/// The directions of a model: z first, the others in the order of the text.
pub fn directions(model: &Checked) -> Vec<Direction> {
    let mut directions: Vec<Direction> = Vec::new();
    for direction in model.coordinates.iter().map(|c| &c.direction) {
        if !directions.contains(direction) {
            directions.push(direction.clone());
        }
    }
    directions.sort_by_key(|direction| direction.0 != "z");
    directions
}

struct Derivation<'a> {
    model: &'a Checked,
    g: &'a mut Graph,
    tyre: Option<&'a RollingTyre>,
    laws: Vec<Law>,
    /// The links that hold each coordinate, with its coefficient in their stretch.
    held_by: Vec<Vec<(LinkId, Expr)>>,
    roles: Vec<MotionKind>,
    /// The leader of each node in a group whose dampers connect only its own nodes; the node keeps its offset from the
    /// leader.
    leaders: BTreeMap<CoordinateId, CoordinateId>,
    /// The stretch of each link by leaders and offsets.
    reduced: Vec<Vec<(CoordinateId, Expr)>>,
    offset_rates: BTreeMap<CoordinateId, Expr>,
    definitions: Vec<(Symbol, Expr)>,
}

impl<'a> Derivation<'a> {
    fn new(model: &'a Checked, g: &'a mut Graph, tyre: Option<&'a RollingTyre>) -> Self {
        let rolls = |l| tyre.is_some_and(|tyre| tyre.link == l);
        let law = |l| {
            if rolls(l) {
                law::rolling(model, g, l)
            } else {
                law::standing(model, g, l)
            }
        };
        let laws = (0..model.links.len() as u16).map(LinkId).map(law).collect();
        let mut derivation = Derivation {
            model,
            g,
            tyre,
            laws,
            held_by: held_by(model),
            roles: Vec::new(),
            leaders: BTreeMap::new(),
            reduced: Vec::new(),
            offset_rates: BTreeMap::new(),
            definitions: Vec::new(),
        };
        derivation.roles = (0..model.coordinates.len())
            .map(|c| derivation.role(CoordinateId(c as u16)))
            .collect();
        derivation.form_groups();
        derivation
    }

    fn run(mut self) -> Motion {
        self.positions_of_static_nodes();
        self.stretches();
        self.velocities_of_damped_nodes();
        self.velocities_of_static_nodes();
        self.rates_of_links();
        self.forces_of_links();
        self.accelerations();
        self.accelerations_of_nodes();
        let (states, rates) = self.states().into_iter().unzip();
        let outputs = self
            .model
            .outputs
            .iter()
            .map(|output| self.signal(&output.signal))
            .collect();
        self.finish(states, rates, outputs)
    }

    // Geometry

    fn stretch_of(&self, l: LinkId) -> &'a [(CoordinateId, Expr)] {
        &self.model.links[l.0 as usize].stretch
    }

    fn links(&self) -> impl Iterator<Item = LinkId> + use<> {
        (0..self.model.links.len() as u16).map(LinkId)
    }

    /// The links whose forces act on the coordinates directly: all but a rolling tyre.
    fn acting_links(&self) -> impl Iterator<Item = LinkId> + use<> {
        let rolling = self.tyre.map(|tyre| tyre.link);
        self.links().filter(move |&l| Some(l) != rolling)
    }

    /// The acting links that hold a coordinate, with its coefficient in their stretch.
    fn links_of(&self, c: CoordinateId) -> impl Iterator<Item = (LinkId, Expr)> + use<> {
        let rolling = self.tyre.map(|tyre| tyre.link);
        let held = self.held_by[c.0 as usize].clone();
        held.into_iter().filter(move |&(l, _)| Some(l) != rolling)
    }

    fn with_role(&self, role: MotionKind) -> Vec<CoordinateId> {
        let all = (0..self.roles.len()).filter(|&c| self.roles[c] == role);
        all.map(|c| CoordinateId(c as u16)).collect()
    }

    /// `Σ coefficient value(coordinate)` over the stretch of a link, for the coordinates with a value.
    fn along(&mut self, l: LinkId, value: impl Fn(&mut Graph, CoordinateId) -> Option<Expr>) -> Expr {
        let held = self.stretch_of(l).iter();
        let terms = held.filter_map(|&(c, coefficient)| Some((coefficient, value(self.g, c)?)));
        let terms: Vec<(Expr, Expr)> = terms.collect();
        combine(self.g, terms)
    }

    // Definitions, each in terms of earlier ones

    fn define(&mut self, symbol: Symbol, value: Expr) {
        self.definitions.push((symbol, value));
    }

    fn stretches(&mut self) {
        for l in self.acting_links() {
            let stretch = self.along(l, |g, c| Some(g.symbol(Symbol::Position(c))));
            self.define(Symbol::Stretch(l), stretch);
        }
    }

    fn rates_of_links(&mut self) {
        for l in self.acting_links() {
            let rate = self.along(l, |g, c| Some(g.symbol(Symbol::Velocity(c))));
            self.define(Symbol::Rate(l), rate);
        }
    }

    fn forces_of_links(&mut self) {
        for l in self.links() {
            self.define(Symbol::LinkForce(l), self.laws[l.0 as usize].force);
        }
    }

    // States and outputs

    /// Positions and velocities of coordinates with inertia, positions of damped nodes, inner states, each with z
    /// first; with their rates.
    fn states(&mut self) -> Vec<(Symbol, Expr)> {
        let model = self.model;
        let (inertial, damped) = (self.ordered(MotionKind::Inertial), self.ordered(MotionKind::Damped));
        let mut states: Vec<(Symbol, Expr)> = inertial.iter().map(|&c| self.moving(c)).collect();
        let accelerating = |&c: &CoordinateId| (Symbol::Velocity(c), self.g.symbol(Symbol::Acceleration(c)));
        states.extend(inertial.iter().map(accelerating));
        states.extend(damped.iter().map(|&c| self.moving(c)));
        for direction in directions(model) {
            let own = |l: &LinkId| model.links[l.0 as usize].direction == direction;
            for l in self.links().filter(own) {
                let inner = model.links[l.0 as usize].law.inner.iter().enumerate();
                states.extend(inner.map(|(i, inner)| (Symbol::Inner(l, i as u16), inner.rate)));
            }
        }
        states
    }

    /// A position that is a state, or an offset, with its rate.
    fn moving(&mut self, c: CoordinateId) -> (Symbol, Expr) {
        match self.offset_rates.get(&c) {
            Some(&rate) => (Symbol::Offset(c), rate),
            None => (Symbol::Position(c), self.g.symbol(Symbol::Velocity(c))),
        }
    }

    /// The coordinates of a role, z first.
    fn ordered(&self, role: MotionKind) -> Vec<CoordinateId> {
        let directions = directions(self.model);
        let mut coordinates = self.with_role(role);
        coordinates.sort_by_key(|c| {
            let own = &self.model.coordinates[c.0 as usize].direction;
            directions.iter().position(|direction| direction == own)
        });
        coordinates
    }

    fn signal(&mut self, signal: &Signal) -> Expr {
        match *signal {
            Signal::Motion(c, quantity) => self.g.symbol(Symbol::of_motion(c, quantity)),
            Signal::Point(point, quantity) => {
                let combination = self.model.points[usize::from(point)].combination.iter();
                let motions =
                    combination.map(|&(c, coefficient)| (coefficient, self.g.symbol(Symbol::of_motion(c, quantity))));
                let motions: Vec<(Expr, Expr)> = motions.collect();
                combine(self.g, motions)
            }
            Signal::LinkStretch(l) => self.g.symbol(Symbol::Stretch(l)),
            Signal::LinkForce(l) => {
                let acceleration = self.along(l, |g, c| Some(g.symbol(Symbol::Acceleration(c))));
                let force = self.g.symbol(Symbol::LinkForce(l));
                self.g.of(force + self.laws[l.0 as usize].inertance * acceleration)
            }
        }
    }

    /// Keeps the used definitions, and collects the inputs.
    fn finish(self, states: Vec<Symbol>, rates: Vec<Expr>, outputs: Vec<Expr>) -> Motion {
        let mut used = self.g.symbols(rates.iter().chain(&outputs).copied());
        // The force of a rolling tyre acts through its contact, and is evaluated separately.
        used.extend(self.tyre.map(|tyre| Symbol::LinkForce(tyre.link)));
        let mut definitions = self.definitions;
        for &(symbol, value) in definitions.iter().rev() {
            if used.contains(&symbol) {
                used.extend(self.g.symbols([value]));
            }
        }
        definitions.retain(|(symbol, _)| used.contains(symbol));
        let inputs = inputs(self.model, &used);
        Motion {
            roles: self.roles,
            definitions,
            states,
            inputs,
            rates,
            outputs,
        }
    }
}

fn held_by(model: &Checked) -> Vec<Vec<(LinkId, Expr)>> {
    let mut held_by = vec![Vec::new(); model.coordinates.len()];
    for (l, link) in (0..).map(LinkId).zip(&model.links) {
        for &(c, coefficient) in &link.stretch {
            held_by[c.0 as usize].push((l, coefficient));
        }
    }
    held_by
}

/// Of each direction its motions (with acceleration where it is used), its forces, its gravity.
fn inputs(model: &Checked, used: &BTreeSet<Symbol>) -> Vec<Symbol> {
    let mut inputs = Vec::new();
    for direction in directions(model) {
        for (c, coordinate) in model.coordinates.iter().enumerate() {
            let c = CoordinateId(c as u16);
            if coordinate.direction == direction
                && matches!(coordinate.kind, CoordinateKind::Road | CoordinateKind::Motion)
            {
                inputs.extend([Symbol::Position(c), Symbol::Velocity(c)]);
                inputs.extend(Some(Symbol::Acceleration(c)).filter(|symbol| used.contains(symbol)));
            }
        }
        let forces = model.forces.iter().enumerate();
        let forces = forces.filter(|(_, force)| force.direction == direction);
        inputs.extend(forces.map(|(i, _)| Symbol::Force(i as u16)));
        let gravities = model
            .gravities
            .iter()
            .enumerate()
            .filter(|(_, gravity)| gravity.direction == direction);
        inputs.extend(gravities.map(|(i, _)| Symbol::Gravity(i as u16)));
    }
    inputs
}
