//! The area that the unloaded circle has in common with the ground (thesis section 3.3.2.2).

use super::circle::{flat_chord, segment_ratio};
use super::patches::{Line, Patch, candidates, patches};
use super::sweep::{Sweep, Sweeps};
use super::{Change, Touch, Tyre, Wheel, against};
use crate::road::{Circle, Road};

/// The overlap of the circle with the ground and its change; moments are about the circle's centre.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Overlap {
    /// m².
    pub area: f64,
    /// First moments `[∫ x dA, ∫ z dA]`, m³.
    pub moment: [f64; 2],
    /// Where the circle enters the ground.
    pub growth: Sweep,
    /// Where the circle leaves the ground.
    pub shrinkage: Sweep,
    /// How many separate patches there are.
    pub patches: usize,
}

/// The contact by area.
#[inline]
pub(super) fn touch(tyre: &Tyre, road: &Road, wheel: &Wheel) -> Option<Touch> {
    let circle = Circle {
        centre: wheel.position,
        radius: tyre.radius,
    };
    let (first, last) = candidates(road, &circle)?;
    if first == last {
        let line = Line::new(road.segment(first), &circle);
        straight(tyre, wheel, &line)
    } else {
        general(tyre, &gather(road, &circle, wheel.velocity, (first, last)))
    }
}

/// The overlap of a circle with a road.
pub(super) fn overlap(radius: f64, road: &Road, wheel: &Wheel) -> Overlap {
    let circle = Circle {
        centre: wheel.position,
        radius,
    };
    let (first, last) = candidates(road, &circle).unwrap_or((1, 0));
    gather(road, &circle, wheel.velocity, (first, last))
}

/// On one straight piece of road the deflection is seen without a detour over the area.
#[inline]
fn straight(tyre: &Tyre, wheel: &Wheel, line: &Line) -> Option<Touch> {
    let clip = line.clip()?;
    let mut sweeps = Sweeps::new(tyre.radius, wheel.velocity);
    sweeps.add(line.at(clip.from), line.at(clip.to));
    let (_, down) = line.frame();
    let deflection = tyre.radius - line.distance;
    Some(with_rates(
        tyre,
        deflection,
        [-down[0], -down[1]],
        &sweeps.growth,
        &sweeps.shrinkage,
    ))
}

fn general(tyre: &Tyre, overlap: &Overlap) -> Option<Touch> {
    if overlap.area <= 0.0 {
        return None;
    }
    let deflection = tyre.deflection(overlap.area);
    Some(with_rates(
        tyre,
        deflection,
        against(overlap.moment),
        &overlap.growth,
        &overlap.shrinkage,
    ))
}

#[inline]
fn with_rates(tyre: &Tyre, deflection: f64, direction: [f64; 2], growth: &Sweep, shrinkage: &Sweep) -> Touch {
    let chord = tyre.radius * flat_chord(tyre.rate_deflection(deflection) / tyre.radius);
    let change = |sweep: &Sweep| Change {
        rate: sweep.flux / chord,
        direction: against(sweep.moment),
    };
    Touch {
        deflection,
        direction,
        growth: change(growth),
        shrinkage: change(shrinkage),
    }
}

fn gather(road: &Road, circle: &Circle, velocity: [f64; 2], range: (usize, usize)) -> Overlap {
    let mut sweeps = Sweeps::new(circle.radius, velocity);
    let (mut area, mut moment, mut count) = (0.0, [0.0; 2], 0);
    patches(road, circle, range, |patch| {
        let (own_area, own_moment) = area_and_moment(circle.radius, &patch);
        area += own_area;
        moment = [moment[0] + own_moment[0], moment[1] + own_moment[1]];
        count += 1;
        sweeps.add(patch.from, patch.to);
    });
    Overlap {
        area,
        moment,
        growth: sweeps.growth,
        shrinkage: sweeps.shrinkage,
        patches: count,
    }
}

/// The circular segment below the chord, whose moment has length `2/3 r³ sin³ δ`, and the ground above the chord.
fn area_and_moment(radius: f64, patch: &Patch) -> (f64, [f64; 2]) {
    let [dx, dz] = [patch.to[0] - patch.from[0], patch.to[1] - patch.from[1]];
    let r2 = radius * radius;
    let sine2 = (dx * dx + dz * dz) / (4.0 * r2);
    let segment = r2 * sine2 * sine2.sqrt() * segment_ratio(sine2);
    let lever = r2 * sine2 / 3.0;
    let above = &patch.above_chord;
    (segment + above.area, [lever * dz + above.x, above.z - lever * dx])
}
