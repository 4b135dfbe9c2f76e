//! The circle's closed forms, accurate for the shortest arcs.

use std::array;

use super::series::{ANGLE, DEFLECTION, DOWN, FORWARD, value};

/// Largest `sin² θ/2` for the series of an arc.
const SHORT_ARC: f64 = 0.09;
/// Largest parabolic deflection, in radii, for the series of [`segment_deflection`].
const SMALL_DEFLECTION: f64 = 0.15;

/// The angle of a sine and cosine, by a power series for all but the longest arcs.
#[inline]
pub(super) fn angle(sine: f64, cosine: f64) -> f64 {
    angles([sine], [cosine])[0]
}

/// Several angles, which the processor computes in parallel.
#[inline]
pub(super) fn angles<const N: usize>(sine: [f64; N], cosine: [f64; N]) -> [f64; N] {
    match short_arcs(cosine) {
        Some(y) => array::from_fn(|i| sine[i] * value(&ANGLE, y[i])),
        None => array::from_fn(|i| sine[i].atan2(cosine[i])),
    }
}

/// The unit vectors along `[θ - sin θ cos θ, sin² θ]`, and true if all arcs are short; otherwise the vectors are not
/// valid.
#[inline(always)]
pub(super) fn swept_directions<const N: usize>(sine: [f64; N], cosine: [f64; N]) -> ([[f64; 2]; N], bool) {
    let y = cosine.map(half_squared_sine);
    let directions = array::from_fn(|i| [sine[i] * value(&FORWARD, y[i]), value(&DOWN, y[i])]);
    (directions, y.iter().fold(true, |short, y| short & (*y < SHORT_ARC)))
}

/// `sin² θ/2`.
#[inline(always)]
fn half_squared_sine(cosine: f64) -> f64 {
    0.5 * (1.0 - cosine)
}

/// The same for several arcs; `None` if one of them is not short.
#[inline]
fn short_arcs<const N: usize>(cosine: [f64; N]) -> Option<[f64; N]> {
    let y = cosine.map(half_squared_sine);
    y.iter().all(|y| *y < SHORT_ARC).then_some(y)
}

/// Area that the unit circle has in common with a flat road at `deflection` (0 to 2): equation 3.4 of the thesis.
#[inline]
pub fn segment_area(deflection: f64) -> f64 {
    let deflection = deflection.clamp(0.0, 2.0);
    let cosine = 1.0 - deflection;
    let sine = flat_chord(deflection) / 2.0;
    angle(sine, cosine) - cosine * sine
}

/// The inverse of [`segment_area`]: a power series in `area^(2/3)`, polished by Newton's method where that is slow.
#[inline]
pub fn segment_deflection(area: f64) -> f64 {
    // Deflection of the parabola that osculates the circle: area = 4/3 sqrt(2 d³).
    let parabolic = (area * area * (9.0 / 32.0)).cbrt();
    let start = parabolic * value(&DEFLECTION, parabolic);
    if parabolic < SMALL_DEFLECTION {
        start
    } else {
        polish(area, start.min(2.0))
    }
}

/// Newton's method keeps to (0, 2), where the area grows with the deflection by the length of the chord.
fn polish(area: f64, start: f64) -> f64 {
    const STEPS: usize = 60;
    let area = area.min(std::f64::consts::PI);
    let (mut low, mut high, mut deflection) = (0.0_f64, 2.0_f64, start);
    for _ in 0..STEPS {
        let excess = segment_area(deflection) - area;
        if excess > 0.0 {
            high = deflection
        } else {
            low = deflection
        }
        let newton = deflection - excess / flat_chord(deflection);
        let next = if newton > low && newton < high {
            newton
        } else {
            (low + high) / 2.0
        };
        if (next - deflection).abs() <= f64::EPSILON * deflection {
            return next;
        }
        deflection = next;
    }
    deflection
}

/// Length of the unit circle's chord in a flat road at `deflection`: the derivative of [`segment_area`].
pub(super) fn flat_chord(deflection: f64) -> f64 {
    2.0 * (deflection * (2.0 - deflection)).max(0.0).sqrt()
}
