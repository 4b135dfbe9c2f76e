//! Modes of both sides, paired by similarity of shape.

use qcar_runtime::modes;
use serde::Serialize;

use super::sides::Side;
use crate::verbs::study::shapes::{Shape, shape};

/// A mode of both sides, or of one if the other has no similar mode.
#[derive(Serialize)]
pub(super) struct Pair {
    pub a: Option<Shape>,
    pub b: Option<Shape>,
}

/// The pairs by frequency: that of A, or of B for a mode that A lacks.
pub(super) fn pairs([a, b]: &[Side; 2]) -> Vec<Pair> {
    let (first, second) = (of(a), of(b));
    let same = modes::pairs(&first, &second);
    let partner = |place: usize| same.iter().find(|pair| pair.0 == place).map(|pair| pair.1);
    let own = first.iter().enumerate().map(|(place, mode)| Pair {
        a: Some(shape(mode)),
        b: partner(place).map(|place| shape(&second[place])),
    });
    let alone = (0..second.len()).filter(|place| same.iter().all(|pair| pair.1 != *place));
    let added = alone.map(|place| Pair {
        a: None,
        b: Some(shape(&second[place])),
    });
    let mut all: Vec<Pair> = own.chain(added).collect();
    let frequency = |pair: &Pair| pair.a.as_ref().or(pair.b.as_ref()).map_or(0.0, |shape| shape.frequency);
    all.sort_by(|one, other| frequency(one).total_cmp(&frequency(other)));
    all
}

fn of(side: &Side) -> Vec<modes::Mode> {
    modes::modes(&*side.model, &side.values)
}
