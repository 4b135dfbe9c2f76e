//! The method for several systems side by side, with one lane for each: all loops run over the lanes.
//!
//! Each lane gives the same bits as [`ExponentialAdams`], whatever the other lanes do.

use std::array;

use super::{ExponentialAdams, KEPT};
use crate::model::{LANES, Lanes};
use crate::solver::polynomial::{EXTRAPOLATION, PAST};
use crate::vectors::Rows;

/// Integrator of systems whose matrices have the same sparsity.
pub struct ExponentialAbreast<const F: usize> {
    parts: Vec<Part>,
    /// For each force the correction of each state, and its part that is the estimated error.
    whole: [Rows; F],
    last_order: [Rows; F],
    state: Rows,
    /// The states one step before, and true if that step was accepted.
    before: Rows,
    stands: [bool; LANES],
    ahead: Rows,
    /// For each state its absolute tolerance and the excess of its error; for each force the error of its prediction.
    /// They are stored so that loops run over all lanes of all states.
    absolute: Rows,
    excess: Rows,
    off: [Rows; F],
    /// Past values of each force, the last first.
    past: [[Lanes; KEPT]; F],
    /// Number of known past values.
    known: [usize; LANES],
}

/// States that depend on no others, with the forces that drive them.
struct Part {
    states: Vec<usize>,
    forces: Vec<usize>,
    /// The matrix from `from` to the next states.
    propagator: Rows,
    from: Rows,
}

impl<const F: usize> ExponentialAbreast<F> {
    /// An integrator for systems with the sparsity of `one` and the tolerances `absolute`; all lanes are free.
    pub fn like(one: &ExponentialAdams<F>, absolute: &[f64]) -> Self {
        const NOTHING: Lanes = [0.0; LANES];
        let states = || Rows::zero(one.state.len());
        let part = |part: &super::Part| Part {
            states: part.states.clone(),
            forces: part.forces.clone(),
            propagator: Rows::zero(part.states.len() * part.from.len()),
            from: Rows::zero(part.from.len()),
        };
        let mut tolerances = states();
        let rows = tolerances.iter_mut().zip(absolute);
        rows.for_each(|(row, value)| row.fill(*value));
        Self {
            parts: one.parts.iter().map(part).collect(),
            whole: array::from_fn(|_| states()),
            last_order: array::from_fn(|_| states()),
            state: states(),
            before: states(),
            stands: [true; LANES],
            ahead: states(),
            absolute: tolerances,
            excess: states(),
            off: array::from_fn(|_| states()),
            past: [[NOTHING; KEPT]; F],
            known: [0; LANES],
        }
    }

    /// True if a system's matrices have the same sparsity.
    pub fn fits(&self, one: &ExponentialAdams<F>) -> bool {
        let places = self.parts.iter().map(|part| (&part.states, &part.forces));
        places.eq(one.parts.iter().map(|part| (&part.states, &part.forces)))
    }

    /// Takes a system into a lane, in its present state.
    pub fn take(&mut self, lane: usize, one: &ExponentialAdams<F>) {
        let put = |rows: &mut [Lanes], values: &[f64]| {
            rows.iter_mut().zip(values).for_each(|(row, value)| row[lane] = *value);
        };
        for (part, own) in self.parts.iter_mut().zip(&one.parts) {
            put(&mut part.from, &own.from);
            part.propagator.iter_mut().for_each(|entry| entry[lane] = 0.0);
            let (rows, columns) = (part.states.len(), part.from.len());
            let entries = own.propagators[one.doubling].entries();
            for (row, column, value) in entries.filter(|(row, _, _)| *row < rows) {
                part.propagator[row * columns + column][lane] = value;
            }
        }
        let corrections = &one.corrections[one.doubling];
        for force in 0..F {
            put(&mut self.whole[force], &corrections.whole[force]);
            put(&mut self.last_order[force], &corrections.last_order[force]);
            put(&mut self.past[force], &one.past[force]);
        }
        put(&mut self.state, &one.state);
        self.stands[lane] = true;
        self.known[lane] = one.known;
    }

    /// Returns a lane's state and past forces to its system, and frees the lane.
    pub fn give(&mut self, lane: usize, one: &mut ExponentialAdams<F>) {
        let get = |values: &mut [f64], rows: &[Lanes]| {
            values.iter_mut().zip(rows).for_each(|(value, row)| *value = row[lane]);
        };
        get(
            &mut one.state,
            if self.stands[lane] { &self.state } else { &self.before },
        );
        for (past, own) in one.past.iter_mut().zip(&self.past) {
            get(past, own);
        }
        one.known = self.known[lane];
        for (part, own) in self.parts.iter_mut().zip(&mut one.parts) {
            get(&mut own.from, &part.from);
            // An undriven lane would decay to subnormal numbers, which are slow.
            part.from.iter_mut().for_each(|entry| entry[lane] = 0.0);
        }
    }

    /// True if enough past forces of a lane are known for a step of twice the length.
    pub fn may_lengthen(&self, lane: usize) -> bool {
        self.known[lane] == KEPT
    }

    /// Predicts the next states.
    #[inline(always)]
    pub fn predict(&mut self) {
        let states = &mut self.ahead[..];
        for part in &self.parts {
            let factors = part.from.as_chunks::<4>().0;
            let rows = part.propagator.chunks_exact(part.from.len());
            for (row, &place) in rows.zip(&part.states) {
                // Four sums, as in one system alone.
                let mut sums = [[0.0; LANES]; 4];
                for (entries, factors) in row.as_chunks::<4>().0.iter().zip(factors) {
                    for ((sum, entry), factor) in sums.iter_mut().zip(entries).zip(factors) {
                        for lane in 0..LANES {
                            sum[lane] += entry[lane] * factor[lane];
                        }
                    }
                }
                let [first, second, third, fourth] = sums;
                for (lane, ahead) in states[place].iter_mut().enumerate() {
                    *ahead = (first[lane] + second[lane]) + (third[lane] + fourth[lane]);
                }
            }
        }
    }

    /// The predicted next states.
    pub fn ahead(&self) -> &[Lanes] {
        &self.ahead
    }

    /// The states.
    pub fn state(&self) -> &[Lanes] {
        &self.state
    }

    /// Completes the step with the forces at the predicted states, and returns which lanes did. If the error exceeds
    /// `relative` times a state plus the absolute tolerance, the step of the lane is rejected, and the lane must be
    /// given back.
    #[inline(always)]
    pub fn advance(&mut self, force: &[Lanes; F], relative: f64) -> [bool; LANES] {
        for ((rows, force), past) in self.off.iter_mut().zip(force).zip(&self.past) {
            let mut off = *force;
            for lane in 0..LANES {
                let term = |point: usize| EXTRAPOLATION[point] * past[point][lane];
                off[lane] -= (1..PAST).fold(term(0), |sum, point| sum + term(point));
            }
            rows.fill(off);
        }
        self.stands = self.are_within(relative);
        self.go_on(force);
        self.stands
    }

    #[inline(always)]
    fn are_within(&mut self, relative: f64) -> [bool; LANES] {
        let excess = self.excess.as_flattened_mut();
        let n = excess.len();
        let (ahead, absolute) = (&self.ahead.as_flattened()[..n], &self.absolute.as_flattened()[..n]);
        let errors = self.last_order.each_ref().map(|error| &error.as_flattened()[..n]);
        let off = self.off.each_ref().map(|off| &off.as_flattened()[..n]);
        for i in 0..n {
            let error = (0..F).fold(0.0, |sum, f| sum + errors[f][i] * off[f][i]);
            excess[i] = error.abs() - (absolute[i] + relative * ahead[i].abs());
        }
        let mut within = [0.0; LANES];
        for excess in self.excess.iter() {
            for lane in 0..LANES {
                within[lane] += if excess[lane] <= 0.0 { 1.0 } else { 0.0 };
            }
        }
        within.map(|within| within == self.excess.len() as f64)
    }

    #[inline(always)]
    fn go_on(&mut self, force: &[Lanes; F]) {
        std::mem::swap(&mut self.state, &mut self.before);
        let state = self.state.as_flattened_mut();
        let n = state.len();
        let ahead = &self.ahead.as_flattened()[..n];
        let corrections = self.whole.each_ref().map(|correction| &correction.as_flattened()[..n]);
        let off = self.off.each_ref().map(|off| &off.as_flattened()[..n]);
        for i in 0..n {
            state[i] = (0..F).fold(ahead[i], |sum, f| sum + corrections[f][i] * off[f][i]);
        }
        for (past, force) in self.past.iter_mut().zip(force) {
            past.copy_within(..KEPT - 1, 1);
            past[0] = *force;
        }
        self.known = self.known.map(|known| KEPT.min(known + 1));
        for part in &mut self.parts {
            let (states, forces) = part.from.split_at_mut(part.states.len());
            for (from, &place) in states.iter_mut().zip(&part.states) {
                *from = self.ahead[place];
            }
            let places = forces.as_chunks_mut::<{ PAST + 1 }>().0;
            for (places, &force) in places.iter_mut().zip(&part.forces) {
                places[..PAST].copy_from_slice(&self.past[force][..PAST]);
                places[PAST] = self.off[force][0];
            }
        }
    }
}
