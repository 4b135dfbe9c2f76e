//! Fourier series and their samples: `a_0 + Σ_n (a_n cos nθ + b_n sin nθ)`, stored as a_0, a_1, b_1, a_2, b_2, ...

use std::collections::BTreeMap;
use std::f64::consts::TAU;
use std::sync::{Arc, Mutex, PoisonError};

use nalgebra::{Complex, DMatrix, DVectorView};

use super::product::product;

/// Transforms of Fourier series up to some harmonic.
pub struct Basis {
    terms: usize,
    /// From coefficients to samples.
    pub synthesis: DMatrix<f64>,
    /// From samples to coefficients.
    pub analysis: DMatrix<f64>,
    /// The same for twice as many harmonics.
    finer: DMatrix<f64>,
}

impl Basis {
    /// Samples per harmonic: enough that kinks of a law do not alias into the lower harmonics.
    const OVERSAMPLING: usize = 10;

    /// The basis for a number of harmonics, which is built once and shared: a search needs it thousands of times.
    pub fn shared(harmonics: usize) -> Arc<Self> {
        static MADE: Mutex<BTreeMap<usize, Arc<Basis>>> = Mutex::new(BTreeMap::new());
        let mut made = MADE.lock().unwrap_or_else(PoisonError::into_inner);
        made.entry(harmonics)
            .or_insert_with(|| Arc::new(Self::new(harmonics)))
            .clone()
    }

    fn new(harmonics: usize) -> Self {
        let (terms, samples) = (2 * harmonics + 1, Self::OVERSAMPLING * harmonics + 2);
        let value = |k: usize, term: usize| {
            let angle = TAU * k as f64 / samples as f64 * term.div_ceil(2) as f64;
            if is_sine(term) { angle.sin() } else { angle.cos() }
        };
        let weight = |term: usize| if term == 0 { 1.0 } else { 2.0 } / samples as f64;
        let analysis = |terms| DMatrix::from_fn(terms, samples, |term, k| weight(term) * value(k, term));
        Self {
            terms,
            synthesis: DMatrix::from_fn(samples, terms, value),
            analysis: analysis(terms),
            finer: analysis(2 * terms - 1),
        }
    }

    /// Number of coefficients of a series.
    pub fn terms(&self) -> usize {
        self.terms
    }

    /// Number of samples of a period.
    pub fn samples(&self) -> usize {
        self.synthesis.nrows()
    }

    /// `exp(jθ)` at a sample.
    pub fn turn(&self, sample: usize) -> Complex<f64> {
        Complex::new(self.synthesis[(sample, 1)], self.synthesis[(sample, 2)])
    }

    /// For `d/dθ` of a series: the coefficient at `term` is the returned factor times the coefficient of the returned
    /// other term; `None` for the constant.
    pub fn derivative(&self, term: usize) -> Option<(usize, f64)> {
        let harmonic = term.div_ceil(2) as f64;
        match term {
            0 => None,
            _ if term.is_multiple_of(2) => Some((term - 1, -harmonic)),
            _ => Some((term + 1, harmonic)),
        }
    }

    /// The matrix from the coefficients of a series to those of its product with weights, which are given by their
    /// samples.
    ///
    /// The product of two harmonics is a harmonic of their sum and one of their difference, so the entries are
    /// coefficients of the weights.
    pub fn weighted(&self, weights: &DVectorView<f64>) -> DMatrix<f64> {
        let weights = product(
            &self.finer,
            &DMatrix::from_column_slice(weights.len(), 1, weights.as_slice()),
        );
        let even = |n: usize| if n == 0 { weights[0] } else { 0.5 * weights[2 * n - 1] };
        let odd = |n: usize| if n == 0 { 0.0 } else { 0.5 * weights[2 * n] };
        let mut matrix = DMatrix::zeros(self.terms, self.terms);
        for (from, to) in (0..=self.terms / 2).flat_map(|from| (0..=self.terms / 2).map(move |to| (from, to))) {
            let (sum, difference) = (to + from, to.abs_diff(from));
            let odd_difference = if to > from { odd(difference) } else { -odd(difference) };
            let pairs = [
                [even(difference) + even(sum), odd(sum) - odd_difference],
                [odd(sum) + odd_difference, even(difference) - even(sum)],
            ];
            // Harmonic 0 is a cosine without a sine, and its coefficient is not doubled.
            let share = if to == 0 { 0.5 } else { 1.0 };
            for (sine_to, sine_from) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
                if sine_to <= to && sine_from <= from {
                    let at = |harmonic: usize, sine: usize| (2 * harmonic + sine).saturating_sub(1);
                    matrix[(at(to, sine_to), at(from, sine_from))] = share * pairs[sine_to][sine_from];
                }
            }
        }
        matrix
    }

    /// Amplitudes of the harmonics from 0, `Re Y_n exp(jnθ)`: a column for each series. `coefficients` are those of all
    /// series, series by series.
    pub fn harmonics(&self, coefficients: &[f64]) -> DMatrix<Complex<f64>> {
        let amplitudes = |series: &[f64], harmonic: usize| match harmonic {
            0 => Complex::from(series[0]),
            _ => Complex::new(series[2 * harmonic - 1], -series[2 * harmonic]),
        };
        let series = |place: usize| &coefficients[place * self.terms..][..self.terms];
        let (rows, columns) = (self.terms / 2 + 1, coefficients.len() / self.terms);
        DMatrix::from_fn(rows, columns, |harmonic, place| amplitudes(series(place), harmonic))
    }
}

fn is_sine(term: usize) -> bool {
    term > 0 && term.is_multiple_of(2)
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::DVector;

    #[test]
    fn a_product_is_that_of_the_samples() {
        let basis = Basis::new(3);
        let weights = DVector::from_fn(basis.samples(), |k, _| ((5 * k) % 7) as f64 - 2.5);
        let by_samples = &basis.analysis * DMatrix::from_diagonal(&weights) * &basis.synthesis;
        let error = basis.weighted(&weights.column(0)) - &by_samples;
        assert!(error.amax() < 1e-12 * by_samples.amax(), "{error}");
    }
}
