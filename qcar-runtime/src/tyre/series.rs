//! Power series of the circle's closed forms; they keep their digits for the shortest arcs.
//!
//! The variable of an arc is `y = sin² θ/2 = (1 - cos θ)/2`, which needs neither roots nor quotients; these are slow.

/// Terms of each series; the first one left out is below 1e-13 where they are used.
const TERMS: usize = 12;

/// Coefficients of powers from zero on.
pub(super) type Series = [f64; TERMS];

/// `θ / sin θ` by y.
pub(super) const ANGLE: Series = angle();
/// `u` with the deflection `q u(q)` that has the area of the parabolic deflection `q`.
pub(super) const DEFLECTION: Series = deflection();
/// First entry of the unit vector along `[θ - sin θ cos θ, sin² θ]`, over `sin θ`, by y.
pub(super) const FORWARD: Series = product(&TILT, &DOWN);
/// Its second entry, by y.
pub(super) const DOWN: Series = inverse_root(&one_and_squared_tilt());

/// Ratio of the two entries of that vector, over `sin θ`.
const TILT: Series = tilt();

/// The value of a series at `x`.
///
/// Uses four independent sums, which the processor computes in parallel.
#[inline(always)]
pub(super) fn value(series: &Series, x: f64) -> f64 {
    let (x2, x4) = (x * x, x * x * x * x);
    let four = |c: &[f64]| (c[0] + c[1] * x) + (c[2] + c[3] * x) * x2;
    (four(&series[..4]) + four(&series[4..8]) * x4) + four(&series[8..]) * (x4 * x4)
}

/// `1 + 2/3 y + 2/3 4/5 y² + …`.
const fn angle() -> Series {
    let mut series = [1.0; TERMS];
    let mut k = 1;
    while k < TERMS {
        series[k] = series[k - 1] * (2 * k) as f64 / (2 * k + 1) as f64;
        k += 1;
    }
    series
}

/// `(θ / sin θ - cos θ) / (4 y (1 - y))`: sums of the coefficients of the angle.
const fn tilt() -> Series {
    let mut series = [0.0; TERMS];
    let (mut coefficient, mut sum) = (1.0, 2.0);
    let mut k = 0;
    while k < TERMS {
        coefficient *= (2 * k + 2) as f64 / (2 * k + 3) as f64;
        sum += coefficient;
        series[k] = sum / 4.0;
        k += 1;
    }
    series
}

/// `1 + sin² θ tilt²`, where `sin² θ = 4 y (1 - y)`.
const fn one_and_squared_tilt() -> Series {
    let square = product(&TILT, &TILT);
    let mut series = [1.0; TERMS];
    let mut k = 1;
    while k < TERMS {
        series[k] = 4.0 * (square[k - 1] - if k > 1 { square[k - 2] } else { 0.0 });
        k += 1;
    }
    series
}

const fn product(a: &Series, b: &Series) -> Series {
    let mut series = [0.0; TERMS];
    let mut n = 0;
    while n < TERMS {
        let mut i = 0;
        while i <= n {
            series[n] += a[i] * b[n - i];
            i += 1;
        }
        n += 1;
    }
    series
}

/// `r = 1/√q` for a series that begins with one: `2 q r' = -q' r`, by powers.
const fn inverse_root(q: &Series) -> Series {
    let mut series = [1.0; TERMS];
    let mut n = 1;
    while n < TERMS {
        let mut sum = 0.0;
        let mut k = 1;
        while k <= n {
            sum -= (n as f64 - 0.5 * k as f64) * q[k] * series[n - k];
            k += 1;
        }
        series[n] = sum / n as f64;
        n += 1;
    }
    series
}

/// With the parabolic deflection `q` and `d = q u(q)`, the chord's length as derivative of the area reads
/// `(2 u - q u²) (u + q u')² = 2`; comparing powers of `q` gives one coefficient of `u` after the other.
const fn deflection() -> Series {
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
const fn power_of_chord_equation(u: &Series, n: usize) -> f64 {
    let mut slope = *u;
    let mut k = 0;
    while k < TERMS {
        slope[k] *= (k + 1) as f64;
        k += 1;
    }
    let (square, squared_slope) = (product(u, u), product(&slope, &slope));
    let mut sum = 0.0;
    let mut i = 0;
    while i <= n {
        let chord = 2.0 * u[i] - if i > 0 { square[i - 1] } else { 0.0 };
        sum += chord * squared_slope[n - i];
        i += 1;
    }
    sum
}
