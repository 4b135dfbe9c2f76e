//! Outputs as functionals of the amplitudes.

use super::change::Change;
use super::load::by_source;
use crate::check::Checked;
use crate::derive::combination::combine;
use crate::derive::complex::Complex;
use crate::derive::elimination::Scalar;
use crate::derive::stiffness::Stiffness;
use crate::derive::vectors::ExcitationSource;
use crate::expr::{CoordinateId, Expr, Graph, LinkId, Symbol};
use crate::model::{Quantity, Signal};

/// An output: a factor times a combination of amplitudes.
pub(super) struct Functional {
    /// (jω)ⁿ or the dynamic stiffness of a link.
    pub(super) factor: Complex,
    pub(super) combination: Vec<(CoordinateId, Expr)>,
    /// The combination.
    of: Combination,
}

/// The combination of an output.
#[derive(Clone, Copy, PartialEq)]
enum Combination {
    Coordinate,
    Point(usize),
    Stretch(usize),
    /// The stretch of a link whose dynamic stiffness is the factor.
    Force(usize),
}

impl Functional {
    /// The functional of a signal.
    pub(super) fn of(model: &Checked, g: &mut Graph, links: &[Stiffness], signal: &Signal) -> Self {
        let stretch = |l: LinkId| model.links[l.0 as usize].stretch.clone();
        let one = Complex::one(g);
        let (factor, combination, of) = match *signal {
            Signal::Motion(c, quantity) => (order(g, quantity), vec![(c, one.re)], Combination::Coordinate),
            Signal::Point(place, quantity) => {
                let place = usize::from(place);
                let combination = model.points[place].combination.clone();
                (order(g, quantity), combination, Combination::Point(place))
            }
            Signal::LinkStretch(l) => (one, stretch(l), Combination::Stretch(l.0 as usize)),
            Signal::LinkForce(l) => (links[l.0 as usize].total, stretch(l), Combination::Force(l.0 as usize)),
        };
        Functional {
            factor,
            combination,
            of,
        }
    }

    /// Direct contribution of a force input to the force of a link.
    pub(super) fn input(&self, links: &[Stiffness], source: ExcitationSource) -> Option<Complex> {
        match self.of {
            Combination::Force(link) => by_source(&links[link].inputs, source),
            _ => None,
        }
    }

    /// Change of the output by its own factor and combination.
    pub(super) fn derivative(
        &self,
        g: &mut Graph,
        source: ExcitationSource,
        amplitudes: &[Complex],
        scaled: &[Complex],
        change: &Change,
    ) -> Complex {
        let link = match self.of {
            Combination::Coordinate => return Complex::zero(g),
            Combination::Point(place) => return along(g, change.point(place), scaled),
            Combination::Stretch(link) | Combination::Force(link) => link,
        };
        let Some(own) = change.links.iter().find(|own| own.link == link) else {
            return Complex::zero(g);
        };
        let turned = along(g, &own.stretch, scaled);
        if self.of == Combination::Stretch(link) {
            return turned;
        }
        let stiffened = along(g, &self.combination, amplitudes).mul(g, own.stiffness);
        let moved = turned.add(g, stiffened);
        match by_source(&own.inputs, source) {
            Some(pushed) => moved.add(g, pushed),
            None => moved,
        }
    }
}

/// (jω)ⁿ
fn order(g: &mut Graph, quantity: Quantity) -> Complex {
    let omega = g.symbol(Symbol::Frequency);
    let (zero, square) = (g.constant(0.0), g.powi(omega, 2));
    match quantity {
        Quantity::Position => Complex::one(g),
        Quantity::Velocity => Complex { re: zero, im: omega },
        Quantity::Acceleration => Complex {
            re: g.neg(square),
            im: zero,
        },
    }
}

/// `Σ coefficient value(coordinate)`
pub(super) fn along(g: &mut Graph, combination: &[(CoordinateId, Expr)], values: &[Complex]) -> Complex {
    let terms = combination
        .iter()
        .map(|&(c, coefficient)| (coefficient, values[c.0 as usize]));
    combine(g, terms)
}
