//! Random roads of ISO 8608: a power spectral density that falls with the square of the wave number.

use super::RoadError;
use crate::random::SplitMix;
use std::f64::consts::TAU;

/// Road class of ISO 8608, from very good (A) to hardly passable (H).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[expect(missing_docs, reason = "the letters of the standard")]
pub enum Class {
    A,
    B,
    C,
    D,
    E,
    F,
    G,
    H,
}

/// A random road of a class: the same description gives the same road.
///
/// The displacement has the one-sided power spectral density `G(n) = G(n0) (n/n0)^-2`, `n0` = 0.1 cycles/m, for wave
/// numbers `n` of 0.011 to 2.83 cycles/m, and nothing outside (ISO 8608, geometric means of the classes). It is a sum
/// of sines, one in each of 512 bands of equal ratio, with random phase and random position in its band. The wave
/// numbers have no common multiple, so the road does not repeat. It rises from flat over the first 5 m.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Random {
    /// Class.
    pub class: Class,
    /// Seed of phases and wave numbers.
    pub seed: u64,
    /// Length, m.
    pub length: f64,
    /// Distance between points, m: at most a tenth of the shortest wave, 0.035 m.
    pub spacing: f64,
}

const REFERENCE_WAVE_NUMBER: f64 = 0.1;
const LOWEST: f64 = 0.011;
const HIGHEST: f64 = 2.83;
const BANDS: usize = 512;
const FADE_IN: f64 = 5.0;
const LARGEST_SPACING: f64 = 0.1 / HIGHEST;

impl Class {
    /// `G(n0)` in m³: 16e-6 for A, four times as much for each class that follows.
    pub fn reference_density(self) -> f64 {
        16e-6 * f64::from(4_u32.pow(self as u32))
    }
}

impl Random {
    pub(super) fn points(&self) -> Result<Vec<[f64; 2]>, RoadError> {
        self.check()?;
        let count = (self.length / self.spacing).round() as usize + 1;
        let heights = heights(&self.waves(), self.spacing, count);
        let points = heights.into_iter().enumerate().map(|(i, height)| {
            let x = i as f64 * self.spacing;
            [x, fade_in(x) * height]
        });
        Ok(points.collect())
    }

    fn check(&self) -> Result<(), RoadError> {
        if !(self.spacing > 0.0 && self.spacing <= LARGEST_SPACING) {
            let expected = "positive and at most 0.035 m, a tenth of the shortest wave of ISO 8608";
            return Err(RoadError::Shape {
                name: "spacing of the random road",
                expected,
                value: self.spacing,
            });
        }
        if !(self.length.is_finite() && self.length > FADE_IN) {
            let expected = "longer than the 5 m over which it rises from flat";
            return Err(RoadError::Shape {
                name: "length of the random road",
                expected,
                value: self.length,
            });
        }
        Ok(())
    }

    fn waves(&self) -> Vec<Wave> {
        let mut random = SplitMix::new(self.seed);
        let ratio = (HIGHEST / LOWEST).powf(1.0 / BANDS as f64);
        let edge = |band: usize| LOWEST * ratio.powi(band as i32);
        (0..BANDS)
            .map(|band| {
                let (low, high) = (edge(band), edge(band + 1));
                // The power of the whole band, ∫ G dn, wherever the wave number lies in it.
                let power = self.class.reference_density() * REFERENCE_WAVE_NUMBER.powi(2) * (1.0 / low - 1.0 / high);
                Wave {
                    amplitude: (2.0 * power).sqrt(),
                    wave_number: low + (high - low) * random.uniform(),
                    phase: TAU * random.uniform(),
                }
            })
            .collect()
    }
}

struct Wave {
    amplitude: f64,
    wave_number: f64,
    phase: f64,
}

/// Number of points that are computed from one by rotating each sine; rounding then stays below 1e-14 of its amplitude.
const TURNED: usize = 64;

/// The sums of waves at `count` points with a distance of `spacing` (m).
fn heights(waves: &[Wave], spacing: f64, count: usize) -> Vec<f64> {
    let mut heights = vec![0.0; count];
    for (block, heights) in heights.chunks_mut(TURNED).enumerate() {
        let x = (block * TURNED) as f64 * spacing;
        for wave in waves {
            let (turn_sin, turn_cos) = (TAU * wave.wave_number * spacing).sin_cos();
            let (mut sin, mut cos) = (TAU * wave.wave_number * x + wave.phase).sin_cos();
            for height in heights.iter_mut() {
                *height += wave.amplitude * sin;
                (sin, cos) = (sin * turn_cos + cos * turn_sin, cos * turn_cos - sin * turn_sin);
            }
        }
    }
    heights
}

fn fade_in(x: f64) -> f64 {
    let u = (x / FADE_IN).min(1.0);
    u * u * (3.0 - 2.0 * u)
}

#[cfg(test)]
mod tests {
    use super::{Class, Random, TAU, heights};

    #[test]
    fn heights_are_the_sums_of_the_sines() {
        let random = Random {
            class: Class::C,
            seed: 5,
            length: 400.0,
            spacing: 0.03,
        };
        let waves = random.waves();
        let found = heights(&waves, random.spacing, 13_334);
        for i in [0, 1, 63, 64, 8_000, 13_333] {
            let x = i as f64 * random.spacing;
            let sines = waves
                .iter()
                .map(|w| w.amplitude * (TAU * w.wave_number * x + w.phase).sin());
            let expected: f64 = sines.sum();
            assert!((found[i] - expected).abs() < 1e-12, "{i}: {} {expected}", found[i]);
        }
    }
}
