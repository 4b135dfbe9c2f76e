//! Fourier series by their samples: `a_0 + Σ_n (a_n cos nθ + b_n sin nθ)`, kept as a_0, a_1, b_1, a_2, b_2, ...

use std::f64::consts::TAU;

use nalgebra::{Complex, DMatrix};

/// Fourier series up to some harmonic.
pub struct Basis {
    terms: usize,
    /// From coefficients to samples.
    pub synthesis: DMatrix<f64>,
    /// From samples to coefficients.
    pub analysis: DMatrix<f64>,
}

impl Basis {
    /// Samples enough that kinks of a law do not alias into the lower harmonics.
    const OVERSAMPLING: usize = 10;

    pub fn new(harmonics: usize) -> Self {
        let (terms, samples) = (2 * harmonics + 1, Self::OVERSAMPLING * harmonics + 2);
        let value = |k: usize, term: usize| {
            let angle = TAU * k as f64 / samples as f64 * term.div_ceil(2) as f64;
            if term.is_multiple_of(2) && term > 0 {
                angle.sin()
            } else {
                angle.cos()
            }
        };
        let weight = |term: usize| if term == 0 { 1.0 } else { 2.0 } / samples as f64;
        Self {
            terms,
            synthesis: DMatrix::from_fn(samples, terms, value),
            analysis: DMatrix::from_fn(terms, samples, |term, k| weight(term) * value(k, term)),
        }
    }

    /// Coefficients of a series.
    pub fn terms(&self) -> usize {
        self.terms
    }

    /// Samples of a period.
    pub fn samples(&self) -> usize {
        self.synthesis.nrows()
    }

    /// The angle of a sample, rad.
    pub fn angle(&self, sample: usize) -> f64 {
        TAU * sample as f64 / self.samples() as f64
    }

    /// `d/dθ` of a series has at `term` this factor times the coefficient of this other term; `None` for the constant.
    pub fn derivative(&self, term: usize) -> Option<(usize, f64)> {
        let harmonic = term.div_ceil(2) as f64;
        match term {
            0 => None,
            _ if term.is_multiple_of(2) => Some((term - 1, -harmonic)),
            _ => Some((term + 1, harmonic)),
        }
    }

    /// Amplitudes of the harmonics from 0: `Re Y_n exp(jnθ)`.
    pub fn harmonics(&self, coefficients: &[f64]) -> Vec<Complex<f64>> {
        let constant = Complex::from(coefficients[0]);
        let others = coefficients[1..].chunks(2).map(|pair| Complex::new(pair[0], -pair[1]));
        std::iter::once(constant).chain(others).collect()
    }
}
