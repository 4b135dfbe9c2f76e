//! A recorded signal at any time, with its first two derivatives.

use std::f64::consts::TAU;

use nalgebra::Complex;

use crate::spectrum::{synthesize, transform};

/// A signal between its samples, the first of which is at t = 0.
#[derive(Clone, Debug)]
pub(super) enum Wave {
    /// One period of a Fourier series, for ever repeated, on a straight line through zero.
    Periodic {
        /// Time between nodes, s.
        spacing: f64,
        /// Value and derivatives at each node.
        nodes: Vec<[f64; 3]>,
        /// Slope of the line.
        rise: f64,
    },
    /// Each sample until the next, at this rate (Hz).
    Held { rate: f64, samples: Vec<f64> },
}

/// Nodes for each sample: a polynomial of fifth order between them meets what the band limit allows to 1e-5.
const FINER: usize = 4;

impl Wave {
    /// The signal whose derivative of order `measured` was sampled at `rate` (Hz), with nothing at half that rate.
    ///
    /// A signal that was measured itself may end elsewhere than where it began: the line goes from its first sample to
    /// the one that would follow the last. An integral is taken without the mean, and begins at zero.
    pub fn band_limited(samples: &[f64], rate: f64, measured: i32) -> Self {
        let n = samples.len();
        let rise = if measured == 0 {
            (following(samples) - samples[0]) * rate / n as f64
        } else {
            0.0
        };
        let bent = samples.iter().enumerate().map(|(k, y)| y - rise * k as f64 / rate);
        let spectrum = transform(&bent.collect::<Vec<_>>());
        let [mut signal, first, second] = [0, 1, 2].map(|order| derivative(&spectrum, n, rate, order - measured));
        if measured > 0 {
            let start = signal[0];
            signal.iter_mut().for_each(|value| *value -= start);
        }
        let nodes = signal.iter().zip(&first).zip(&second);
        Self::Periodic {
            spacing: 1.0 / (rate * FINER as f64),
            nodes: nodes.map(|((&y, &dy), &ddy)| [y, dy, ddy]).collect(),
            rise,
        }
    }

    /// Value, first and second derivative at time `t` (s); what is held has that of the jump at `leg` (s).
    pub fn at(&self, t: f64, leg: f64) -> [f64; 3] {
        match self {
            Self::Periodic { spacing, nodes, rise } => {
                let place = (t / spacing).floor();
                let node = |k: i64| &nodes[k.rem_euclid(nodes.len() as i64) as usize];
                let [y, dy, ddy] = quintic(
                    node(place as i64),
                    node(place as i64 + 1),
                    *spacing,
                    t / spacing - place,
                );
                [y + rise * t, dy + rise, ddy]
            }
            Self::Held { rate, samples } => {
                let sample = ((leg * rate).round().max(0.0) as usize).min(samples.len() - 1);
                [samples[sample], 0.0, 0.0]
            }
        }
    }
}

/// The sample after the last, by the parabola through the last three.
fn following(samples: &[f64]) -> f64 {
    match samples {
        [.., a, b, c] => 3.0 * (c - b) + a,
        _ => samples[0],
    }
}

/// The derivative of this order (integral, below zero) of `samples` values with this spectrum, at the nodes.
fn derivative(spectrum: &[Complex<f64>], samples: usize, rate: f64, order: i32) -> Vec<f64> {
    let below_half = samples.div_ceil(2);
    let line = |k: usize| {
        let omega = TAU * rate * k as f64 / samples as f64;
        match (k, order) {
            (_, 0) => spectrum[k],
            (0, _) => Complex::ZERO,
            _ => spectrum[k] * Complex::new(0.0, omega).powi(order),
        }
    };
    let lines: Vec<_> = (0..below_half).map(line).collect();
    let mut nodes = synthesize(&lines, samples * FINER);
    nodes.iter_mut().for_each(|node| *node *= FINER as f64);
    nodes
}

/// The polynomial through two nodes with their derivatives, a share `u` of the way from one to the other.
fn quintic(from: &[f64; 3], to: &[f64; 3], h: f64, u: f64) -> [f64; 3] {
    let [c0, c1, c2] = [from[0], h * from[1], 0.5 * h * h * from[2]];
    let [y, dy, ddy] = [
        to[0] - c0 - c1 - c2,
        h * to[1] - c1 - 2.0 * c2,
        h * h * to[2] - 2.0 * c2,
    ];
    let c3 = 10.0 * y - 4.0 * dy + 0.5 * ddy;
    let c4 = -15.0 * y + 7.0 * dy - ddy;
    let c5 = 6.0 * y - 3.0 * dy + 0.5 * ddy;
    [
        c0 + u * (c1 + u * (c2 + u * (c3 + u * (c4 + u * c5)))),
        (c1 + u * (2.0 * c2 + u * (3.0 * c3 + u * (4.0 * c4 + u * 5.0 * c5)))) / h,
        (2.0 * c2 + u * (6.0 * c3 + u * (12.0 * c4 + u * 20.0 * c5))) / (h * h),
    ]
}
