//! Massless nodes: their force balance holds at every instant.
//!
//! A balance that depends on the velocity of the node is solved for it, any other for the position. Nodes that dampers
//! connect only to each other are a group: no damper resists their common motion, so the balance of the whole group
//! determines its leader, and the others are determined by their offsets from the leader.

use super::{Derivation, MotionKind};
use crate::derive::combination::combine;
use crate::derive::elimination::{Factors, Symmetric};
use crate::derive::law::Law;
use crate::expr::{CoordinateId, Differential, Expr, Leaves, LinkId, Substitution, Symbol};
use crate::model::CoordinateKind;

impl Derivation<'_> {
    pub(super) fn role(&self, c: CoordinateId) -> MotionKind {
        match self.model.coordinates[c.0 as usize].kind {
            CoordinateKind::Road | CoordinateKind::Motion => MotionKind::Prescribed,
            CoordinateKind::Mass(_) => MotionKind::Inertial,
            CoordinateKind::Node if self.is_held_by(c, |law| law.inertance) => MotionKind::Inertial,
            CoordinateKind::Node if self.is_held_by(c, |law| law.damping) => MotionKind::Damped,
            CoordinateKind::Node => MotionKind::Static,
        }
    }

    fn is_held_by(&self, c: CoordinateId, part: fn(&Law) -> Expr) -> bool {
        let mut links = self.links_of(c);
        links.any(|(l, _)| self.g.as_constant(part(&self.laws[l.0 as usize])) != Some(0.0))
    }

    // Groups

    /// Makes the last node of each group its leader, and expresses the stretches by leaders and offsets.
    pub(super) fn form_groups(&mut self) {
        let mut left = self.with_role(MotionKind::Damped);
        while let Some(first) = left.first().copied() {
            let group = self.joined_by_dampers(first);
            left.retain(|c| !group.contains(c));
            if let Some((&leader, others)) = group.split_last()
                && self.moves_freely(&group)
            {
                self.roles[leader.0 as usize] = MotionKind::Static;
                self.leaders.extend(others.iter().map(|&c| (c, leader)));
            }
        }
        for l in self.links() {
            let reduced = self.by_leaders(l);
            self.reduced.push(reduced);
        }
    }

    fn damped_links(&self) -> impl Iterator<Item = LinkId> {
        self.acting_links()
            .filter(|l| self.g.as_constant(self.laws[l.0 as usize].damping) != Some(0.0))
    }

    /// The damped nodes that dampers join to one of them, in order.
    fn joined_by_dampers(&self, first: CoordinateId) -> Vec<CoordinateId> {
        let mut group = vec![first];
        let mut place = 0;
        while let Some(&c) = group.get(place) {
            for l in self
                .damped_links()
                .filter(|&l| self.stretch_of(l).iter().any(|&(held, _)| held == c))
            {
                let nodes = self.stretch_of(l).iter().map(|&(held, _)| held);
                let found = nodes.filter(|held| self.roles[held.0 as usize] == MotionKind::Damped);
                let new: Vec<_> = found.filter(|held| !group.contains(held)).collect();
                group.extend(new);
            }
            place += 1;
        }
        group.sort();
        group
    }

    /// True where no damper stretches when all of a group move as one.
    fn moves_freely(&mut self, group: &[CoordinateId]) -> bool {
        let links: Vec<LinkId> = self.damped_links().collect();
        links.into_iter().all(|l| {
            let common = self.along(l, |g, c| group.contains(&c).then(|| g.constant(1.0)));
            self.g.as_constant(common) == Some(0.0)
        })
    }

    /// The stretch of a link in terms of leaders and offsets.
    fn by_leaders(&mut self, l: LinkId) -> Vec<(CoordinateId, Expr)> {
        let mut reduced: Vec<(CoordinateId, Expr)> = Vec::new();
        for &(c, coefficient) in self.stretch_of(l) {
            for moved in [Some(c), self.leaders.get(&c).copied()].into_iter().flatten() {
                match reduced.iter_mut().find(|(other, _)| *other == moved) {
                    Some((_, sum)) => *sum = self.g.of(*sum + coefficient),
                    None => reduced.push((moved, coefficient)),
                }
            }
        }
        reduced.retain(|&(_, coefficient)| self.g.as_constant(coefficient) != Some(0.0));
        reduced
    }

    // Balances

    pub(super) fn positions_of_static_nodes(&mut self) {
        let applied = self.applied_to_nodes(MotionKind::Static);
        let solution = self.solve_nodes(MotionKind::Static, applied, |d, l| {
            let law = d.laws[l.0 as usize];
            let given = d.along_others(l, MotionKind::Static, Self::place);
            let mut at_rest = Substitution::new(Leaves::from([(Symbol::Stretch(l), given)]));
            (law.stiffness, at_rest.apply(d.g, law.force))
        });
        self.definitions.extend(
            solution
                .into_iter()
                .map(|(c, position)| (Symbol::Position(c), position)),
        );
        for (c, leader) in self.leaders.clone() {
            let (start, offset) = (
                self.g.symbol(Symbol::Position(leader)),
                self.g.symbol(Symbol::Offset(c)),
            );
            let position = self.g.of(start + offset);
            self.define(Symbol::Position(c), position);
        }
    }

    pub(super) fn velocities_of_damped_nodes(&mut self) {
        let applied = self.applied_to_nodes(MotionKind::Damped);
        let solution = self.solve_nodes(MotionKind::Damped, applied, |d, l| {
            let law = d.laws[l.0 as usize];
            let given = d.along_others(l, MotionKind::Damped, Self::speed);
            let mut at_rest = Substitution::new(Leaves::from([(Symbol::Rate(l), given)]));
            (law.damping, at_rest.apply(d.g, law.force))
        });
        for (c, rate) in solution {
            match self.leaders.contains_key(&c) {
                true => drop(self.offset_rates.insert(c, rate)),
                false => self.define(Symbol::Velocity(c), rate),
            }
        }
    }

    /// The balance of a static node holds at every instant, so its time derivative is zero too. Force inputs there do
    /// not occur: `check` refuses forces whose rate would be needed.
    pub(super) fn velocities_of_static_nodes(&mut self) {
        let steady = vec![self.g.constant(0.0); self.with_role(MotionKind::Static).len()];
        let solution = self.solve_nodes(MotionKind::Static, steady, |d, l| {
            let given = d.along_others(l, MotionKind::Static, Self::speed);
            let mut leaves = Leaves::from([(Symbol::Stretch(l), d.g.symbol(Symbol::Rate(l)))]);
            for (i, inner) in d.model.links[l.0 as usize].law.inner.iter().enumerate() {
                leaves.insert(Symbol::Inner(l, i as u16), inner.rate);
            }
            let growth = Differential::new(leaves).of(d.g, d.laws[l.0 as usize].force);
            let slope = Differential::by(d.g, Symbol::Rate(l)).of(d.g, growth);
            let mut at_rest = Substitution::new(Leaves::from([(Symbol::Rate(l), given)]));
            (slope, at_rest.apply(d.g, growth))
        });
        self.definitions.extend(
            solution
                .into_iter()
                .map(|(c, velocity)| (Symbol::Velocity(c), velocity)),
        );
        for (c, rate) in self.offset_rates.clone() {
            let leader = self.g.symbol(Symbol::Velocity(self.leaders[&c]));
            let velocity = self.g.of(leader + rate);
            self.define(Symbol::Velocity(c), velocity);
        }
    }

    /// The position of a coordinate, or its offset if it has a leader.
    fn place(&mut self, c: CoordinateId) -> Expr {
        let symbol = if self.leaders.contains_key(&c) {
            Symbol::Offset(c)
        } else {
            Symbol::Position(c)
        };
        self.g.symbol(symbol)
    }

    /// The time derivative of `place`.
    fn speed(&mut self, c: CoordinateId) -> Expr {
        let symbol = self.g.symbol(Symbol::Velocity(c));
        self.offset_rates.get(&c).copied().unwrap_or(symbol)
    }

    /// The part of a stretch, or of its rate, by the coordinates of other kinds.
    fn along_others(&mut self, l: LinkId, role: MotionKind, value: fn(&mut Self, CoordinateId) -> Expr) -> Expr {
        let mut terms = self.reduced[l.0 as usize].clone();
        terms.retain(|&(c, _)| self.roles[c.0 as usize] != role);
        let terms: Vec<(Expr, Expr)> = terms
            .into_iter()
            .map(|(c, coefficient)| (coefficient, value(self, c)))
            .collect();
        combine(self.g, terms)
    }

    /// Solves the balances of the nodes of one kind. `law` gives for a link the slope of its force by the unknown, and
    /// the force if that is zero; `applied` gives the other forces on each node.
    fn solve_nodes(
        &mut self,
        role: MotionKind,
        applied: Vec<Expr>,
        law: impl Fn(&mut Self, LinkId) -> (Expr, Expr),
    ) -> Vec<(CoordinateId, Expr)> {
        let nodes = self.with_role(role);
        let mut matrix = Symmetric::new(nodes.len());
        let mut balance = applied;
        for l in self.acting_links() {
            let held = places(&nodes, &self.reduced[l.0 as usize]);
            if held.is_empty() {
                continue;
            }
            let (slope, rest) = law(self, l);
            matrix.add_outer(self.g, &held, slope);
            for &(i, coefficient) in &held {
                balance[i] = self.g.of(balance[i] - coefficient * rest);
            }
        }
        let solution = Factors::of(self.g, matrix).solve(self.g, balance);
        nodes.into_iter().zip(solution).collect()
    }

    fn applied_to_nodes(&mut self, role: MotionKind) -> Vec<Expr> {
        self.with_role(role)
            .into_iter()
            .map(|c| self.applied_to_group(c))
            .collect()
    }

    /// Force inputs on a node and on the nodes that follow it.
    fn applied_to_group(&mut self, c: CoordinateId) -> Expr {
        let mut sum = self.applied(c);
        for (led, leader) in self.leaders.clone() {
            if leader == c {
                let force = self.applied(led);
                sum = self.g.of(sum + force);
            }
        }
        sum
    }

    /// A massless node's velocity is an expression; its time derivative is the acceleration.
    pub(super) fn accelerations_of_nodes(&mut self) {
        let mut by_time = Differential::new(self.rates_of_leaves());
        let is_led = |d: &Self, c: &CoordinateId| d.leaders.contains_key(c);
        let (led, damped): (Vec<_>, Vec<_>) = self
            .with_role(MotionKind::Damped)
            .into_iter()
            .partition(|c| is_led(self, c));
        for c in damped.into_iter().chain(self.with_role(MotionKind::Static)).chain(led) {
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

    fn rates_of_leaves(&mut self) -> Leaves {
        let mut rates = Leaves::new();
        for c in (0..self.roles.len() as u16).map(CoordinateId) {
            rates.insert(Symbol::Position(c), self.g.symbol(Symbol::Velocity(c)));
            rates.insert(Symbol::Velocity(c), self.g.symbol(Symbol::Acceleration(c)));
        }
        rates.extend(self.offset_rates.iter().map(|(&c, &rate)| (Symbol::Offset(c), rate)));
        for l in self.links() {
            rates.insert(Symbol::Stretch(l), self.g.symbol(Symbol::Rate(l)));
            for (i, inner) in self.model.links[l.0 as usize].law.inner.iter().enumerate() {
                rates.insert(Symbol::Inner(l, i as u16), inner.rate);
            }
        }
        rates
    }
}

/// Positions of the coordinates of a stretch in a list, with their coefficients.
///
/// The list is in the order of the coordinates.
pub(super) fn places(list: &[CoordinateId], stretch: &[(CoordinateId, Expr)]) -> Vec<(usize, Expr)> {
    let place = |c| list.binary_search(&c).ok();
    stretch
        .iter()
        .filter_map(|&(c, coefficient)| Some((place(c)?, coefficient)))
        .collect()
}
