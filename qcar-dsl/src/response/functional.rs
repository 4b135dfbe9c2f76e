//! Outputs as functions of the amplitudes.

use super::change::Change;
use super::load::by_source;
use crate::about::Source;
use crate::check::Checked;
use crate::combination::combine;
use crate::complex::Complex;
use crate::elimination::Scalar;
use crate::expr::{CoordinateId, Expr, Graph, LinkId, Symbol};
use crate::model::{Quantity, Signal};
use crate::stiffness::Stiffness;

/// An output: a factor times a combination of amplitudes.
pub(super) struct Functional {
    /// (jω)ⁿ or the dynamic stiffness of a link.
    pub(super) factor: Complex,
    pub(super) combination: Vec<(CoordinateId, Expr)>,
    /// The link whose stretch the combination is.
    pub(super) stretch_of: Option<usize>,
    /// True where the factor is the dynamic stiffness of that link.
    pub(super) is_force: bool,
}

impl Functional {
    /// The functional of a signal.
    pub(super) fn of(model: &Checked, g: &mut Graph, links: &[Stiffness], signal: &Signal) -> Self {
        let stretch = |l: LinkId| model.links[l.0 as usize].stretch.clone();
        let one = Complex::one(g);
        match *signal {
            Signal::Motion(c, quantity) => {
                let combination = vec![(c, one.re)];
                Functional {
                    factor: order(g, quantity),
                    combination,
                    stretch_of: None,
                    is_force: false,
                }
            }
            Signal::LinkStretch(l) => {
                let stretch_of = Some(l.0 as usize);
                Functional {
                    factor: one,
                    combination: stretch(l),
                    stretch_of,
                    is_force: false,
                }
            }
            Signal::LinkForce(l) => {
                let (factor, stretch_of) = (links[l.0 as usize].total, Some(l.0 as usize));
                Functional {
                    factor,
                    combination: stretch(l),
                    stretch_of,
                    is_force: true,
                }
            }
        }
    }

    /// What a force input adds to the force of a link by itself.
    pub(super) fn input(&self, links: &[Stiffness], source: Source) -> Option<Complex> {
        let link = self.stretch_of.filter(|_| self.is_force)?;
        by_source(&links[link].inputs, source)
    }

    /// How the output changes because its own factor and combination do.
    pub(super) fn derivative(
        &self,
        g: &mut Graph,
        source: Source,
        amplitudes: &[Complex],
        scaled: &[Complex],
        change: &Change,
    ) -> Complex {
        let Some(own) = change.links.iter().find(|link| Some(link.link) == self.stretch_of) else {
            return Complex::zero(g);
        };
        let turned = along(g, &own.stretch, scaled);
        if !self.is_force {
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
