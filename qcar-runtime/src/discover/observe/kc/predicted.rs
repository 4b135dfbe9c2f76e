//! K&C cycles, slow ones and sines.

use std::f64::consts::{PI, TAU};

use nalgebra::Complex;

use super::bench::{Bench, Instant};
use crate::discover::observe::{Evidence, Free, Kind, PredictError, Prediction, Series, Stimulus};
use crate::model::Model;
use crate::response::parameters::Values;

/// Change of a parameter for its difference, relative to its value or, near zero, to a part of its range.
const DIFFERENCE: f64 = 1e-5;
const PART_OF_RANGE: f64 = 1e-3;
/// Of a cycle whose speed does not count, m/s: no damper gives a newton.
const SLOW: f64 = 1e-4;
/// Step where the wheel stays where it was, s.
const SHORTEST: f64 = 1e-3;
/// Instants on the way to the end of the travel, and from there to where it is read first.
const APPROACH: usize = 6;
/// Parts of a sine, of which half goes before, so that friction sets out as it does in every cycle.
const PARTS: usize = 48;
/// So many parts behind a reversal, where friction turns within a fraction of a millimetre, are taken finer.
const TURNING: usize = 3;
const FINER: usize = 8;

pub fn travel(
    model: &dyn Model,
    values: &Values,
    free: &[Free],
    evidence: &Evidence,
    run: usize,
) -> Result<Vec<Prediction>, PredictError> {
    let of_run = &evidence.runs[run];
    let all = evidence.series.iter().enumerate();
    let series: Vec<(usize, &Series)> = all.filter(|(_, series)| series.run == run).collect();
    let (on, axis, course) = match &of_run.stimulus {
        Stimulus::Travel { on, axis, ends } => (on, *axis, Course::cycle(*ends, &series[0].1.at)),
        Stimulus::Sine { on, axis, frequency } => (on, *axis, Course::sine(of_run.level, *frequency)),
        _ => return Ok(Vec::new()),
    };
    let unmoved = || PredictError::no_input(model.about(), of_run, &on.wheel);
    let bench = Bench::new(model.about(), on, axis).ok_or_else(unmoved)?;
    let (moved, steps): (Vec<_>, Vec<_>) = free.iter().map(|free| moved(values, free)).unzip();
    let forces = bench.forces(model, values.as_slice(), &moved, &course.path);
    let forces = forces.ok_or_else(unmoved)?;
    let predict = |&(place, series): &(usize, &Series)| {
        let read = |forces: &[f64]| course.read(series.kind, forces);
        let value = read(&forces[0]);
        let slope = |(forces, step): (&Vec<f64>, &f64)| {
            let pairs = read(forces).into_iter().zip(&value);
            pairs.map(|(moved, value)| (moved - value) / step).collect()
        };
        Prediction {
            series: place,
            slopes: forces[1..].iter().zip(&steps).map(slope).collect(),
            value,
            delay: None,
            louder: None,
            begun: Vec::new(),
        }
    };
    Ok(series.iter().map(predict).collect())
}

/// The parameters with a free one moved, and by how much.
fn moved(values: &Values, free: &Free) -> (Vec<f64>, f64) {
    let at = values.as_slice()[free.parameter];
    let step = DIFFERENCE * at.abs().max(PART_OF_RANGE * (free.upper - free.lower).min(f64::MAX));
    let mut moved = values.clone();
    moved.set(free.parameter, at + step);
    (moved.as_slice().to_vec(), step)
}

/// What a rig does in a run, and what is read from its forces.
struct Course {
    path: Vec<Instant>,
    reading: Reading,
}

enum Reading {
    /// The way there and the way back, each through so many travels.
    Ways { count: usize },
    /// Pieces of a sine of this amplitude (m).
    Turns { turns: Vec<Turn>, amplitude: f64 },
}

impl Course {
    /// A slow cycle between two ends, there and back through some travels.
    fn cycle([low, high]: [f64; 2], travels: &[f64]) -> Self {
        let [first, last] = [travels[0], travels[travels.len() - 1]];
        let unread = |from: f64, to: f64| way(from, to).map(|travel| (travel, false));
        let there = unread(0.0, low)
            .chain(unread(low, first).take(APPROACH - 1))
            .chain(travels.iter().map(|&travel| (travel, true)));
        let back = unread(last, high)
            .chain(unread(high, last).take(APPROACH - 1))
            .chain(travels.iter().rev().map(|&travel| (travel, true)));
        let mut before = 0.0;
        let instant = |(travel, is_read): (f64, bool)| {
            let way: f64 = travel - std::mem::replace(&mut before, travel);
            Instant {
                travel,
                speed: SLOW * way.signum(),
                step: (way.abs() / SLOW).max(SHORTEST),
                is_read,
            }
        };
        Self {
            path: there.chain(back).map(instant).collect(),
            reading: Reading::Ways { count: travels.len() },
        }
    }

    /// A sine that begins at its end of travel.
    fn sine(amplitude: f64, frequency: f64) -> Self {
        let omega = TAU * frequency;
        let approach = way(0.0, amplitude).map(|travel| Instant {
            travel,
            speed: omega * amplitude,
            step: 1.0 / (frequency * PARTS as f64),
            is_read: false,
        });
        let turns: Vec<Turn> = (0..PARTS + PARTS / 2).flat_map(Turn::of_part).collect();
        let swing = turns.iter().map(|turn| Instant {
            travel: amplitude * turn.angle.cos(),
            speed: -omega * amplitude * turn.angle.sin(),
            step: turn.width / omega,
            is_read: turn.settled,
        });
        Self {
            path: approach.chain(swing).collect(),
            reading: Reading::Turns {
                turns: turns.into_iter().filter(|turn| turn.settled).collect(),
                amplitude,
            },
        }
    }

    /// From the forces that are read the values of a series: middle or half width of a cycle at its travels, or a harmonic
    /// over the amplitude.
    fn read(&self, kind: Kind, forces: &[f64]) -> Vec<Complex<f64>> {
        match (&self.reading, kind) {
            (Reading::Ways { count }, _) => {
                let sign = if kind == Kind::Width { -0.5 } else { 0.5 };
                let (there, back) = forces.split_at(*count);
                let pairs = there.iter().zip(back.iter().rev());
                pairs
                    .map(|(there, back)| Complex::from(0.5 * there + sign * back))
                    .collect()
            }
            (Reading::Turns { turns, amplitude }, Kind::Cycle(order)) => {
                let part = |(turn, force): (&Turn, &f64)| {
                    Complex::from_polar(turn.width / PI, -(order as f64) * turn.angle) * force / amplitude
                };
                vec![turns.iter().zip(forces).map(part).sum()]
            }
            _ => Vec::new(),
        }
    }
}

/// Equal steps to the end of a way.
fn way(from: f64, to: f64) -> impl Iterator<Item = f64> {
    (1..=APPROACH).map(move |i| from + (to - from) * i as f64 / APPROACH as f64)
}

/// A piece of a sine.
struct Turn {
    /// Its middle, rad.
    angle: f64,
    /// rad.
    width: f64,
    /// Whether it is behind the first half of a cycle.
    settled: bool,
}

impl Turn {
    /// A part around its angle, in one piece or more; the first and the middle part of a cycle are at its reversals.
    fn of_part(part: usize) -> impl Iterator<Item = Turn> {
        let pieces = if part % (PARTS / 2) < TURNING { FINER } else { 1 };
        let width = TAU / (PARTS * pieces) as f64;
        (0..pieces).map(move |piece| Turn {
            angle: width * ((part * pieces + piece) as f64 - (pieces - 1) as f64 / 2.0),
            width,
            settled: part >= PARTS / 2,
        })
    }
}
