//! Observations of a fit: measured ratios over frequency, run by run.

use crate::campaign::Role;
use crate::model::{About, Channel};
use crate::response::signal::output_of;
use nalgebra::Complex;
use std::collections::BTreeSet;

/// The ratios measured in one run, all under one excitation.
#[derive(Clone, Debug)]
pub struct Level {
    /// File of the run.
    pub name: String,
    /// Role of the run.
    pub role: Role,
    /// Position of the excitation in the model.
    pub excitation: usize,
    /// The ratios.
    pub observations: Vec<Observation>,
}

/// A measured ratio of two signals.
#[derive(Clone, Debug)]
pub struct Observation {
    /// The channel.
    pub channel: Channel,
    /// True if it enters the cost of a fitted run; false if it is only compared.
    pub fitted: bool,
    /// Frequencies, Hz, ascending.
    pub frequency: Vec<f64>,
    /// Value at each line.
    pub value: Vec<Complex<f64>>,
    /// Relative variance `E|δT|² / |T|²` of each line by random noise.
    pub relative_variance: Vec<f64>,
    /// Coherence of each line: share of the power that the reference explains.
    pub coherence: Vec<f64>,
    /// Band of the excitation, Hz.
    pub band: (f64, f64),
    /// Number of sensors in the mean of the numerator and of the denominator.
    pub sensors: (usize, usize),
    /// Differences between the sensors of each pair.
    pub differences: Vec<Difference>,
}

/// Positions of the outputs from which the observed signals follow; an excitation may be none of them.
pub fn outputs(about: &About, levels: &[Level]) -> Vec<u16> {
    let observed = levels.iter().flat_map(|level| &level.observations);
    let signals = observed.flat_map(|own| [&own.channel.numerator, &own.channel.denominator]);
    let places = signals.filter_map(|signal| Some(output_of(about, signal).ok()?.0 as u16));
    places.collect::<BTreeSet<u16>>().into_iter().collect()
}

impl Observation {
    /// Uncertainty of the logarithm of each value: two standard deviations of the noise, and half the difference of the
    /// sides of the vehicle. The real part is that of the magnitude (Np), the imaginary part that of the phase (rad).
    pub fn spread(&self) -> Vec<Complex<f64>> {
        let spread = |(line, variance): (usize, &f64)| {
            let noise = 2.0 * variance;
            let squares = self.differences.iter().map(|difference| difference.half[line]);
            let (re, im) = squares.fold((noise, noise), |(re, im), half| {
                (re + half.re * half.re, im + half.im * half.im)
            });
            Complex::new(re.sqrt(), im.sqrt())
        };
        self.relative_variance.iter().enumerate().map(spread).collect()
    }
}

/// Half the logarithm of the ratio of two symmetric sensors, `½ ln (T_first / T_second)`.
#[derive(Clone, Debug)]
pub struct Difference {
    /// The pair. Differences of one pair belong together across channels.
    pub pair: Pair,
    /// Value at each line.
    pub half: Vec<Complex<f64>>,
}

/// Two symmetric places.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[expect(missing_docs, reason = "each says it")]
pub enum Pair {
    LeftRight,
    FrontRear,
}
