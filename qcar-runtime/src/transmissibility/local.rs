//! Local rational functions on the spectrum of the whole record.
//!
//! Around a frequency f the spectrum of a response is `Y = (b₀ + b₁δ)/(1 + a₁δ) X + t₀/(1 + a₁δ) + noise`, with δ the
//! distance of a line from f. The denominator follows a mode through its resonance, which polynomials over the few
//! lines there cannot; the last term is the leakage of the response that continues after the end of the record, which
//! has the same poles. Multiplied by the denominator this is linear in b₀, b₁, t₀ and a₁, and b₀ is the response at f.

use nalgebra::{Complex, DMatrix, DVector};
use rayon::prelude::*;

use super::line::Line;
use super::regressors::Regressors;

/// Number of unknowns: b₀, b₁, t₀ and a₁.
const UNKNOWNS: usize = 4;

/// Responses of all `spectra` (with lines `spacing` Hz apart) to the first, from at least `least` lines on each side of
/// each frequency, or more if `width` times the frequency contains more.
pub(super) fn lines(
    spectra: &[Vec<Complex<f64>>],
    spacing: f64,
    frequencies: &[f64],
    least: usize,
    width: f64,
) -> Vec<Line> {
    let line = |&frequency: &f64| {
        let half = least.max((width * frequency / spacing) as usize);
        let around = neighbourhood((frequency / spacing).round() as usize, half, spectra[0].len());
        line(spectra, frequency, spacing, around)
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
    let offset = |k: usize| (k as f64 * spacing - frequency) * scale;
    let offsets = DVector::from_iterator(around.len(), around.clone().map(offset));
    let of = |spectrum: &[Complex<f64>]| DVector::from_column_slice(&spectrum[around.clone()]);
    let reference = of(&spectra[0]);
    let sloped = reference.zip_map(&offsets, |line, offset| line * offset);
    let mut regressors = Regressors::new([reference, sloped, offsets.map(|_| Complex::ONE)]);
    let responses = spectra[1..].iter().map(|spectrum| of(spectrum));
    let fits: Vec<_> = responses
        .map(|response| fit(&mut regressors, response, &offsets))
        .collect();
    Line {
        frequency,
        value: std::iter::once(Complex::ONE)
            .chain(fits.iter().map(|fit| fit.value))
            .collect(),
        covariance: covariance(&fits),
        coherence: std::iter::once(1.0)
            .chain(fits.iter().map(|fit| fit.explained))
            .collect(),
    }
}

struct Fit {
    value: Complex<f64>,
    /// `value` is the sum of the response's lines, each times its conjugate weight.
    weights: DVector<Complex<f64>>,
    residual: DVector<Complex<f64>>,
    explained: f64,
}

impl Fit {
    fn covariance(&self, other: &Fit) -> Complex<f64> {
        let freedom = (self.residual.len() - UNKNOWNS) as f64;
        let noise = other.residual.dotc(&self.residual) / Complex::from(freedom);
        noise * self.weights.dotc(&other.weights)
    }
}

/// The covariance of the reference, which has no error, and the values of the fits; Hermitian.
fn covariance(fits: &[Fit]) -> DMatrix<Complex<f64>> {
    let mut covariance = DMatrix::zeros(fits.len() + 1, fits.len() + 1);
    for (i, fit) in fits.iter().enumerate() {
        for (j, other) in fits[..=i].iter().enumerate() {
            let entry = fit.covariance(other);
            covariance[(i + 1, j + 1)] = entry;
            covariance[(j + 1, i + 1)] = entry.conj();
        }
    }
    covariance
}

/// Fits a response by the regressors that it shares with others and its own. If it is flat, b₁ and a₁ are not separable.
fn fit(regressors: &mut Regressors, response: DVector<Complex<f64>>, offsets: &DVector<f64>) -> Fit {
    regressors.push(response.zip_map(offsets, |line, offset| -line * offset));
    let mut weights = regressors.weights();
    let (solution, residual) = regressors.solve(&weights, &response);
    regressors.pop();
    let explained = 1.0 - residual.norm_squared() / response.norm_squared().max(f64::MIN_POSITIVE);
    Fit {
        value: solution[0],
        weights: weights.swap_remove(0),
        residual,
        explained,
    }
}
