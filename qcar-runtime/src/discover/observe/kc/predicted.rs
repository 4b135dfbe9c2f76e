//! Predicts K&C tests: slow cycles and sines.

use std::f64::consts::{PI, TAU};

use nalgebra::Complex;

use super::bench::{Bench, Instant};
use crate::discover::observe::{Evidence, Free, Kind, PredictError, Prediction, Series, Stimulus};
use crate::model::Model;
use crate::response::parameters::Values;

/// Speed of a slow cycle, m/s: low enough for damper forces below one newton.
const SLOW: f64 = 1e-4;
/// Time step if the wheel does not move, s.
const SHORTEST: f64 = 1e-3;
/// Number of instants on the way to an end of the travel, and from there to the first value.
const APPROACH: usize = 6;
/// Parts of a cycle of a sine. Half a cycle comes first, so that friction starts as in every later cycle.
const PARTS: usize = 48;
/// Number of parts after a reversal that are divided further, because friction reverses within a fraction of a
/// millimetre.
const AFTER_REVERSAL: usize = 3;
/// Number of pieces of such a part.
const PIECES: usize = 8;

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
        Stimulus::Travel { on, axis, ends } => (on, axis, Course::cycle(*ends, &series[0].1.at)),
        Stimulus::Sine { on, axis, frequency } => (on, axis, Course::sine(of_run.level, *frequency)),
        _ => return Ok(Vec::new()),
    };
    let not_on_rig = || PredictError::no_input(model.about(), of_run, &on.wheel);
    let bench = Bench::new(model.about(), on, axis).ok_or_else(not_on_rig)?;
    let directions: Vec<Vec<usize>> = free.iter().map(|free| values.tied_to(free.parameter)).collect();
    let forces = bench.forces(model, values.as_slice(), &directions, &course.path);
    let forces = forces.ok_or_else(not_on_rig)?;
    let predict = |&(place, series): &(usize, &Series)| {
        // What is read is linear in the forces, so its derivatives are read from theirs.
        let mut read = forces.iter().map(|forces| course.read(series.kind, forces));
        Prediction {
            series: place,
            value: read.next().unwrap_or_default(),
            slopes: read.collect(),
            delay: None,
            by_drive: Vec::new(),
            by_initial_states: Vec::new(),
        }
    };
    Ok(series.iter().map(predict).collect())
}

/// The path of a rig in a run, and how its forces are read.
struct Course {
    path: Vec<Instant>,
    reading: Reading,
}

enum Reading {
    /// Forces at `count` travels, for increasing and then for decreasing travel.
    BothDirections { count: usize },
    /// Forces at pieces of a sine with this amplitude (m).
    Pieces { pieces: Vec<Piece>, amplitude: f64 },
}

impl Course {
    /// A slow cycle between two ends of travel (m), read at `travels` (m) in both directions.
    fn cycle([low, high]: [f64; 2], travels: &[f64]) -> Self {
        let [first, last] = [travels[0], travels[travels.len() - 1]];
        let unread = |from: f64, to: f64| positions(from, to).map(|travel| (travel, false));
        let there = unread(0.0, low)
            .chain(unread(low, first).take(APPROACH - 1))
            .chain(travels.iter().map(|&travel| (travel, true)));
        let back = unread(last, high)
            .chain(unread(high, last).take(APPROACH - 1))
            .chain(travels.iter().rev().map(|&travel| (travel, true)));
        let mut before = 0.0;
        let instant = |(travel, is_read): (f64, bool)| {
            let step: f64 = travel - std::mem::replace(&mut before, travel);
            Instant {
                travel,
                speed: SLOW * step.signum(),
                step: (step.abs() / SLOW).max(SHORTEST),
                is_read,
            }
        };
        Self {
            path: there.chain(back).map(instant).collect(),
            reading: Reading::BothDirections { count: travels.len() },
        }
    }

    /// A sine that begins at its largest travel; `amplitude` in m, `frequency` in Hz.
    fn sine(amplitude: f64, frequency: f64) -> Self {
        let omega = TAU * frequency;
        let approach = positions(0.0, amplitude).map(|travel| Instant {
            travel,
            speed: omega * amplitude,
            step: 1.0 / (frequency * PARTS as f64),
            is_read: false,
        });
        let pieces: Vec<Piece> = (0..PARTS + PARTS / 2).flat_map(Piece::of_part).collect();
        let swing = pieces.iter().map(|piece| Instant {
            travel: amplitude * piece.angle.cos(),
            speed: -omega * amplitude * piece.angle.sin(),
            step: piece.width / omega,
            is_read: piece.settled,
        });
        Self {
            path: approach.chain(swing).collect(),
            reading: Reading::Pieces {
                pieces: pieces.into_iter().filter(|piece| piece.settled).collect(),
                amplitude,
            },
        }
    }

    /// Values of a series from the forces: the middle or half width of a cycle at its travels, or a harmonic over the
    /// amplitude.
    fn read(&self, kind: Kind, forces: &[f64]) -> Vec<Complex<f64>> {
        match (&self.reading, kind) {
            (Reading::BothDirections { count }, _) => {
                let sign = if kind == Kind::Width { -0.5 } else { 0.5 };
                let (there, back) = forces.split_at(*count);
                let pairs = there.iter().zip(back.iter().rev());
                pairs
                    .map(|(there, back)| Complex::from(0.5 * there + sign * back))
                    .collect()
            }
            (Reading::Pieces { pieces, amplitude }, Kind::Cycle(order)) => {
                let part = |(piece, force): (&Piece, &f64)| {
                    Complex::from_polar(piece.width / PI, -(order as f64) * piece.angle) * force / amplitude
                };
                vec![pieces.iter().zip(forces).map(part).sum()]
            }
            _ => Vec::new(),
        }
    }
}

/// Equally spaced positions between two travels (m), the last included.
fn positions(from: f64, to: f64) -> impl Iterator<Item = f64> {
    (1..=APPROACH).map(move |i| from + (to - from) * i as f64 / APPROACH as f64)
}

/// A piece of a sine.
struct Piece {
    /// Angle of its middle, rad.
    angle: f64,
    /// Width, rad.
    width: f64,
    /// True after the first half cycle, when friction is as in every later cycle.
    settled: bool,
}

impl Piece {
    /// The pieces of a part around its angle. The first and the middle part of a cycle are at its reversals.
    fn of_part(part: usize) -> impl Iterator<Item = Piece> {
        let count = if part % (PARTS / 2) < AFTER_REVERSAL { PIECES } else { 1 };
        let width = TAU / (PARTS * count) as f64;
        (0..count).map(move |piece| Piece {
            angle: width * ((part * count + piece) as f64 - (count - 1) as f64 / 2.0),
            width,
            settled: part >= PARTS / 2,
        })
    }
}
