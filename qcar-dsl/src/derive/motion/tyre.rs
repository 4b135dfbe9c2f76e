//! The tyre that can roll over a profile.

use crate::check::Checked;
use crate::expr::{CoordinateId, LinkId};
use crate::model::{CoordinateKind, Term};

/// The tyre that can roll over a profile.
#[derive(Clone, Debug)]
pub struct RollingTyre {
    /// Its link.
    pub link: LinkId,
    /// The masses on the tyre: the mass in its stretch, then the mass of the same name in another direction, if any.
    pub wheel: Vec<CoordinateId>,
}

/// The first link between a mass and a road whose law has no inerter.
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
        let is_called_so = c.name == wheel.name || c.also.contains(&wheel.name);
        is_called_so && c.direction != wheel.direction && matches!(c.kind, CoordinateKind::Mass(_))
    });
    let wheel = [own].into_iter().chain(other.map(|c| CoordinateId(c as u16))).collect();
    Some(RollingTyre {
        link: LinkId(place as u16),
        wheel,
    })
}
