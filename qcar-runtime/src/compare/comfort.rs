//! Vibration comfort: the frequency weightings of ISO 2631-1, the weighted root mean square and the vibration dose.

use std::f64::consts::{FRAC_1_SQRT_2, TAU};

use crate::model::{LANES, Lanes};
use crate::vectors::{Loops, widest};

/// A frequency weighting of ISO 2631-1, annex A.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Weighting {
    /// Vertical, on a seat.
    Wk,
    /// Horizontal, on a seat.
    Wd,
}

/// Vibration dose value `(∫ a⁴ dt)^(1/4)` of a weighted acceleration (m/s²) at `sample_rate` (Hz), m/s^1.75.
pub fn vibration_dose(weighted: &[f64], sample_rate: f64) -> f64 {
    (weighted.iter().map(|a| a.powi(4)).sum::<f64>() / sample_rate).powf(0.25)
}

impl Weighting {
    /// The weighted record: the transfer functions of the standard as digital filters, by the bilinear transform with
    /// the frequency of each term kept. Starts at rest.
    pub fn apply(self, record: &[f64], sample_rate: f64) -> Vec<f64> {
        let mut weighted = vec![0.0; record.len()];
        let keep = |sample: usize, out: &Lanes| weighted[sample] = out[0];
        self.filter(&[record], sample_rate, keep);
        weighted
    }

    /// Vibration dose value of each weighted record, as by [`vibration_dose`]; all have one length and are weighted
    /// together.
    pub fn doses(self, records: &[&[f64]], sample_rate: f64) -> Vec<f64> {
        let mut doses = Vec::with_capacity(records.len());
        for together in records.chunks(LANES) {
            let mut sum = [0.0; LANES];
            let add = |_, out: &Lanes| sum.iter_mut().zip(out).for_each(|(sum, a)| *sum += (a * a) * (a * a));
            self.filter(together, sample_rate, add);
            doses.extend(sum[..together.len()].iter().map(|sum| (sum / sample_rate).powf(0.25)));
        }
        doses
    }

    /// Calls a function with each filtered sample.
    fn filter(self, records: &[&[f64]], sample_rate: f64, each: impl FnMut(usize, &Lanes)) {
        let sections = self.sections(sample_rate);
        let digital = sections.iter().map(|section| section.digital(sample_rate));
        let mut cascade = [Digital::default(); SECTIONS];
        cascade.iter_mut().zip(digital).for_each(|(to, own)| *to = own);
        widest(Cascade {
            records,
            sections: &cascade,
            each,
        });
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
    fn digital(&self, sample_rate: f64) -> Digital {
        let (b, a) = (bilinear(&self.above, sample_rate), bilinear(&self.below, sample_rate));
        Digital {
            above: b.map(|b| b / a[0]),
            below: [a[1] / a[0], a[2] / a[0]],
        }
    }
}

/// A ratio of two polynomials in 1/z; that below begins with 1.
#[derive(Clone, Copy)]
struct Digital {
    above: [f64; 3],
    below: [f64; 2],
}

impl Default for Digital {
    /// Passes a signal unchanged.
    fn default() -> Self {
        Digital {
            above: [1.0, 0.0, 0.0],
            below: [0.0; 2],
        }
    }
}

/// Number of sections of Wk.
const SECTIONS: usize = 4;

/// Filters several records by sections in series, sample by sample, so that no section waits for the end of the
/// previous one.
struct Cascade<'a, T> {
    records: &'a [&'a [f64]],
    sections: &'a [Digital; SECTIONS],
    each: T,
}

impl<T: FnMut(usize, &Lanes)> Loops for Cascade<'_, T> {
    type Result = ();

    #[inline(always)]
    fn run(mut self) {
        let mut waiting = [[[0.0; LANES]; 2]; SECTIONS];
        for sample in 0..self.records.first().map_or(0, |record| record.len()) {
            let mut signal = [0.0; LANES];
            for (signal, record) in signal.iter_mut().zip(self.records) {
                *signal = record[sample];
            }
            for (own, [first, second]) in self.sections.iter().zip(&mut waiting) {
                for lane in 0..LANES {
                    let (input, output) = (signal[lane], own.above[0] * signal[lane] + first[lane]);
                    first[lane] = own.above[1] * input - own.below[0] * output + second[lane];
                    second[lane] = own.above[2] * input - own.below[1] * output;
                    signal[lane] = output;
                }
            }
            (self.each)(sample, &signal);
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
