//! The part of the hidden effects' response that no parameter of the engineer's model can reproduce, by the generator's
//! own equations. It measures how well the effects can be found at all, independently of any answer.

use crate::axle::Axle;
use crate::campaign::{self, Plan};
use crate::cleat;
use crate::corner::Corner;
use crate::hidden::Laws;
use crate::rig::{self, Sweep};

/// Only every ninth sample is used, to save time.
const STEP: usize = 9;
/// Relative step of the difference quotient with respect to a parameter.
const CHANGE: f64 = 0.01;

/// RMS over the fitted runs of the hidden effects' response, in units of the sensors' noise, less its least-squares
/// projection onto changes of the parameters and of the sensors' gains.
pub fn strength(plan: &Plan, real: &Axle, known: &Axle) -> f64 {
    if plan.effects.is_empty() {
        return 0.0;
    }
    let nothing = Laws::default();
    let truth = signals(plan, real, &Laws::of(&plan.effects));
    let base = signals(plan, known, &nothing);
    let mut imitations = Vec::new();
    for name in campaign::moving(plan) {
        let mut changed = *known;
        *campaign::value(&mut changed, name) *= 1.0 + CHANGE;
        imitations.push(difference(&signals(plan, &changed, &nothing), &base).concat());
    }
    for channel in 0..base.len() {
        let alone = |(k, signal): (usize, &Vec<f64>)| {
            if k == channel {
                signal.clone()
            } else {
                vec![0.0; signal.len()]
            }
        };
        imitations.push(base.iter().enumerate().map(alone).collect::<Vec<_>>().concat());
    }
    let mut left = difference(&truth, &base).concat();
    remove(&mut left, imitations);
    (left.iter().map(|x| x * x).sum::<f64>() / left.len() as f64).sqrt()
}

/// The signals of the sensors in the fitted runs, in units of their noise.
fn signals(plan: &Plan, axle: &Axle, laws: &Laws) -> Vec<Vec<f64>> {
    let corner = Corner { axle, laws };
    let programme = &plan.programme;
    let mut all: [Vec<f64>; 4] = Default::default();
    for run in programme.sweeps.iter().filter(|run| run.role == "fit") {
        let motion = rig::run(&corner, &Sweep::new(run, None));
        all[0].extend(seen(&motion.wheel, plan.noise));
        all[1].extend(seen(&motion.body, plan.noise));
    }
    for run in programme.cleats.iter().filter(|run| run.role == "fit") {
        let track = cleat::run(&corner, run, 0.0);
        let noise = campaign::TRACK_NOISE;
        all[0].extend(seen(&track.wheel_z, noise));
        all[1].extend(seen(&track.body_z, noise));
        all[2].extend(seen(&track.wheel_x, noise));
        all[3].extend(seen(&track.body_x, noise));
    }
    if !programme.body_sensor {
        all[1].clear();
        all[3].clear();
    }
    all.to_vec()
}

fn seen(signal: &[f64], noise: f64) -> impl Iterator<Item = f64> {
    signal.iter().step_by(STEP).map(move |a| a / noise)
}

fn difference(a: &[Vec<f64>], b: &[Vec<f64>]) -> Vec<Vec<f64>> {
    let of_signal = |(a, b): (&Vec<f64>, &Vec<f64>)| a.iter().zip(b).map(|(a, b)| a - b).collect();
    a.iter().zip(b).map(of_signal).collect()
}

/// Removes from `from` its projection onto the span of the columns (modified Gram-Schmidt).
fn remove(from: &mut [f64], mut columns: Vec<Vec<f64>>) {
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    for k in 0..columns.len() {
        let column = columns[k].clone();
        let power = dot(&column, &column);
        if power > 0.0 {
            let take = |other: &mut [f64]| {
                let share = dot(other, &column) / power;
                other.iter_mut().zip(&column).for_each(|(other, c)| *other -= share * c);
            };
            columns[k + 1..].iter_mut().for_each(|other| take(other));
            take(from);
        }
    }
}
