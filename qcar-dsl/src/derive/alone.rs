//! A single link on a dynamometer, which moves one of its ends and holds the other.

use crate::check::Checked;
use crate::expr::{CoordinateId, LinkId};
use crate::model::{Coordinate, CoordinateKind, Law, Link, Output, Signal};
use crate::units::Unit;

/// Name of the prescribed motion.
const ROD: &str = "rod";

/// A model of a single link of another model, with the same parameters in the same order: its stretch is the motion
/// `rod`, its force the only output. All other links are empty, and nothing else moves. `None` if the model lacks the
/// link, or if its law uses other links or force inputs, or if it is rotational.
pub fn alone(model: &Checked, axis: &str, name: &str) -> Option<Checked> {
    let is_it = |link: &Link| link.name == name && link.direction.0 == axis;
    let place = model.links.iter().position(is_it)?;
    let (id, link) = (LinkId(place as u16), &model.links[place]);
    let ends = || link.stretch.iter().map(|(end, _)| &model.coordinates[end.0 as usize]);
    let stands_alone =
        link.law.other_links(&model.graph, id).is_empty() && link.law.force_inputs(&model.graph).is_empty();
    if !stands_alone || ends().all(|end| end.angle) {
        return None;
    }
    let signal = Signal::LinkForce(id);
    let mut own = (**model).clone();
    let one = own.graph.constant(1.0);
    own.coordinates = vec![Coordinate {
        name: ROD.into(),
        also: Vec::new(),
        direction: link.direction.clone(),
        kind: CoordinateKind::Motion,
        angle: false,
        doc: String::new(),
        declared: link.declared.clone(),
    }];
    for (at, other) in own.links.iter_mut().enumerate() {
        other.stretch = vec![(CoordinateId(0), one)];
        other.rolling = None;
        if at != place {
            other.law = Law::default();
        }
    }
    own.outputs = vec![Output {
        name: format!("{axis}_{name}_force"),
        signal,
        unit: Unit::NEWTON,
        declared: link.declared.clone(),
    }];
    (own.points, own.forces, own.gravities, own.channels) = Default::default();
    // Whether parameters are determined is checked for the whole model.
    Some(Checked::trust(own).with_unseen(Vec::new(), Vec::new()))
}
