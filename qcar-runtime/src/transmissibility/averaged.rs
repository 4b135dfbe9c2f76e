//! H1 from segment averages, with the variance of Bendat and Piersol ("Random Data", 4th ed., section 9.2.3).

use nalgebra::{Complex, DMatrix};

use super::line::Line;
use crate::spectrum::{Segments, welch};

/// The responses of all `signals` to the first, at the lines of the segments between the first and last frequency.
pub(super) fn lines(signals: &[Vec<f64>], rate: f64, frequencies: &[f64], segments: &Segments) -> Vec<Line> {
    let signals: Vec<&[f64]> = signals.iter().map(Vec::as_slice).collect();
    let spectra = welch(&signals, rate, segments);
    let (first, last) = (frequencies[0], frequencies[frequencies.len() - 1]);
    let lines = spectra.frequency.iter().zip(&spectra.density);
    lines
        .filter(|(f, _)| (first..=last).contains(*f))
        .map(|(f, density)| line(*f, density, spectra.averages))
        .collect()
}

fn line(frequency: f64, density: &DMatrix<Complex<f64>>, averages: f64) -> Line {
    let reference = density[(0, 0)];
    let value: Vec<_> = (0..density.nrows()).map(|i| density[(i, 0)] / reference).collect();
    let unexplained = |i: usize, j: usize| density[(i, j)] - density[(i, 0)] * density[(0, j)] / reference;
    let freedom = Complex::from(reference.re * (averages - 1.0).max(f64::MIN_POSITIVE));
    Line {
        frequency,
        covariance: DMatrix::from_fn(value.len(), value.len(), |i, j| unexplained(i, j) / freedom),
        coherence: (0..value.len())
            .map(|i| density[(i, 0)].norm_sqr() / (reference.re * density[(i, i)].re))
            .collect(),
        value,
    }
}
