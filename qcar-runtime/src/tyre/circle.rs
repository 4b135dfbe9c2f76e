//! The circle's closed forms, accurate for the shortest arcs.

use std::array;

/// Terms of the power series below; the first one left out is below 1e-13 where they are used.
const TERMS: usize = 12;
/// Largest squared tangent of the half angle for the series of the arc tangent.
const SHORT_ARC: f64 = 0.1;
/// Largest parabolic deflection, in radii, for the series of [`segment_deflection`].
const SMALL_DEFLECTION: f64 = 0.15;

const ARC_TANGENT_SERIES: [f64; TERMS] = arc_tangent_series();
const DEFLECTION_SERIES: [f64; TERMS] = deflection_series();

/// The angle of a sine and cosine: twice the arc tangent of its half, by the power series for all but the longest arcs.
#[inline]
pub(super) fn angle(sine: f64, cosine: f64) -> f64 {
    angles([sine], [cosine])[0]
}

/// Several angles at once: the processor computes them side by side.
#[inline]
pub(super) fn angles<const N: usize>(sine: [f64; N], cosine: [f64; N]) -> [f64; N] {
    let tangent: [f64; N] = array::from_fn(|i| sine[i] / (1.0 + cosine[i]));
    let squared = tangent.map(|tangent| tangent * tangent);
    if squared.iter().all(|squared| *squared < SHORT_ARC) {
        array::from_fn(|i| 2.0 * tangent[i] * polynomial(&ARC_TANGENT_SERIES, squared[i]))
    } else {
        array::from_fn(|i| sine[i].atan2(cosine[i]))
    }
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
    let parabolic = (area * area * (9.0 / 32.0)).powf(1.0 / 3.0);
    let start = parabolic * polynomial(&DEFLECTION_SERIES, parabolic);
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

/// Four coefficients at a time, so that the processor works on several while the sum waits for the last.
#[inline]
fn polynomial(coefficients: &[f64; TERMS], x: f64) -> f64 {
    let (x2, x4) = (x * x, x * x * x * x);
    let four = |c: &[f64; 4]| (c[0] + c[1] * x) + (c[2] + c[3] * x) * x2;
    coefficients
        .as_chunks()
        .0
        .iter()
        .rev()
        .fold(0.0, |sum, chunk| sum * x4 + four(chunk))
}

/// `atan t = t (1 - t²/3 + t⁴/5 - …)`.
const fn arc_tangent_series() -> [f64; TERMS] {
    let mut series = [0.0; TERMS];
    let mut k = 0;
    while k < TERMS {
        let sign = if k % 2 == 0 { 1.0 } else { -1.0 };
        series[k] = sign / (2 * k + 1) as f64;
        k += 1;
    }
    series
}

/// With the parabolic deflection `q` and `d = q u(q)`, the chord's length as derivative of the area reads
/// `(2 u - q u²) (u + q u')² = 2`; comparing powers of `q` gives one coefficient of `u` after the other.
const fn deflection_series() -> [f64; TERMS] {
    let mut u = [0.0; TERMS];
    u[0] = 1.0;
    let mut n = 1;
    while n < TERMS {
        // The coefficient sought enters that of qⁿ with the factor 2 + 4 (n + 1).
        u[n] = -power_of_chord_equation(&u, n) / (2.0 + 4.0 * (n as f64 + 1.0));
        n += 1;
    }
    u
}

/// The coefficient of `qⁿ` in `(2 u - q u²) (u + q u')²`.
const fn power_of_chord_equation(u: &[f64; TERMS], n: usize) -> f64 {
    let mut sum = 0.0;
    let mut i = 0;
    while i <= n {
        let square = if i > 0 { square(u, i - 1, false) } else { 0.0 };
        sum += (2.0 * u[i] - square) * self::square(u, n - i, true);
        i += 1;
    }
    sum
}

/// The coefficient of `qⁿ` in `u²`, or in the square of the derivative of `q u`.
const fn square(u: &[f64; TERMS], n: usize, of_derivative: bool) -> f64 {
    let mut sum = 0.0;
    let mut i = 0;
    while i <= n {
        let weight = if of_derivative { (i + 1) * (n - i + 1) } else { 1 };
        sum += u[i] * u[n - i] * weight as f64;
        i += 1;
    }
    sum
}
