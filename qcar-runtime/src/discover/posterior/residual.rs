//! Residuals as real numbers in units of their uncertainty.

use nalgebra::Complex;

use crate::discover::observe::Series;

/// The real residuals of a series: each complex one as its parts, in units of the standard deviation of a part.
pub fn scaled(series: &Series, sigma: &[f64], values: impl Iterator<Item = Complex<f64>>, into: &mut Vec<f64>) {
    let complex = series.kind.complex();
    for (value, sigma) in values.zip(sigma) {
        if complex {
            let scale = std::f64::consts::SQRT_2 / sigma;
            into.extend([value.re * scale, value.im * scale]);
        } else {
            into.push(value.re / sigma);
        }
    }
}

/// A slope by the factors with which a sensor shows it, scaled.
pub fn through(slope: &[Complex<f64>], factors: &[Complex<f64>], scale: f64) -> impl Iterator<Item = Complex<f64>> {
    slope
        .iter()
        .zip(factors)
        .map(move |(slope, factor)| slope * factor * scale)
}
