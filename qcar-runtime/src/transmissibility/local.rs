//! Local rational functions on the spectrum of the whole record.
//!
//! Around a frequency f the spectrum of a response is `Y = (b₀ + b₁δ)/(1 + a₁δ) X + t₀/(1 + a₁δ) + noise`, with δ the
//! distance of a line from f. The denominator follows a mode through its resonance, which polynomials over the few
//! lines there cannot; the last term is the leakage of the response that continues after the end of the record, which
//! has the same poles. Multiplied by the denominator this is linear in b₀, b₁, t₀ and a₁, and b₀ is the response at f.

use nalgebra::linalg::SVD;
use nalgebra::{Complex, DMatrix, DVector};
use rayon::prelude::*;

use super::line::Line;
use crate::spectrum::transform;

/// Number of unknowns: b₀, b₁, t₀ and a₁.
const UNKNOWNS: usize = 4;

/// Responses of all `signals` to the first, from at least `least` lines on each side of each frequency, or more if
/// `width` times the frequency contains more.
pub(super) fn lines(signals: &[Vec<f64>], rate: f64, frequencies: &[f64], least: usize, width: f64) -> Vec<Line> {
    let spacing = rate / signals[0].len() as f64;
    let spectra: Vec<_> = signals.par_iter().map(|signal| transform(signal)).collect();
    let line = |&frequency: &f64| {
        let half = least.max((width * frequency / spacing) as usize);
        let around = neighbourhood((frequency / spacing).round() as usize, half, spectra[0].len());
        line(&spectra, frequency, spacing, around)
    };
    frequencies.par_iter().map(line).collect()
}

/// `2 half + 1` lines around `centre`, shifted if they would contain line 0, the offset, or leave the spectrum.
pub(super) fn neighbourhood(centre: usize, half: usize, count: usize) -> std::ops::Range<usize> {
    let length = (2 * half + 1).min(count - 1);
    let first = centre.saturating_sub(half).clamp(1, count - length);
    first..first + length
}

fn line(spectra: &[Vec<Complex<f64>>], frequency: f64, spacing: f64, around: std::ops::Range<usize>) -> Line {
    let scale = 2.0 / (around.len() as f64 * spacing);
    let offsets: Vec<f64> = around
        .clone()
        .map(|k| (k as f64 * spacing - frequency) * scale)
        .collect();
    let reference = &spectra[0][around.clone()];
    let fits: Vec<_> = spectra[1..]
        .iter()
        .map(|response| fit(reference, &response[around.clone()], &offsets))
        .collect();
    let covariance = |i: usize, j: usize| match (i, j) {
        (0, _) | (_, 0) => Complex::ZERO,
        _ => fits[i - 1].covariance(&fits[j - 1]),
    };
    Line {
        frequency,
        value: std::iter::once(Complex::ONE)
            .chain(fits.iter().map(|fit| fit.value))
            .collect(),
        covariance: DMatrix::from_fn(spectra.len(), spectra.len(), covariance),
        coherence: std::iter::once(1.0)
            .chain(fits.iter().map(|fit| fit.explained))
            .collect(),
    }
}

struct Fit {
    value: Complex<f64>,
    /// `value` is the sum of the response's lines, each times its weight.
    weights: DVector<Complex<f64>>,
    residual: DVector<Complex<f64>>,
    explained: f64,
}

impl Fit {
    fn covariance(&self, other: &Fit) -> Complex<f64> {
        let freedom = (self.residual.len() - UNKNOWNS) as f64;
        let noise = other.residual.dotc(&self.residual) / Complex::from(freedom);
        noise * other.weights.dotc(&self.weights)
    }
}

fn fit(reference: &[Complex<f64>], response: &[Complex<f64>], offsets: &[f64]) -> Fit {
    let regressors = DMatrix::from_fn(offsets.len(), UNKNOWNS, |k, unknown| match unknown {
        0 => reference[k],
        1 => reference[k] * offsets[k],
        2 => Complex::ONE,
        _ => -response[k] * offsets[k],
    });
    let response = DVector::from_column_slice(response);
    let inverse = pseudo_inverse(&regressors);
    let solution = &inverse * &response;
    let residual = &response - &regressors * &solution;
    let weights = inverse.row(0).transpose();
    let explained = 1.0 - residual.norm_squared() / response.norm_squared().max(f64::MIN_POSITIVE);
    Fit {
        value: solution[0],
        weights,
        residual,
        explained,
    }
}

/// Uses columns of unit length. If the response is flat, b₁ and a₁ are not separable and share the part that they
/// explain.
///
/// NaN if the regressors are not finite, as in a diverged simulation: the decomposition of such a matrix would not end.
pub(super) fn pseudo_inverse(regressors: &DMatrix<Complex<f64>>) -> DMatrix<Complex<f64>> {
    const SAME: f64 = 1e-10;
    const MOST_ITERATIONS: usize = 10_000;
    let norm = |column: usize| regressors.column(column).norm().max(f64::MIN_POSITIVE);
    let norms: Vec<f64> = (0..regressors.ncols()).map(norm).collect();
    let mut unit = regressors.clone();
    unit.column_iter_mut()
        .zip(&norms)
        .for_each(|(mut column, norm)| column.unscale_mut(*norm));
    let finite = unit.iter().all(|entry| entry.is_finite());
    let inverse = finite.then(|| {
        // Far fewer rows are left to the iterations of the singular values.
        let (q, r) = unit.qr().unpack();
        let parts = SVD::try_new_unordered(r, true, true, 5.0 * f64::EPSILON, MOST_ITERATIONS)?;
        parts.pseudo_inverse(SAME).ok().map(|inverse| inverse * q.adjoint())
    });
    let inverse = inverse.flatten();
    let nothing = || DMatrix::from_element(regressors.ncols(), regressors.nrows(), Complex::from(f64::NAN));
    let mut inverse = inverse.unwrap_or_else(nothing);
    inverse
        .row_iter_mut()
        .zip(&norms)
        .for_each(|(mut row, norm)| row.unscale_mut(*norm));
    inverse
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_not_a_number_has_no_inverse_and_the_search_for_it_ends() {
        for wrong in [f64::NAN, f64::INFINITY] {
            let entry = |row: usize, column: usize| Complex::from(if row == column { wrong } else { 1.0 });
            let inverse = pseudo_inverse(&DMatrix::from_fn(6, 3, entry));
            assert!(inverse.iter().all(|entry| entry.re.is_nan()));
        }
    }
}
