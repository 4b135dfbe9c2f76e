//! Observations of a fit: measured ratios over frequency, run by run.

use crate::campaign::Role;
use crate::model::Channel;
use nalgebra::Complex;

/// The ratios measured in one run, all under one excitation.
#[derive(Clone, Debug)]
pub struct Level {
    /// The file of the run.
    pub name: String,
    /// What it may be used for.
    pub role: Role,
    /// Place in the model's excitations.
    pub excitation: usize,
    /// The ratios.
    pub observations: Vec<Observation>,
}

/// A measured ratio of two signals.
#[derive(Clone, Debug)]
pub struct Observation {
    /// Which ratio.
    pub channel: Channel,
    /// True where it enters the cost (if its run does), false where it is only compared.
    pub fitted: bool,
    /// Hz, ascending.
    pub frequency: Vec<f64>,
    /// A value for each line.
    pub value: Vec<Complex<f64>>,
    /// `E|δT|² / |T|²` for each line, by random noise.
    pub relative_variance: Vec<f64>,
    /// Share of the power that the reference explains, for each line.
    pub coherence: Vec<f64>,
    /// Where the excitation reached, Hz.
    pub band: (f64, f64),
    /// How many sensors the numerator and the denominator are means of.
    pub sensors: (usize, usize),
    /// What the sensors of a pair say apart from each other.
    pub differences: Vec<Difference>,
}

impl Observation {
    /// How far the logarithm of each value may be off, to either side: two standard deviations of the noise, and half
    /// of what the sides of the vehicle differ by. The real part is of the magnitude (neper), the imaginary one of the
    /// phase (rad).
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

/// Half the logarithm of the ratio of what two symmetric sensors give, `½ ln (T_first / T_second)`.
#[derive(Clone, Debug)]
pub struct Difference {
    /// Which pair: differences of one pair belong together across channels.
    pub pair: Pair,
    /// A value for each line.
    pub half: Vec<Complex<f64>>,
}

/// Two symmetric places.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[expect(missing_docs, reason = "each says it")]
pub enum Pair {
    LeftRight,
    FrontRear,
}
