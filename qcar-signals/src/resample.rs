//! Resampling by a filter of linear phase: a windowed sinc, without its delay.
//!
//! The pass band reaches up to [`PASS`] of the lower of both rates, with amplitudes accurate to [`RIPPLE`]. The stop
//! band begins at [`STOP`], half the lower rate: higher frequencies are attenuated to [`RIPPLE`] and do not alias.

/// End of the pass band relative to the lower rate.
pub const PASS: f64 = 0.4;
/// Start of the stop band relative to the lower rate.
pub const STOP: f64 = 0.5;
/// Largest relative error of an amplitude in the pass band, and largest gain in the stop band: -80 dB.
pub const RIPPLE: f64 = 1e-4;

/// Entries of the kernel's table between two zeros of its sinc; linear interpolation between them has an error of 1e-6.
const FINENESS: usize = 1024;

/// Evenly spaced times.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Grid {
    /// First time, s.
    pub start: f64,
    /// Sample rate, Hz.
    pub rate: f64,
    /// Number of samples.
    pub count: usize,
}

impl Grid {
    /// Time of a sample, s.
    pub fn time(&self, at: usize) -> f64 {
        self.start + at as f64 / self.rate
    }

    /// Last time, s.
    pub fn end(&self) -> f64 {
        self.time(self.count.saturating_sub(1))
    }
}

/// Resamples `samples`, taken at the times `from`, at the times `to`, which must be inside them.
///
/// Within [`reach`] of an end, the samples are continued by point reflection about the last one, so values there are
/// only as accurate as this assumption. A constant is preserved to rounding.
pub fn resample(samples: &[f64], from: Grid, to: Grid) -> Vec<f64> {
    let kernel = Kernel::between(from.rate, to.rate);
    let at = |k: usize| (to.time(k) - from.start) * from.rate;
    (0..to.count).map(|k| kernel.at(samples, at(k))).collect()
}

/// Half the length of the filter between two rates, s.
pub fn reach(from: f64, to: f64) -> f64 {
    Kernel::half_length(from.min(to))
}

/// A low-pass as a table over the distance from its centre.
struct Kernel {
    /// Reach to each side, in samples.
    half: f64,
    /// Values from the centre outwards, `fineness` entries per sample.
    table: Vec<f64>,
    fineness: f64,
}

impl Kernel {
    /// Designed by Kaiser's formulas for the ripple and the transition width.
    fn between(from: f64, to: f64) -> Kernel {
        let lower = from.min(to);
        let half = Self::half_length(lower) * from;
        // Centre of the transition, cycles per sample of `from`.
        let cutoff = 0.5 * (PASS + STOP) * lower / from;
        let fineness = (2.0 * cutoff * FINENESS as f64).max(1.0);
        let entries = (half * fineness).ceil() as usize + 2;
        let beta = 0.1102 * (decibels() - 8.7);
        let window = |share: f64| bessel_i0(beta * (1.0 - share * share).max(0.0).sqrt());
        let value = |entry: usize| {
            let distance = entry as f64 / fineness;
            sinc(2.0 * cutoff * distance) * if distance <= half { window(distance / half) } else { 0.0 }
        };
        Kernel {
            half,
            table: (0..entries).map(value).collect(),
            fineness,
        }
    }

    /// Half the length in seconds.
    fn half_length(lower: f64) -> f64 {
        (decibels() - 7.95) / (2.285 * std::f64::consts::TAU * (STOP - PASS) * lower) / 2.0
    }

    fn weight(&self, distance: f64) -> f64 {
        let place = distance.abs() * self.fineness;
        let entry = place as usize;
        match self.table.get(entry..entry + 2) {
            Some([near, far]) => near + (far - near) * (place - entry as f64),
            _ => 0.0,
        }
    }

    /// Value at a position, in samples.
    fn at(&self, samples: &[f64], place: f64) -> f64 {
        let (first, last) = (
            (place - self.half).ceil() as isize,
            (place + self.half).floor() as isize,
        );
        let (mut sum, mut weights) = (0.0, 0.0);
        for k in first..=last {
            let weight = self.weight(k as f64 - place);
            sum += weight * continued(samples, k);
            weights += weight;
        }
        sum / weights
    }
}

/// A sample; beyond an end, the point reflection about the last one.
fn continued(samples: &[f64], at: isize) -> f64 {
    let last = samples.len() as isize - 1;
    let mirrored = if at < 0 { -at } else { 2 * last - at };
    if (0..=last).contains(&at) {
        samples[at as usize]
    } else {
        let end = samples[if at < 0 { 0 } else { last as usize }];
        2.0 * end - samples[mirrored.clamp(0, last) as usize]
    }
}

fn decibels() -> f64 {
    -20.0 * RIPPLE.log10()
}

fn sinc(x: f64) -> f64 {
    let angle = std::f64::consts::PI * x;
    if angle == 0.0 { 1.0 } else { angle.sin() / angle }
}

/// The modified Bessel function of order 0, by its series.
fn bessel_i0(x: f64) -> f64 {
    let quarter = x * x / 4.0;
    let (mut term, mut sum, mut k) = (1.0, 1.0, 1.0);
    while term > 1e-17 * sum {
        term *= quarter / (k * k);
        sum += term;
        k += 1.0;
    }
    sum
}
