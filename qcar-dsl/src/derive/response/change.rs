//! Changes by a parameter: laws and stretches of links, inertias, and the effects of force inputs.

use super::load::Load;
use crate::check::Checked;
use crate::derive::complex::Complex;
use crate::derive::elimination::Scalar;
use crate::derive::stiffness::Stiffness;
use crate::derive::vectors::ExcitationSource;
use crate::expr::{CoordinateId, Differential, Expr, Graph, Symbol};
use crate::model::CoordinateKind;

/// Changes by one parameter.
pub(super) struct Change {
    pub(super) links: Vec<LinkChange>,
    pub(super) inertias: Vec<(usize, Expr)>,
    /// The loads of the force inputs.
    pub(super) loads: Vec<Load>,
    /// Combinations of points, by position.
    points: Vec<(usize, Vec<(CoordinateId, Expr)>)>,
}

/// Change of a link by a parameter.
pub(super) struct LinkChange {
    pub(super) link: usize,
    pub(super) stiffness: Complex,
    pub(super) stretch: Vec<(CoordinateId, Expr)>,
    /// Change of the effect of force inputs in its law.
    pub(super) inputs: Vec<(u16, Complex)>,
}

impl Change {
    /// Change of the combination of a point.
    pub(super) fn point(&self, place: usize) -> &[(CoordinateId, Expr)] {
        let found = self.points.iter().find(|(own, _)| *own == place);
        found.map_or(&[], |(_, slopes)| slopes)
    }

    /// Change of the direct effect of an excitation.
    pub(super) fn pushed(&self, source: ExcitationSource) -> &[(usize, Complex)] {
        match source {
            ExcitationSource::Force(i) => &self.loads[i as usize],
            ExcitationSource::Motion(_) => &[],
        }
    }
}

pub(super) fn change(model: &Checked, g: &mut Graph, links: &[Stiffness], loads: &[Load], parameter: u16) -> Change {
    let mut by = Differential::by(g, Symbol::Parameter(parameter));
    let mut changed = Vec::new();
    for (link, parts) in links.iter().enumerate() {
        let stiffness = parts.total.derivative(g, &mut by);
        let slopes = model.links[link]
            .stretch
            .iter()
            .map(|&(c, coefficient)| (c, by.of(g, coefficient)));
        let mut stretch: Vec<(CoordinateId, Expr)> = slopes.collect();
        stretch.retain(|&(_, slope)| !slope.is_zero(g));
        let slopes = parts.inputs.iter();
        let mut inputs: Vec<_> = slopes
            .map(|&(input, force)| (input, force.derivative(g, &mut by)))
            .collect();
        inputs.retain(|(_, slope)| !slope.is_zero(g));
        if !stiffness.is_zero(g) || !stretch.is_empty() || !inputs.is_empty() {
            changed.push(LinkChange {
                link,
                stiffness,
                stretch,
                inputs,
            });
        }
    }
    let mut inertias = Vec::new();
    for c in 0..model.coordinates.len() {
        if let Some(inertia) = inertia(model, c) {
            inertias.push((c, by.of(g, inertia)));
        }
    }
    inertias.retain(|&(_, slope)| !slope.is_zero(g));
    let mut slope = |load: &Load| -> Load {
        let slopes = load.iter().map(|&(c, force)| (c, force.derivative(g, &mut by)));
        slopes.collect()
    };
    let loads = loads.iter().map(&mut slope).collect();
    let mut points = Vec::new();
    for (place, point) in model.points.iter().enumerate() {
        let mut slopes = point.combination.clone();
        slopes.iter_mut().for_each(|(_, share)| *share = by.of(g, *share));
        slopes.retain(|(_, slope)| !slope.is_zero(g));
        if !slopes.is_empty() {
            points.push((place, slopes));
        }
    }
    Change {
        points,
        links: changed,
        inertias,
        loads,
    }
}

/// Change of a mass.
pub(super) fn inertia(model: &Checked, c: usize) -> Option<Expr> {
    match model.coordinates[c].kind {
        CoordinateKind::Mass(inertia) => Some(inertia),
        _ => None,
    }
}
