//! Point contact: only the height under the wheel's centre acts (thesis sections 2.4.3.1 and 3.3.2.1).

use super::{Change, Touch, Tyre, Wheel};
use crate::road::Road;

const UP: [f64; 2] = [0.0, 1.0];

/// The contact of a point tyre. At a vertical step the deflection jumps, without a rate.
pub(super) fn touch(tyre: &Tyre, road: &Road, wheel: &Wheel) -> Option<Touch> {
    let [x, z] = wheel.position;
    let deflection = tyre.radius - (z - road.height(x));
    let closing = road.slope(x) * wheel.velocity[0] - wheel.velocity[1];
    let change = |rate: f64| Change {
        rate: rate.max(0.0),
        direction: UP,
    };
    (deflection > 0.0).then(|| Touch {
        deflection,
        direction: UP,
        growth: change(closing),
        shrinkage: change(-closing),
    })
}
