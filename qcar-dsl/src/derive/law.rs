//! The force of a link as a function of stretch, rate and inner states.

use crate::check::Checked;
use crate::check::slopes::summed;
use crate::expr::{Differential, Expr, Graph, LinkId, Symbol};
use crate::model::Term;

/// The resisting force of a link as its law gives it, and its slopes.
#[derive(Clone, Copy, Debug)]
pub struct Law {
    /// The force without inerters, in `Symbol::Stretch`, `Symbol::Rate` and `Symbol::Inner`.
    pub force: Expr,
    /// ∂force/∂s
    pub stiffness: Expr,
    /// ∂force/∂v
    pub damping: Expr,
    /// The sum of the inerters, which adds `inertance dv/dt` to the force.
    pub inertance: Expr,
}

/// The law of a link on the rig.
pub fn standing(model: &Checked, g: &mut Graph, l: LinkId) -> Law {
    law(g, l, &model.links[l.0 as usize].law.terms)
}

/// The law of a rolling tyre.
pub fn rolling(model: &Checked, g: &mut Graph, l: LinkId) -> Law {
    let link = &model.links[l.0 as usize];
    law(g, l, link.rolling.as_ref().unwrap_or(&link.law.terms))
}

fn law(g: &mut Graph, l: LinkId, terms: &[Term]) -> Law {
    let (force, inertance) = summed(terms, g, l);
    let stiffness = Differential::by(g, Symbol::Stretch(l)).of(g, force);
    let damping = Differential::by(g, Symbol::Rate(l)).of(g, force);
    Law {
        force,
        stiffness,
        damping,
        inertance,
    }
}
