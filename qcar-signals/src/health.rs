//! Flaws of the samples of a channel.

/// A flaw of a channel.
#[derive(Clone, Debug, PartialEq)]
pub struct Flaw {
    /// Kind.
    pub kind: FlawKind,
    /// Positions of the first and last sample concerned.
    pub samples: (usize, usize),
    /// Number of occurrences.
    pub count: usize,
}

/// A kind of flaw.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum FlawKind {
    /// All samples have this value.
    Dead(f64),
    /// The signal is clipped at this value.
    Clipped(f64),
    /// One or two samples jump to this value and back; `samples` is the largest.
    Spike(f64),
    /// The mean drifts by this much from the beginning to the end.
    Drift(f64),
}

/// Flaws of a channel with evenly spaced, finite samples. `drift` includes drift, for quantities whose mean is known to
/// be constant.
pub fn flaws(samples: &[f64], drift: bool) -> Vec<Flaw> {
    let low = samples.iter().copied().fold(f64::INFINITY, f64::min);
    let high = samples.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    if samples.len() < 2 || low >= high {
        let dead = samples.first().map(|&value| Flaw {
            kind: FlawKind::Dead(value),
            samples: (0, samples.len() - 1),
            count: samples.len(),
        });
        return dead.into_iter().collect();
    }
    let clipped = [low, high].into_iter().filter_map(|extreme| clipping(samples, extreme));
    let drifts = if drift { self::drift(samples) } else { None };
    clipped.chain(spikes(samples, high - low)).chain(drifts).collect()
}

/// Smallest number of successive extreme samples that are clipped instead of a peak.
const FLAT: usize = 4;
/// Smallest drop at the sides of a clipped peak in steps of its resolution; a smooth peak of its width drops by less.
const STEEP: f64 = 30.0;
/// Smallest number of different values of a clipped signal; with fewer it switches in steps, like a valve.
const LEVELS: usize = 16;

/// Flat parts at an extreme that the signal enters and leaves steeply.
fn clipping(samples: &[f64], extreme: f64) -> Option<Flaw> {
    let step = smallest_step(samples)?;
    let (mut found, mut at): (Option<Flaw>, usize) = (None, 0);
    while at < samples.len() {
        let length = samples[at..].iter().take_while(|value| **value == extreme).count();
        if length >= FLAT && is_cut(samples, at, length, step) {
            let flaw = found.get_or_insert(Flaw {
                kind: FlawKind::Clipped(extreme),
                samples: (at, at),
                count: 0,
            });
            flaw.samples.1 = at + length - 1;
            flaw.count += length;
        }
        at += length.max(1);
    }
    found
}

/// Smallest difference between neighbours, if there are enough different values: the resolution of a converter, or
/// nearly zero.
fn smallest_step(samples: &[f64]) -> Option<f64> {
    let mut levels: Vec<f64> = Vec::new();
    let new = |value: &f64, levels: &[f64]| !levels.contains(value);
    for value in samples {
        if levels.len() < LEVELS && new(value, &levels) {
            levels.push(*value);
        }
    }
    let steps = samples
        .windows(2)
        .map(|two| (two[1] - two[0]).abs())
        .filter(|step| *step > 0.0);
    (levels.len() >= LEVELS).then(|| steps.fold(f64::INFINITY, f64::min))
}

fn is_cut(samples: &[f64], at: usize, length: usize, step: f64) -> bool {
    let steep = |other: Option<&f64>| other.is_some_and(|other| (other - samples[at]).abs() > STEEP * step);
    let before = at.checked_sub(length).and_then(|before| samples.get(before));
    steep(before) && steep(samples.get(at + 2 * length - 1))
}

/// Number of neighbours on each side that a spike is compared with.
const NEIGHBOURS: usize = 100;
/// Smallest distance of a spike, relative to the largest distance of its neighbours.
const STANDS_OUT: f64 = 10.0;
/// Number of neighbours on each side whose steps a spike is compared with: an impact is rough everywhere.
const NEAR: usize = 10;
/// Smallest height of a spike, relative to the largest of their steps.
const ROUGH: f64 = 2.0;
/// Smallest height of a spike, relative to the range of the channel.
const OF_RANGE: f64 = 0.01;

/// Samples far from the median of the five around them, while no neighbour is. The first and last two samples are not
/// tested.
fn spikes(samples: &[f64], range: f64) -> Option<Flaw> {
    let ends = [0.0; 2];
    let inner = samples.windows(5).map(|five| five[2] - median(five));
    let apart: Vec<f64> = ends.into_iter().chain(inner).chain(ends).collect();
    let around = |at: usize, reach: usize| at.saturating_sub(reach)..(at + reach + 1).min(samples.len());
    let is_spike = |at: &usize| {
        let own = apart[*at].abs();
        let alone = |other: usize| other.abs_diff(*at) <= 2 || apart[other].abs() < own / STANDS_OUT;
        let step = |to: usize| to > 0 && (samples[to] - samples[to - 1]).abs() > own / ROUGH;
        let smooth = |other: usize| (*at - 2..=*at + 3).contains(&other) || !step(other);
        own > OF_RANGE * range && around(*at, NEIGHBOURS).all(alone) && around(*at, NEAR).all(smooth)
    };
    let found: Vec<usize> = (2..samples.len().saturating_sub(2)).filter(is_spike).collect();
    let by_size = |a: &&usize, b: &&usize| apart[**a].abs().total_cmp(&apart[**b].abs());
    let largest = *found.iter().max_by(by_size)?;
    Some(Flaw {
        kind: FlawKind::Spike(samples[largest]),
        samples: (largest, largest),
        count: found.len(),
    })
}

fn median(five: &[f64]) -> f64 {
    let mut sorted = five.to_vec();
    sorted.sort_by(f64::total_cmp);
    sorted[sorted.len() / 2]
}

/// Number of parts of a record whose means show a drift.
const PARTS: usize = 10;
/// Smallest drift, relative to the RMS of the signal.
const OF_RMS: f64 = 0.3;
/// Smallest drift in standard errors from the scatter of the means: with eight degrees of freedom, less than 1 in 10
/// 000 by chance.
const SURE: f64 = 8.0;

/// The line through the means of the parts, if they are close to one.
fn drift(samples: &[f64]) -> Option<Flaw> {
    let length = samples.len() / PARTS;
    if length < 2 {
        return None;
    }
    let means: Vec<f64> = samples
        .chunks_exact(length)
        .take(PARTS)
        .map(|part| part.iter().sum::<f64>() / length as f64)
        .collect();
    let mean = means.iter().sum::<f64>() / PARTS as f64;
    let place = |part: usize| part as f64 - (PARTS as f64 - 1.0) / 2.0;
    let spread: f64 = (0..PARTS).map(|part| place(part).powi(2)).sum();
    let slope = (0..PARTS).map(|part| place(part) * (means[part] - mean)).sum::<f64>() / spread;
    let left: f64 = (0..PARTS)
        .map(|part| (means[part] - mean - slope * place(part)).powi(2))
        .sum();
    let error = (left / (PARTS as f64 - 2.0) / spread).sqrt();
    let variance = samples.iter().map(|sample| (sample - mean).powi(2)).sum::<f64>() / samples.len() as f64;
    let drift = slope * PARTS as f64;
    (drift.abs() > OF_RMS * variance.sqrt() && slope.abs() > SURE * error).then_some(Flaw {
        kind: FlawKind::Drift(drift),
        samples: (0, samples.len() - 1),
        count: samples.len(),
    })
}
