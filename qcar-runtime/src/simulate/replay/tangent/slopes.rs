//! The derivatives of the states through the parts of some steps.

use super::super::Reading;
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
    /// Effects on the states, and the direct ones of this block at each point.
    pub of_states: (&'a Effects, &'a [Lanes]),
    /// What is read.
    pub readings: &'a [Reading],
    /// Effects on the readings, and the direct ones of this block at each part that is read.
    pub of_readings: (&'a Effects, &'a [Lanes]),
    /// Derivatives of the states.
    pub slopes: &'a mut [Lanes],
    /// Workspace: rows of a stage's states, of its slopes, and of the states at the end of a part.
    pub work: [&'a mut [Lanes]; 3],
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
            self.part(STAGES * place, part.length);
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
        let [stage, k, end] = &mut self.work;
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
        let ends = self.slopes.iter_mut().zip(&**end);
        ends.for_each(|(slope, end)| *slope = end.map(without_vanished));
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
    std::array::from_fn(|lane| one[lane] + factor * other[lane])
}
