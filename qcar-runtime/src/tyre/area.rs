//! The area that the unloaded circle has in common with the ground (thesis section 3.3.2.2).

use std::cell::Cell;

use super::patches::{Line, Patch, candidates, patches};
use super::sweep::{Part, Sweep, Sweeps};
use super::{Change, Touch, Tyre, Wheel, against};
use crate::road::{Circle, Moments, Road};

/// The overlap of the circle with the ground and its change; moments are about the circle's centre.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Overlap {
    /// Area, m².
    pub area: f64,
    /// First moments `[∫ x dA, ∫ z dA]`, m³.
    pub moment: [f64; 2],
    /// Where the circle enters the ground.
    pub growth: Sweep,
    /// Where the circle leaves the ground.
    pub shrinkage: Sweep,
    /// Number of separate patches.
    pub patches: usize,
}

/// The contact of an area tyre.
#[inline(always)]
pub(super) fn touch(tyre: &Tyre, road: &Road, wheel: &Wheel, piece: &Cell<usize>) -> Option<Touch> {
    let circle = Circle {
        centre: wheel.position,
        radius: tyre.radius,
    };
    if !road.carries(piece.get(), &circle) {
        let (first, last) = candidates(road, &circle)?;
        piece.set(last);
        if first < last {
            return general(tyre, &gather(road, &circle, wheel.velocity, (first, last)));
        }
    }
    straight(tyre, wheel, &Line::new(road.segment(piece.get()), &circle))
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

/// The contact on one straight piece of road, where the deflection follows directly, without the area.
#[inline(always)]
fn straight(tyre: &Tyre, wheel: &Wheel, line: &Line) -> Option<Touch> {
    let (chord, is_inside) = line.chord();
    let sweeps = Sweeps::new(tyre.radius, wheel.velocity);
    let (mut parts, is_across) = sweeps.across(line.at(chord.from), line.at(chord.to));
    if !(is_inside && is_across) {
        let clip = line.clip()?;
        let mut sweeps = sweeps;
        sweeps.add(line.at(clip.from), line.at(clip.to));
        parts = sweeps.finish().map(Part::from);
    }
    let deflection = tyre.radius - line.distance;
    Some(with_rates(tyre.rate(deflection), deflection, line.frame().1, parts))
}

#[inline(never)]
fn general(tyre: &Tyre, overlap: &Overlap) -> Option<Touch> {
    if overlap.area <= 0.0 {
        return None;
    }
    let deflection = tyre.deflection(overlap.area);
    let parts = [overlap.growth, overlap.shrinkage].map(Part::from);
    Some(with_rates(
        tyre.rate(deflection),
        deflection,
        against(overlap.moment),
        parts,
    ))
}

#[inline(always)]
pub(super) fn with_rates(rate: f64, deflection: f64, direction: [f64; 2], parts: [Part; 2]) -> Touch {
    let [growth, shrinkage] = parts.map(|Part { flux, direction }| Change {
        rate: flux * rate,
        direction,
    });
    Touch {
        deflection,
        direction,
        growth,
        shrinkage,
    }
}

#[inline(never)]
fn gather(road: &Road, circle: &Circle, velocity: [f64; 2], range: (usize, usize)) -> Overlap {
    let mut sweeps = Sweeps::new(circle.radius, velocity);
    let (mut area, mut moment, mut count) = (0.0, [0.0; 2], 0);
    patches(road, circle, range, |patch| {
        let angle = sweeps.add(patch.from, patch.to);
        let below = rim_integrals(circle.radius, &patch, angle);
        area += patch.ground.area - below.area;
        moment = [
            moment[0] + patch.ground.x - below.x,
            moment[1] + patch.ground.z - below.z,
        ];
        count += 1;
    });
    let [growth, shrinkage] = sweeps.finish();
    Overlap {
        area,
        moment,
        growth,
        shrinkage,
        patches: count,
    }
}

/// The integrals of [`Moments`] over the rim below the ground instead of the ground: `x = r sin φ`, `z = -r cos φ`,
/// over an arc of `angle`.
#[inline]
fn rim_integrals(radius: f64, patch: &Patch, angle: f64) -> Moments {
    let ([x0, z0], [x1, z1]) = (patch.from, patch.to);
    let cubes = |from: f64, to: f64| (to * to * to - from * from * from) / 3.0;
    Moments {
        area: (x1 * z1 - x0 * z0 - radius * radius * angle) / 2.0,
        x: -cubes(z0, z1),
        z: (radius * radius * (x1 - x0) - cubes(x0, x1)) / 2.0,
    }
}
