//! The polynomials through the forces of the past, by which an Adams method goes on.

use std::array;

/// The forces at so many points of the past make the polynomial that extrapolates them.
pub const PAST: usize = 5;

/// Coefficients of the powers of the part of a step that is over.
pub(super) type Polynomial = [f64; PAST + 1];

/// One at a point of the past and zero at all others; they lie at 0, -1, -2, ….
pub(super) const THROUGH: [Polynomial; PAST] = through();
/// What the forces turn out to be more than foreseen: zero at the points of the past and one at the end of the step.
pub(super) const UNFORESEEN: Polynomial = rising(0.0);
/// By how much it would be less if the last point of the past were left out of the polynomial.
pub(super) const LAST_ORDER: Polynomial = rising(-1.0);
/// How the polynomial through the past goes on for a step: binomial coefficients with alternating signs.
pub(super) const EXTRAPOLATION: [f64; PAST] = [5.0, -10.0, 10.0, -5.0, 1.0];

/// The derivatives of a polynomial where a step begins, by a time of which the step has `1 / unit`.
pub(super) fn derivatives(polynomial: &Polynomial, unit: f64) -> Polynomial {
    let mut factor = 1.0;
    array::from_fn(|power| {
        if power > 0 {
            factor *= power as f64 * unit;
        }
        polynomial[power] * factor
    })
}

const fn through() -> [Polynomial; PAST] {
    let mut all = [[0.0; PAST + 1]; PAST];
    let mut point = 0;
    while point < PAST {
        all[point][0] = 1.0;
        let mut other = 0;
        while other < PAST {
            if other != point {
                all[point] = times(&all[point], other as f64, other as f64 - point as f64);
            }
            other += 1;
        }
        point += 1;
    }
    all
}

/// `(s + first) (s + first + 1) … / PAST!` of as many factors.
const fn rising(first: f64) -> Polynomial {
    let mut product = [0.0; PAST + 1];
    product[0] = 1.0;
    let mut i = 0;
    while i < PAST {
        product = times(&product, first + i as f64, (i + 1) as f64);
        i += 1;
    }
    product
}

/// A polynomial times `(s + root) / over`.
const fn times(polynomial: &Polynomial, root: f64, over: f64) -> Polynomial {
    let mut product = [0.0; PAST + 1];
    let mut i = 0;
    while i <= PAST {
        let shifted = if i == 0 { 0.0 } else { polynomial[i - 1] };
        product[i] = (shifted + root * polynomial[i]) / over;
        i += 1;
    }
    product
}
