//! K&C cycles, slow ones and sines.

use std::f64::consts::{PI, TAU};

use nalgebra::Complex;

use super::bench::{Bench, Instant};
use super::{Free, PredictError, Prediction};
use crate::discover::evidence::travel::MOVED;
use crate::discover::evidence::{Evidence, Kind, Series, Stimulus};
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

/// The values of some series.
type Said = Vec<Vec<Complex<f64>>>;

pub(super) fn travel(
    model: &dyn Model,
    values: &Values,
    free: &[Free],
    evidence: &Evidence,
    run: usize,
) -> Result<Vec<Prediction>, PredictError> {
    let of_run = &evidence.runs[run];
    let (Stimulus::Travel { axis, .. } | Stimulus::Sine { axis, .. }) = of_run.stimulus else {
        return Ok(Vec::new());
    };
    let bench = Bench::new(model.about(), axis).ok_or_else(|| PredictError::NoInput {
        model: model.about().name.to_string(),
        location: MOVED.to_owned(),
        run: of_run.name.clone(),
    })?;
    let all = evidence.series.iter().enumerate();
    let series: Vec<(usize, &Series)> = all.filter(|(_, series)| series.run == run).collect();
    let says = |p: &[f64]| match of_run.stimulus {
        Stimulus::Sine { frequency, .. } => sine(&bench, model, p, (of_run.level, frequency), &series),
        Stimulus::Travel { ends, .. } => cycle(&bench, model, p, ends, &series),
        _ => Vec::new(),
    };
    Ok(differentiated(values, free, &series, &says))
}

/// What is said of some series with the parameters as they are, and its differences.
fn differentiated(
    values: &Values,
    free: &[Free],
    series: &[(usize, &Series)],
    says: &dyn Fn(&[f64]) -> Said,
) -> Vec<Prediction> {
    let mut predictions: Vec<Prediction> = series
        .iter()
        .zip(says(values.as_slice()))
        .map(|(&(series, _), value)| Prediction {
            series,
            value,
            slopes: Vec::new(),
            delay: None,
        })
        .collect();
    for free in free {
        let at = values.as_slice()[free.parameter];
        let step = DIFFERENCE * at.abs().max(PART_OF_RANGE * (free.upper - free.lower).min(f64::MAX));
        let mut moved = values.clone();
        moved.set(free.parameter, at + step);
        for (prediction, moved) in predictions.iter_mut().zip(says(moved.as_slice())) {
            let slopes = moved
                .iter()
                .zip(&prediction.value)
                .map(|(moved, value)| (moved - value) / step);
            prediction.slopes.push(slopes.collect());
        }
    }
    predictions
}

/// Middle and half width of a slow cycle, at the travels of the series; both are at the same.
fn cycle(bench: &Bench, model: &dyn Model, p: &[f64], ends: [f64; 2], series: &[(usize, &Series)]) -> Said {
    let travels = &series[0].1.at;
    let there = way(0.0, ends[0]).chain(way(ends[0], travels[0]));
    let back = way(ends[1], travels[travels.len() - 1]);
    let stops: Vec<f64> = there
        .chain(travels[1..].iter().copied())
        .chain([ends[1]])
        .chain(back)
        .chain(travels.iter().rev().skip(1).copied())
        .collect();
    let mut last = 0.0;
    let path: Vec<Instant> = stops
        .iter()
        .map(|&travel| {
            let way: f64 = travel - std::mem::replace(&mut last, travel);
            Instant {
                travel,
                speed: SLOW * way.signum(),
                step: (way.abs() / SLOW).max(SHORTEST),
            }
        })
        .collect();
    let forces = bench.forces(model, p, &path);
    let back = &forces[forces.len() - travels.len()..];
    let there = &forces[2 * APPROACH - 1..][..travels.len()];
    let of = |series: &(usize, &Series)| {
        let back_sign = if series.1.kind == Kind::Width { -0.5 } else { 0.5 };
        let pairs = there.iter().zip(back.iter().rev());
        pairs
            .map(|(there, back)| Complex::from(0.5 * there + back_sign * back))
            .collect()
    };
    series.iter().map(of).collect()
}

/// Equal steps to the end of a way.
fn way(from: f64, to: f64) -> impl Iterator<Item = f64> {
    (1..=APPROACH).map(move |i| from + (to - from) * i as f64 / APPROACH as f64)
}

/// Harmonics of the force over the amplitude of a sine that begins at its end of travel.
fn sine(
    bench: &Bench,
    model: &dyn Model,
    p: &[f64],
    (amplitude, frequency): (f64, f64),
    series: &[(usize, &Series)],
) -> Said {
    let omega = TAU * frequency;
    let approach = way(0.0, amplitude).map(|travel| Instant {
        travel,
        speed: omega * amplitude,
        step: 1.0 / (frequency * PARTS as f64),
    });
    let turns: Vec<Turn> = (0..PARTS + PARTS / 2).flat_map(Turn::of_part).collect();
    let swing = turns.iter().map(|turn| Instant {
        travel: amplitude * turn.angle.cos(),
        speed: -omega * amplitude * turn.angle.sin(),
        step: turn.width / omega,
    });
    let path: Vec<Instant> = approach.chain(swing).collect();
    let forces = bench.forces(model, p, &path);
    let harmonic = |order: usize| {
        let settled = turns.iter().zip(&forces[APPROACH..]);
        let settled = settled.filter(|(turn, _)| turn.settled);
        let part = |(turn, force): (&Turn, &f64)| {
            Complex::from_polar(turn.width / PI, -(order as f64) * turn.angle) * force / amplitude
        };
        vec![settled.map(part).sum()]
    };
    let of = |series: &(usize, &Series)| match series.1.kind {
        Kind::Cycle(order) => harmonic(order),
        _ => Vec::new(),
    };
    series.iter().map(of).collect()
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
