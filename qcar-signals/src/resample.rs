//! Samples at other instants, by a filter of linear phase: a windowed sinc, whose delay is taken out.
//!
//! Of the lower of both rates, the pass band reaches up to [`PASS`], where amplitudes are kept within [`RIPPLE`], and the stop
//! band begins at [`STOP`], half of it: what lies above is lowered to [`RIPPLE`] and does not fold back.

/// End of the pass band as a share of the lower rate.
pub const PASS: f64 = 0.4;
/// Begin of the stop band as a share of the lower rate.
pub const STOP: f64 = 0.5;
/// Largest relative error of an amplitude in the pass band, and largest amplitude that is left of 1 in the stop band: -80 dB.
pub const RIPPLE: f64 = 1e-4;

/// Entries of the kernel's table from one zero of its sinc to the next; a straight line between them is off by 1e-6.
const FINENESS: usize = 1024;

/// Evenly spaced instants.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Grid {
    /// The first, s.
    pub start: f64,
    /// Hz.
    pub rate: f64,
    /// How many.
    pub count: usize,
}

impl Grid {
    /// The instant of a sample, s.
    pub fn time(&self, at: usize) -> f64 {
        self.start + at as f64 / self.rate
    }

    /// The last instant, s.
    pub fn end(&self) -> f64 {
        self.time(self.count.saturating_sub(1))
    }
}

/// `samples`, taken at the instants `from`, at the instants `to`, which lie among them.
///
/// Within [`reach`] of an end of the samples, their continuation is taken as turned about the last one: values there are
/// as good as that is true. A constant stays as it is, to the last digits.
pub fn resample(samples: &[f64], from: Grid, to: Grid) -> Vec<f64> {
    let kernel = Kernel::between(from.rate, to.rate);
    let at = |k: usize| (to.time(k) - from.start) * from.rate;
    (0..to.count).map(|k| kernel.at(samples, at(k))).collect()
}

/// Half the length of the filter between two rates, s.
pub fn reach(from: f64, to: f64) -> f64 {
    Kernel::half_length(from.min(to))
}

/// A low-pass as a table over the distance from its middle.
struct Kernel {
    /// Samples to each side.
    half: f64,
    /// From the middle outwards, `fineness` entries a sample.
    table: Vec<f64>,
    fineness: f64,
}

impl Kernel {
    /// By Kaiser's formulas for the ripple and the width between pass and stop band.
    fn between(from: f64, to: f64) -> Kernel {
        let lower = from.min(to);
        let half = Self::half_length(lower) * from;
        // The middle of the slope, cycles a sample of `from`.
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

    /// The value at a place, counted in samples.
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

/// A sample, or beyond an end what comes of turning the samples about the last one there.
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
