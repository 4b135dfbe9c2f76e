//! What a driver feels: the frequency weightings of ISO 2631-1, the weighted root mean square and the vibration dose.

use std::f64::consts::{FRAC_1_SQRT_2, TAU};

/// A frequency weighting of ISO 2631-1, annex A.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Weighting {
    /// Vertical, on a seat.
    Wk,
    /// Horizontal, on a seat.
    Wd,
}

/// Root mean square of a record.
pub fn rms(record: &[f64]) -> f64 {
    (record.iter().map(|a| a * a).sum::<f64>() / record.len().max(1) as f64).sqrt()
}

/// Vibration dose value `(∫ a⁴ dt)^(1/4)` of a weighted acceleration (m/s²) at `sample_rate` (Hz), m/s^1.75.
pub fn vibration_dose(weighted: &[f64], sample_rate: f64) -> f64 {
    (weighted.iter().map(|a| a.powi(4)).sum::<f64>() / sample_rate).powf(0.25)
}

impl Weighting {
    /// The weighted record: the transfer functions of the standard as digital filters, by the bilinear transform with
    /// the frequency of each term kept. Starts at rest.
    pub fn apply(self, record: &[f64], sample_rate: f64) -> Vec<f64> {
        let mut weighted = record.to_vec();
        for section in self.sections(sample_rate) {
            section.filter(&mut weighted, sample_rate);
        }
        weighted
    }

    /// Band limits, transition from acceleration to velocity and, for Wk, the upward step (table A.1).
    fn sections(self, sample_rate: f64) -> Vec<Section> {
        let warped = |frequency: f64| 2.0 * sample_rate * (TAU * frequency / (2.0 * sample_rate)).tan();
        let pole = |frequency: f64, quality: f64| {
            let omega = warped(frequency);
            [1.0, 1.0 / (quality * omega), 1.0 / (omega * omega)]
        };
        let high_pass = pole(0.4, FRAC_1_SQRT_2);
        let transition = |frequency: f64, quality: f64| Section {
            above: [1.0, 1.0 / warped(frequency), 0.0],
            below: pole(frequency, quality),
        };
        let mut sections = vec![
            Section {
                above: [0.0, 0.0, high_pass[2]],
                below: high_pass,
            },
            Section {
                above: [1.0, 0.0, 0.0],
                below: pole(100.0, FRAC_1_SQRT_2),
            },
        ];
        match self {
            Self::Wk => {
                let share = (warped(2.37) / warped(3.35)).powi(2);
                sections.push(transition(12.5, 0.63));
                sections.push(Section {
                    above: pole(2.37, 0.91).map(|c| c * share),
                    below: pole(3.35, 0.91),
                });
            }
            Self::Wd => sections.push(transition(2.0, 0.63)),
        }
        sections
    }
}

/// A ratio of two polynomials in s of second degree, lowest power first.
struct Section {
    above: [f64; 3],
    below: [f64; 3],
}

impl Section {
    fn filter(&self, record: &mut [f64], sample_rate: f64) {
        let (b, a) = (bilinear(&self.above, sample_rate), bilinear(&self.below, sample_rate));
        let (mut first, mut second) = (0.0, 0.0);
        for sample in record {
            let input = *sample;
            let output = (b[0] * input + first) / a[0];
            first = b[1] * input - a[1] * output + second;
            second = b[2] * input - a[2] * output;
            *sample = output;
        }
    }
}

/// The polynomial in 1/z for `s = 2 f (z - 1)/(z + 1)`, times `(z + 1)²/z²`.
fn bilinear(c: &[f64; 3], sample_rate: f64) -> [f64; 3] {
    let k = 2.0 * sample_rate;
    let (constant, linear, square) = (c[0], c[1] * k, c[2] * k * k);
    [
        constant + linear + square,
        2.0 * (constant - square),
        constant - linear + square,
    ]
}
