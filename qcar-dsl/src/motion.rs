//! Graph to equations of motion.
//!
//! The physics stays factored: the stretch, the rate and the force of each link are symbols with definitions, and
//! forces are scattered to the coordinates by incidence. Nothing is multiplied out.
//!
//! Massless nodes are no stiff penalty masses. The balance of a node that a damper holds is solved for its velocity,
//! and its position is a state; the balance of a node that only springs hold is solved for its position.

use std::collections::BTreeSet;

use crate::check::Checked;
use crate::elimination::{Factors, Symmetric};
use crate::expr::{CoordinateId, Differential, Expr, Graph, Leaves, LinkId, Substitution, Symbol};
use crate::law::{self, Law};
use crate::model::{CoordinateKind, Direction, Quantity, Signal, Term};

/// The equations of motion: definitions, then the rates of the states and the outputs in their terms.
#[derive(Clone, Debug)]
pub struct Motion {
    /// How each coordinate gets its motion, in the order of the model.
    pub roles: Vec<Role>,
    /// Symbols that stand for expressions in the states, the inputs, the parameters and earlier definitions: stretch,
    /// rate and force of each link, positions and velocities of massless nodes, accelerations.
    pub definitions: Vec<(Symbol, Expr)>,
    /// What stands at each place of `x`.
    pub states: Vec<Symbol>,
    /// What stands at each place of `u`.
    pub inputs: Vec<Symbol>,
    /// The time derivative of each state.
    pub rates: Vec<Expr>,
    /// The outputs of the model.
    pub outputs: Vec<Expr>,
}

impl Motion {
    /// Expressions with all definitions put in.
    pub fn expand(&self, graph: &mut Graph, values: &[Expr]) -> Vec<Expr> {
        let mut definitions = Substitution::of_definitions(graph, &self.definitions);
        values.iter().map(|&value| definitions.apply(graph, value)).collect()
    }
}

/// How a coordinate gets its motion.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Role {
    /// A road or another motion: an input.
    Prescribed,
    /// Newton: position and velocity are states. A mass, or a node that an inerter makes heavy.
    Inertial,
    /// A massless node that a damper holds: its position is a state, its balance gives its velocity.
    Damped,
    /// A massless node that only springs hold: its balance gives its position.
    Static,
}

/// The tyre that can roll over a profile.
#[derive(Clone, Debug)]
pub struct RollingTyre {
    /// Its link.
    pub link: LinkId,
    /// What it carries: the mass in its stretch, then the mass of that name in another direction, if there is one.
    pub wheel: Vec<CoordinateId>,
}

/// The equations of motion of a model that stands on its roads.
pub fn derive(model: &Checked, graph: &mut Graph) -> Motion {
    Derivation::new(model, graph, None).run()
}

/// The equations of motion of a model whose tyre rolls: the tyre's stretch and rate and the forces on its wheel are
/// given.
pub fn derive_rolling(model: &Checked, graph: &mut Graph, tyre: &RollingTyre) -> Motion {
    Derivation::new(model, graph, Some(tyre)).run()
}

/// The tyre that can roll: the first link between a mass and a road whose law needs no acceleration.
pub fn rolling_tyre(model: &Checked) -> Option<RollingTyre> {
    let kind = |c: CoordinateId| model.coordinates[c.0 as usize].kind;
    let place = model.links.iter().position(|link| {
        let terms = link.rolling.as_ref().unwrap_or(&link.law.terms);
        let on_road = link.stretch.iter().any(|&(c, _)| kind(c) == CoordinateKind::Road);
        let carries = link
            .stretch
            .iter()
            .any(|&(c, _)| matches!(kind(c), CoordinateKind::Mass(_)));
        let holds_node = link.stretch.iter().any(|&(c, _)| kind(c) == CoordinateKind::Node);
        on_road && carries && !holds_node && !terms.iter().any(|term| matches!(term, Term::Inerter(_)))
    })?;
    let stretch = &model.links[place].stretch;
    let own = stretch
        .iter()
        .map(|&(c, _)| c)
        .find(|&c| matches!(kind(c), CoordinateKind::Mass(_)))?;
    let wheel = &model.coordinates[own.0 as usize];
    let other = model.coordinates.iter().position(|c| {
        c.name == wheel.name && c.direction != wheel.direction && matches!(c.kind, CoordinateKind::Mass(_))
    });
    let wheel = [own].into_iter().chain(other.map(|c| CoordinateId(c as u16))).collect();
    Some(RollingTyre {
        link: LinkId(place as u16),
        wheel,
    })
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
    roles: Vec<Role>,
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
            roles: Vec::new(),
            definitions: Vec::new(),
        };
        derivation.roles = (0..model.coordinates.len())
            .map(|c| derivation.role(CoordinateId(c as u16)))
            .collect();
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

    fn role(&self, c: CoordinateId) -> Role {
        match self.model.coordinates[c.0 as usize].kind {
            CoordinateKind::Road | CoordinateKind::Motion => Role::Prescribed,
            CoordinateKind::Mass(_) => Role::Inertial,
            CoordinateKind::Node => {
                let held_by = |part: fn(&Law) -> Expr| {
                    self.links_of(c)
                        .any(|(l, _)| self.g.as_constant(part(&self.laws[l.0 as usize])) != Some(0.0))
                };
                match () {
                    _ if held_by(|law| law.inertance) => Role::Inertial,
                    _ if held_by(|law| law.damping) => Role::Damped,
                    _ => Role::Static,
                }
            }
        }
    }

    // Geometry

    fn stretch_of(&self, l: LinkId) -> &'a [(CoordinateId, Expr)] {
        &self.model.links[l.0 as usize].stretch
    }

    fn links(&self) -> impl Iterator<Item = LinkId> + use<> {
        (0..self.model.links.len() as u16).map(LinkId)
    }

    /// The links whose forces act on the coordinates by themselves: all but a rolling tyre.
    fn acting_links(&self) -> impl Iterator<Item = LinkId> + use<> {
        let rolling = self.tyre.map(|tyre| tyre.link);
        self.links().filter(move |&l| Some(l) != rolling)
    }

    /// The acting links that hold a coordinate, with its coefficient in their stretch.
    fn links_of(&self, c: CoordinateId) -> impl Iterator<Item = (LinkId, Expr)> + use<'a> {
        let model = self.model;
        self.acting_links().filter_map(move |l| {
            let stretch = &model.links[l.0 as usize].stretch;
            stretch
                .iter()
                .find(|&&(other, _)| other == c)
                .map(|&(_, coefficient)| (l, coefficient))
        })
    }

    fn with_role(&self, role: Role) -> Vec<CoordinateId> {
        let all = (0..self.roles.len()).filter(|&c| self.roles[c] == role);
        all.map(|c| CoordinateId(c as u16)).collect()
    }

    /// `Σ coefficient value(coordinate)` over the stretch of a link, where there is a value.
    fn along(&mut self, l: LinkId, value: impl Fn(&mut Graph, CoordinateId) -> Option<Expr>) -> Expr {
        let mut sum = self.g.constant(0.0);
        for &(c, coefficient) in self.stretch_of(l) {
            if let Some(value) = value(self.g, c) {
                let term = self.g.mul(coefficient, value);
                sum = self.g.add(sum, term);
            }
        }
        sum
    }

    /// As `along`, a symbol for each coordinate but those of one role.
    fn along_others(&mut self, l: LinkId, role: Role, symbol: fn(CoordinateId) -> Symbol) -> Expr {
        let roles = self.roles.clone();
        self.along(l, |g, c| (roles[c.0 as usize] != role).then(|| g.symbol(symbol(c))))
    }

    // Definitions, each in terms of earlier ones

    fn define(&mut self, symbol: Symbol, value: Expr) {
        self.definitions.push((symbol, value));
    }

    fn positions_of_static_nodes(&mut self) {
        self.solve_nodes(Role::Static, Symbol::Position, |d, l| {
            let law = d.laws[l.0 as usize];
            let given = d.along_others(l, Role::Static, Symbol::Position);
            let mut at_rest = Substitution::new(Leaves::from([(Symbol::Stretch(l), given)]));
            (law.stiffness, at_rest.apply(d.g, law.force))
        });
    }

    fn velocities_of_damped_nodes(&mut self) {
        self.solve_nodes(Role::Damped, Symbol::Velocity, |d, l| {
            let law = d.laws[l.0 as usize];
            let given = d.along_others(l, Role::Damped, Symbol::Velocity);
            let mut at_rest = Substitution::new(Leaves::from([(Symbol::Rate(l), given)]));
            (law.damping, at_rest.apply(d.g, law.force))
        });
    }

    /// The balance of a static node holds at every instant, so its time derivative is zero too.
    fn velocities_of_static_nodes(&mut self) {
        self.solve_nodes(Role::Static, Symbol::Velocity, |d, l| {
            let given = d.along_others(l, Role::Static, Symbol::Velocity);
            let mut leaves = Leaves::from([(Symbol::Stretch(l), d.g.symbol(Symbol::Rate(l)))]);
            for (i, inner) in d.model.links[l.0 as usize].law.inner.iter().enumerate() {
                leaves.insert(Symbol::Inner(l, i as u16), inner.rate);
            }
            let growth = Differential::new(leaves).of(d.g, d.laws[l.0 as usize].force);
            let slope = Differential::by(d.g, Symbol::Rate(l)).of(d.g, growth);
            let mut at_rest = Substitution::new(Leaves::from([(Symbol::Rate(l), given)]));
            (slope, at_rest.apply(d.g, growth))
        });
    }

    /// Solves the balances of the nodes of one role for a symbol of each. `law` gives for a link how its force grows
    /// with that symbol's stretch or rate, and what it is when the symbols are zero.
    fn solve_nodes(
        &mut self,
        role: Role,
        symbol: fn(CoordinateId) -> Symbol,
        law: impl Fn(&mut Self, LinkId) -> (Expr, Expr),
    ) {
        let nodes = self.with_role(role);
        let mut matrix = Symmetric::new(nodes.len());
        let mut balance: Vec<Expr> = nodes.iter().map(|&c| self.applied(c)).collect();
        for l in self.acting_links() {
            let held: Vec<(usize, Expr)> = self.places(&nodes, l);
            if held.is_empty() {
                continue;
            }
            let (slope, rest) = law(self, l);
            matrix.add_outer(self.g, &held, slope);
            for &(i, coefficient) in &held {
                let force = self.g.mul(coefficient, rest);
                balance[i] = self.g.sub(balance[i], force);
            }
        }
        let solution = Factors::of(self.g, matrix).solve(self.g, balance);
        self.definitions.extend(nodes.iter().map(|&c| symbol(c)).zip(solution));
    }

    /// Where the coordinates of a link stand in a list, with their coefficients.
    fn places(&self, list: &[CoordinateId], l: LinkId) -> Vec<(usize, Expr)> {
        let place = |c| list.iter().position(|&other| other == c);
        self.stretch_of(l)
            .iter()
            .filter_map(|&(c, coefficient)| Some((place(c)?, coefficient)))
            .collect()
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

    /// Newton, by accelerations relative to what is known of them beforehand: free fall, and prescribed motions.
    fn accelerations(&mut self) {
        let coordinates = self.with_role(Role::Inertial);
        let mut matrix = Symmetric::new(coordinates.len());
        let mut balance: Vec<Expr> = coordinates.iter().map(|&c| self.net_force(c)).collect();
        for (i, &c) in coordinates.iter().enumerate() {
            if let CoordinateKind::Mass(inertia) = self.model.coordinates[c.0 as usize].kind {
                matrix.add(self.g, i, i, inertia);
            }
        }
        let known: Vec<Expr> = (0..self.roles.len())
            .map(|c| self.known_acceleration(CoordinateId(c as u16)))
            .collect();
        for l in self.acting_links() {
            let inertance = self.laws[l.0 as usize].inertance;
            let held = self.places(&coordinates, l);
            let given = self.along(l, |_, c| Some(known[c.0 as usize]));
            let force = self.g.mul(inertance, given);
            matrix.add_outer(self.g, &held, inertance);
            for &(i, coefficient) in &held {
                let share = self.g.mul(coefficient, force);
                balance[i] = self.g.sub(balance[i], share);
            }
        }
        let solution = Factors::of(self.g, matrix).solve(self.g, balance);
        for (&c, relative) in coordinates.iter().zip(solution) {
            let acceleration = self.g.add(relative, known[c.0 as usize]);
            self.define(Symbol::Acceleration(c), acceleration);
        }
    }

    fn known_acceleration(&mut self, c: CoordinateId) -> Expr {
        let coordinate = &self.model.coordinates[c.0 as usize];
        let gravity = self
            .model
            .gravities
            .iter()
            .position(|gravity| gravity.direction == coordinate.direction);
        match (coordinate.kind, gravity) {
            (CoordinateKind::Mass(_), Some(gravity)) if !coordinate.angle => {
                let g = self.g.symbol(Symbol::Gravity(gravity as u16));
                self.g.neg(g)
            }
            (CoordinateKind::Road | CoordinateKind::Motion, _) => self.g.symbol(Symbol::Acceleration(c)),
            _ => self.g.constant(0.0),
        }
    }

    /// The sum of the forces on a coordinate, but for gravity and inerters.
    fn net_force(&mut self, c: CoordinateId) -> Expr {
        let mut sum = self.applied(c);
        for (l, coefficient) in self.links_of(c) {
            let force = self.g.symbol(Symbol::LinkForce(l));
            let share = self.g.mul(coefficient, force);
            sum = self.g.sub(sum, share);
        }
        sum
    }

    /// The sum of the forces that are inputs.
    fn applied(&mut self, c: CoordinateId) -> Expr {
        let mut sum = self.g.constant(0.0);
        let inputs = self.model.forces.iter().enumerate().filter(|(_, force)| force.on == c);
        let contact = self
            .tyre
            .iter()
            .flat_map(|tyre| tyre.wheel.iter().enumerate())
            .filter(|(_, wheel)| **wheel == c);
        let inputs = inputs.map(|(i, _)| Symbol::Force(i as u16));
        for symbol in inputs.chain(contact.map(|(axis, _)| Symbol::ContactForce(axis as u16))) {
            let force = self.g.symbol(symbol);
            sum = self.g.add(sum, force);
        }
        sum
    }

    /// A massless node's velocity is an expression; its time derivative is the acceleration.
    fn accelerations_of_nodes(&mut self) {
        let mut by_time = Differential::new(self.leaf_rates());
        for role in [Role::Damped, Role::Static] {
            for c in self.with_role(role) {
                let found = self
                    .definitions
                    .iter()
                    .find(|(symbol, _)| *symbol == Symbol::Velocity(c));
                if let Some(&(_, velocity)) = found {
                    let acceleration = by_time.of(self.g, velocity);
                    self.define(Symbol::Acceleration(c), acceleration);
                }
            }
        }
    }

    fn leaf_rates(&mut self) -> Leaves {
        let mut rates = Leaves::new();
        for c in (0..self.roles.len() as u16).map(CoordinateId) {
            rates.insert(Symbol::Position(c), self.g.symbol(Symbol::Velocity(c)));
            rates.insert(Symbol::Velocity(c), self.g.symbol(Symbol::Acceleration(c)));
        }
        for l in self.links() {
            rates.insert(Symbol::Stretch(l), self.g.symbol(Symbol::Rate(l)));
            for (i, inner) in self.model.links[l.0 as usize].law.inner.iter().enumerate() {
                rates.insert(Symbol::Inner(l, i as u16), inner.rate);
            }
        }
        rates
    }

    // States and outputs

    /// Positions and velocities of what has inertia, positions of damped nodes, inner states, z first in each; with
    /// their rates.
    fn states(&mut self) -> Vec<(Symbol, Expr)> {
        let model = self.model;
        let (inertial, damped) = (self.ordered(Role::Inertial), self.ordered(Role::Damped));
        let mut states = Vec::new();
        states.extend(
            inertial
                .iter()
                .map(|&c| (Symbol::Position(c), self.g.symbol(Symbol::Velocity(c)))),
        );
        states.extend(
            inertial
                .iter()
                .map(|&c| (Symbol::Velocity(c), self.g.symbol(Symbol::Acceleration(c)))),
        );
        states.extend(
            damped
                .iter()
                .map(|&c| (Symbol::Position(c), self.g.symbol(Symbol::Velocity(c)))),
        );
        for direction in directions(model) {
            for l in self
                .links()
                .filter(|l| model.links[l.0 as usize].direction == direction)
            {
                let inner = model.links[l.0 as usize].law.inner.iter().enumerate();
                states.extend(inner.map(|(i, inner)| (Symbol::Inner(l, i as u16), inner.rate)));
            }
        }
        states
    }

    /// The coordinates of a role, z first.
    fn ordered(&self, role: Role) -> Vec<CoordinateId> {
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
            Signal::Motion(c, Quantity::Position) => self.g.symbol(Symbol::Position(c)),
            Signal::Motion(c, Quantity::Velocity) => self.g.symbol(Symbol::Velocity(c)),
            Signal::Motion(c, Quantity::Acceleration) => self.g.symbol(Symbol::Acceleration(c)),
            Signal::LinkStretch(l) => self.g.symbol(Symbol::Stretch(l)),
            Signal::LinkForce(l) => {
                let acceleration = self.along(l, |g, c| Some(g.symbol(Symbol::Acceleration(c))));
                let force = self.g.symbol(Symbol::LinkForce(l));
                let inertial = self.g.mul(self.laws[l.0 as usize].inertance, acceleration);
                self.g.add(force, inertial)
            }
        }
    }

    /// Keeps the definitions that are used, and collects the inputs.
    fn finish(self, states: Vec<Symbol>, rates: Vec<Expr>, outputs: Vec<Expr>) -> Motion {
        let mut used = self.g.symbols(rates.iter().chain(&outputs).copied());
        // The force of a rolling tyre acts through its contact, and is asked for by itself.
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
        let on = |c: CoordinateId| &model.coordinates[c.0 as usize].direction;
        let forces = model
            .forces
            .iter()
            .enumerate()
            .filter(|(_, force)| *on(force.on) == direction);
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
