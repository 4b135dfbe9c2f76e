//! Newton: accelerations of coordinates with inertia.

use super::nodes::places;
use super::{Derivation, MotionKind};
use crate::derive::elimination::{Factors, Symmetric};
use crate::expr::{CoordinateId, Expr, Symbol};
use crate::model::CoordinateKind;

impl Derivation<'_> {
    /// Newton's equations for accelerations relative to the known ones: free fall, and prescribed motions.
    pub(super) fn accelerations(&mut self) {
        let coordinates = self.with_role(MotionKind::Inertial);
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
            let held = places(&coordinates, self.stretch_of(l));
            let given = self.along(l, |_, c| Some(known[c.0 as usize]));
            let force = self.g.of(inertance * given);
            matrix.add_outer(self.g, &held, inertance);
            for &(i, coefficient) in &held {
                balance[i] = self.g.of(balance[i] - coefficient * force);
            }
        }
        let solution = Factors::of(self.g, matrix).solve(self.g, balance);
        for (&c, relative) in coordinates.iter().zip(solution) {
            let acceleration = self.g.of(relative + known[c.0 as usize]);
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
                self.g.of(-g)
            }
            (CoordinateKind::Road | CoordinateKind::Motion, _) => self.g.symbol(Symbol::Acceleration(c)),
            _ => self.g.constant(0.0),
        }
    }

    /// Sum of the forces on a coordinate without gravity and inerters.
    fn net_force(&mut self, c: CoordinateId) -> Expr {
        let mut sum = self.applied(c);
        for (l, coefficient) in self.links_of(c) {
            let force = self.g.symbol(Symbol::LinkForce(l));
            sum = self.g.of(sum - coefficient * force);
        }
        sum
    }

    /// The sum of the forces that are inputs.
    pub(super) fn applied(&mut self, c: CoordinateId) -> Expr {
        let mut sum = self.g.constant(0.0);
        for (i, force) in self.model.forces.iter().enumerate() {
            for &(_, coefficient) in force.on.iter().filter(|(pushed, _)| *pushed == c) {
                let force = self.g.symbol(Symbol::Force(i as u16));
                sum = self.g.of(sum + coefficient * force);
            }
        }
        let contact = self
            .tyre
            .iter()
            .flat_map(|tyre| tyre.wheel.iter().enumerate())
            .filter(|(_, wheel)| **wheel == c);
        for (axis, _) in contact {
            let force = self.g.symbol(Symbol::ContactForce(axis as u16));
            sum = self.g.of(sum + force);
        }
        sum
    }
}
