//! Normalised residuals as real numbers.

use nalgebra::Complex;

use crate::discover::observe::Series;

/// Appends the real residuals of a series in units of their standard deviation. A complex value gives two, each with
/// half its variance.
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

/// A derivative multiplied by the sensor factors and a scale.
pub fn through(slope: &[Complex<f64>], factors: &[Complex<f64>], scale: f64) -> impl Iterator<Item = Complex<f64>> {
    slope
        .iter()
        .zip(factors)
        .map(move |(slope, factor)| slope * factor * scale)
}
