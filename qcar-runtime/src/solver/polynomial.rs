//! The polynomials through past forces of an Adams method.

use std::array;

/// Number of past values that determine the extrapolating polynomial.
pub const PAST: usize = 5;

/// Coefficients of the powers of the elapsed fraction of a step.
pub(super) type Polynomial = [f64; PAST + 1];

/// Polynomials that are one at one past point and zero at all others; the points are 0, -1, -2, ….
pub(super) const THROUGH: [Polynomial; PAST] = through();
/// Shape of the error of a prediction: zero at the past points and one at the end of the step.
pub(super) const PREDICTION_ERROR: Polynomial = rising(0.0);
/// Its reduction if the polynomial did not use the last past point.
pub(super) const LAST_ORDER: Polynomial = rising(-1.0);
/// Coefficients of the past values in the extrapolation by one step: binomial coefficients with alternating signs.
pub(super) const EXTRAPOLATION: [f64; PAST] = [5.0, -10.0, 10.0, -5.0, 1.0];

/// The derivatives of a polynomial at the beginning of a step, by time in units of `unit` steps.
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
