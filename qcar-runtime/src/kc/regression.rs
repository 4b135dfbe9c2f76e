//! Linear least squares in three unknowns with robust weights and standard errors.

use super::KcError;
use nalgebra::{Matrix3, Vector3};

/// A value and its standard error (one standard deviation), in one unit.
///
/// The standard error is that of the scatter alone. [`Estimate::uncertainty`] includes the scale error of a rig, which
/// is the same in all samples.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct Estimate {
    /// Best estimate.
    pub value: f64,
    /// Standard error from the scatter of the samples, increased for correlated neighbours.
    pub standard_error: f64,
}

impl Estimate {
    /// Standard uncertainty from the scatter and from the scale of force over displacement, known to 0.5 %.
    pub fn uncertainty(&self) -> f64 {
        self.standard_error.hypot(SCALE_UNCERTAINTY * self.value)
    }
}

/// Relative standard uncertainty of a rig's scale factors.
const SCALE_UNCERTAINTY: f64 = 0.005;
/// Residuals beyond this number of standard deviations have less weight (Huber 1964: 95 % efficient for normal
/// scatter).
const TUNING: f64 = 1.345;
/// Ratio of the standard deviation of a normal distribution to the median of its absolute values.
const DEVIATION_PER_MEDIAN: f64 = 1.4826;
const ITERATIONS: usize = 30;
const FEWEST: usize = 20;

/// Solves `row[3] = row[0] a + row[1] b + row[2] c` for all rows.
pub(super) fn huber(rows: &[[f64; 4]]) -> Result<[Estimate; 3], KcError> {
    if rows.len() < FEWEST {
        return Err(KcError::TooFew {
            found: rows.len(),
            expected: FEWEST,
        });
    }
    let mut weights = vec![1.0; rows.len()];
    let (mut solution, mut inverse) = solve(rows, &weights)?;
    for _ in 0..ITERATIONS {
        let residuals = residuals(rows, &solution);
        let limit = TUNING * DEVIATION_PER_MEDIAN * median_size(&residuals);
        weights = residuals
            .iter()
            .map(|r| if r.abs() > limit { limit / r.abs() } else { 1.0 })
            .collect();
        (solution, inverse) = solve(rows, &weights)?;
    }
    let residuals = residuals(rows, &solution);
    let variance = variance(&residuals, &weights);
    let error = |i: usize| (variance * inverse[(i, i)]).sqrt();
    Ok(std::array::from_fn(|i| Estimate {
        value: solution[i],
        standard_error: error(i),
    }))
}

/// The weighted solution, and the inverse of the normal matrix.
fn solve(rows: &[[f64; 4]], weights: &[f64]) -> Result<(Vector3<f64>, Matrix3<f64>), KcError> {
    let scale = column_sizes(rows);
    let (mut normal, mut right) = (Matrix3::zeros(), Vector3::zeros());
    for (row, &weight) in rows.iter().zip(weights) {
        let scaled = Vector3::new(row[0], row[1], row[2]).component_div(&scale);
        normal += weight * scaled * scaled.transpose();
        right += weight * row[3] * scaled;
    }
    // A column of zeros, or two proportional columns, make the matrix singular.
    let factor = normal.cholesky().ok_or(KcError::OneWay)?;
    let inverse = factor.inverse().component_div(&(scale * scale.transpose()));
    if inverse.iter().any(|value| !value.is_finite()) {
        return Err(KcError::OneWay);
    }
    Ok((factor.solve(&right).component_div(&scale), inverse))
}

fn column_sizes(rows: &[[f64; 4]]) -> Vector3<f64> {
    Vector3::from_fn(|column, _| rows.iter().map(|row| row[column] * row[column]).sum::<f64>().sqrt())
}

fn residuals(rows: &[[f64; 4]], solution: &Vector3<f64>) -> Vec<f64> {
    rows.iter()
        .map(|row| row[3] - Vector3::new(row[0], row[1], row[2]).dot(solution))
        .collect()
}

fn median_size(residuals: &[f64]) -> f64 {
    let mut sizes: Vec<f64> = residuals.iter().map(|r| r.abs()).collect();
    sizes.sort_by(f64::total_cmp);
    sizes[sizes.len() / 2]
}

/// Variance of the scatter for a mean: neighbours with a correlation ρ carry less independent information, by `(1 -
/// ρ)/(1 + ρ)`.
fn variance(residuals: &[f64], weights: &[f64]) -> f64 {
    let sum: f64 = residuals.iter().zip(weights).map(|(r, w)| w * r * r).sum();
    let squares: f64 = residuals.iter().map(|r| r * r).sum();
    let products: f64 = residuals.windows(2).map(|w| w[0] * w[1]).sum();
    let correlation = if squares > 0.0 {
        (products / squares).clamp(0.0, 0.99)
    } else {
        0.0
    };
    sum / (residuals.len() - 3) as f64 * (1.0 + correlation) / (1.0 - correlation)
}
