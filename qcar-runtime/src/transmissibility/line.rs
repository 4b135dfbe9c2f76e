//! Responses of several points to one reference at one frequency.

use nalgebra::{Complex, DMatrix};

/// The responses of several points to the first of them, at one frequency.
#[derive(Clone, Debug, PartialEq)]
pub struct Line {
    /// Frequency, Hz.
    pub frequency: f64,
    /// Response of each point; that of the first is 1.
    pub value: Vec<Complex<f64>>,
    /// `E[e_i conj(e_j)]` of the errors of the values; zero for the first.
    pub covariance: DMatrix<Complex<f64>>,
    /// Coherence of each point with the first.
    pub coherence: Vec<f64>,
}

impl Line {
    /// The response of point `to` to a motion of point `from`.
    pub fn ratio(&self, to: usize, from: usize) -> Complex<f64> {
        self.value[to] / self.value[from]
    }

    /// The variance of [`Line::ratio`], to first order in the errors.
    pub fn ratio_variance(&self, to: usize, from: usize) -> f64 {
        let ratio = self.ratio(to, from);
        let common = (ratio.conj() * self.covariance[(to, from)]).re;
        let error = self.covariance[(to, to)].re + ratio.norm_sqr() * self.covariance[(from, from)].re - 2.0 * common;
        error.max(0.0) / self.value[from].norm_sqr()
    }

    /// Relates all points but the first to the held signal of the first.
    pub(super) fn release(&mut self, hold: Complex<f64>) {
        self.value[1..].iter_mut().for_each(|value| *value /= hold);
        self.covariance /= Complex::from(hold.norm_sqr());
    }
}
