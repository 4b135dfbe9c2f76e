//! Weighted least-squares line through a few complex values, evaluated at its centre.

use nalgebra::Complex;

/// Sums of the least-squares problem.
#[derive(Default)]
pub struct Straight {
    /// Sums of `|d|² t^n / σ²`.
    weight: [f64; 3],
    /// Sums of `conj(d) r t^n / σ²`.
    moment: [Complex<f64>; 2],
}

impl Straight {
    /// Adds `r ≈ (a + b t) d` with standard deviation `sigma`.
    pub fn add(&mut self, t: f64, direction: Complex<f64>, residual: Complex<f64>, sigma: f64) {
        let scale = 1.0 / (sigma * sigma);
        let (weight, moment) = (direction.norm_sqr() * scale, direction.conj() * residual * scale);
        (0..3).for_each(|n| self.weight[n] += weight * t.powi(n as i32));
        (0..2).for_each(|n| self.moment[n] += moment * t.powi(n as i32));
    }

    /// `a` and its standard deviation; zero and infinity without data.
    pub fn solve(&self) -> (Complex<f64>, f64) {
        // Below this relative determinant, all positions are equal up to rounding errors.
        const SINGULAR: f64 = 1e-12;
        let [w0, w1, w2] = self.weight;
        let determinant = w0 * w2 - w1 * w1;
        if determinant > SINGULAR * w0 * w2 {
            let value = (self.moment[0] * w2 - self.moment[1] * w1) / determinant;
            (value, (w2 / determinant).sqrt())
        } else if w0 > 0.0 {
            (self.moment[0] / w0, w0.sqrt().recip())
        } else {
            (Complex::ZERO, f64::INFINITY)
        }
    }
}
