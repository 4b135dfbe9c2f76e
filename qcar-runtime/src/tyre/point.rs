//! Point contact: only the height under the wheel's centre acts (thesis sections 2.4.3.1 and 3.3.2.1).

use super::{Change, Touch, Tyre, Wheel};
use crate::road::{Road, Segment};

const UP: [f64; 2] = [0.0, 1.0];

/// The contact of a point tyre. At a vertical step the deflection jumps, without a rate.
pub(super) fn touch(tyre: &Tyre, road: &Road, wheel: &Wheel) -> Option<Touch> {
    let touch = touch_piece(tyre, road.segment(road.segment_at(wheel.position[0])), wheel);
    (touch.deflection > 0.0).then_some(touch)
}

/// The contact with one straight piece of the road, which goes on beyond its ends. Without contact, its deflection is
/// negative.
pub(super) fn touch_piece(tyre: &Tyre, piece: &Segment, wheel: &Wheel) -> Touch {
    let ([x, z], slope) = (wheel.position, piece.along[1] / piece.along[0]);
    let height = piece.origin[1] + (x - piece.origin[0]) * piece.along[1] / piece.along[0];
    let closing = slope * wheel.velocity[0] - wheel.velocity[1];
    let change = |rate: f64| Change {
        rate: rate.max(0.0),
        direction: UP,
    };
    Touch {
        deflection: tyre.radius - (z - height),
        direction: UP,
        growth: change(closing),
        shrinkage: change(-closing),
    }
}
