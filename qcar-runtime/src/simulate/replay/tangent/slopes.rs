//! The derivatives of the states through the parts of some steps.

use std::array::from_fn;

use super::super::Reading;
use super::super::decay::Weights;
use super::effects::Effects;
use super::stages::{Jacobians, STAGES};
use crate::model::Lanes;
use crate::vectors::Loops;

/// Position of each stage in its step.
const AT: [f64; STAGES] = [0.0, 0.5, 0.5, 1.0];
/// Weight of each stage.
const WEIGHTS: [f64; STAGES] = [1.0 / 6.0, 1.0 / 3.0, 1.0 / 3.0, 1.0 / 6.0];

/// Advances one block of directions through all parts: its numbers fill a vector, and stay in the cache from part to
/// part.
pub struct Advance<'a> {
    /// The parts, with the Jacobians at their stages.
    pub jacobians: &'a Jacobians,
    /// Weights of all states in the parts in which one decays.
    pub weights: &'a [Weights],
    /// Effects on the states, and the direct ones of this block at each point.
    pub of_states: (&'a Effects, &'a [Lanes]),
    /// What is read.
    pub readings: &'a [Reading],
    /// Effects on the readings, and the direct ones of this block at each part that is read.
    pub of_readings: (&'a Effects, &'a [Lanes]),
    /// Derivatives of the states.
    pub slopes: &'a mut [Lanes],
    /// Workspace: rows of the states at a stage, of those at the end of a part or at another stage, and of the slopes at
    /// the stages.
    pub work: [&'a mut [Lanes]; 6],
    /// Where the derivatives of the readings go, for each part that is read.
    pub read: &'a mut [Lanes],
}

impl Loops for Advance<'_> {
    type Result = ();

    #[inline(always)]
    fn run(mut self) {
        let mut reads = 0;
        for (place, part) in self.jacobians.stages.parts.iter().enumerate() {
            if part.is_read {
                self.read(reads, STAGES * place);
                reads += 1;
            }
            match part.weights {
                None => self.part(STAGES * place, part.length),
                Some(weights) => {
                    let weights = &self.weights[weights..][..self.slopes.len()];
                    self.decaying_part(STAGES * place, weights);
                }
            }
            for slope in &mut *self.slopes {
                *slope = slope.map(without_vanished);
            }
        }
    }
}

impl Advance<'_> {
    #[inline(always)]
    fn read(&mut self, reads: usize, point: usize) {
        let (effects, direct) = self.of_readings;
        let rows = effects.rows();
        let direct = &direct[reads * rows..][..rows];
        let into = &mut self.read[reads * rows..][..rows];
        for (row, (into, reading)) in into.iter_mut().zip(self.readings).enumerate() {
            *into = match *reading {
                Reading::Output(_) => effects.row(row, (self.jacobians, point), self.slopes, &direct[row]),
                Reading::State(state) => self.slopes[state],
            };
        }
    }

    /// Advances by a part of length `h` (s), whose stages begin at the point `first`.
    #[inline(always)]
    fn part(&mut self, first: usize, h: f64) {
        let (effects, direct) = self.of_states;
        let [stage, end, k, ..] = &mut self.work;
        stage.copy_from_slice(self.slopes);
        end.copy_from_slice(self.slopes);
        for (of_step, weight) in WEIGHTS.iter().enumerate() {
            let point = first + of_step;
            let direct = &direct[point * effects.rows()..][..effects.rows()];
            for (row, (direct, k)) in direct.iter().zip(k.iter_mut()).enumerate() {
                *k = effects.row(row, (self.jacobians, point), stage, direct);
                end[row] = sum(&end[row], weight * h, k);
            }
            if let Some(at) = AT.get(of_step + 1) {
                for ((stage, slope), k) in stage.iter_mut().zip(&*self.slopes).zip(&**k) {
                    *stage = sum(slope, at * h, k);
                }
            }
        }
        self.slopes.copy_from_slice(end);
    }

    /// Advances by a part in which states decay, with the weights of all states.
    #[inline(always)]
    fn decaying_part(&mut self, first: usize, weights: &[Weights]) {
        let (effects, direct) = self.of_states;
        let [stage, middle, k @ ..] = &mut self.work;
        stage.copy_from_slice(self.slopes);
        for of_step in 0..STAGES {
            let point = first + of_step;
            let direct = &direct[point * effects.rows()..][..effects.rows()];
            for (row, (direct, own)) in direct.iter().zip(weights).enumerate() {
                let slope = effects.row(row, (self.jacobians, point), stage, direct);
                k[of_step][row] = sum(&slope, -own.rate, &stage[row]);
            }
            for (row, own) in weights.iter().enumerate() {
                let (x, k) = (&self.slopes[row], k.each_ref().map(|k| &k[row]));
                stage[row] = match of_step {
                    0 | 1 => from_fn(|lane| own.middle(x[lane], k[of_step][lane])),
                    2 => from_fn(|lane| own.last(middle[row][lane], k[0][lane], k[2][lane])),
                    _ => from_fn(|lane| own.end(x[lane], k.map(|k| k[lane]))),
                };
            }
            if of_step == 0 {
                middle.copy_from_slice(stage);
            }
        }
        self.slopes.copy_from_slice(stage);
    }
}

/// Derivatives below this size are zero. Those by a state that decays quickly would become subnormal (below 2e-308), and
/// some processors compute with subnormal numbers a hundred times more slowly. A choice: far below any derivative that
/// matters, and products with it are still normal numbers.
const VANISHED: f64 = 1e-250;

#[inline(always)]
fn without_vanished(value: f64) -> f64 {
    if value.abs() < VANISHED { 0.0 } else { value }
}

/// A row and a multiple of another.
#[inline(always)]
fn sum(one: &Lanes, factor: f64, other: &Lanes) -> Lanes {
    from_fn(|lane| one[lane] + factor * other[lane])
}
