//! The method for several systems abreast, a lane each: all loops run over the lanes.
//!
//! Each lane has the bits of [`ExponentialAdams`], whatever the others do.

use std::array;

use super::{ExponentialAdams, KEPT};
use crate::model::{LANES, Lanes};
use crate::solver::polynomial::{EXTRAPOLATION, PAST};

/// The integrator of systems whose states and forces depend on each other in the same places.
pub struct ExponentialAbreast<const F: usize> {
    parts: Vec<Part>,
    /// For each force how each state is corrected, and how much of that is the error that is judged.
    whole: [Vec<Lanes>; F],
    last_order: [Vec<Lanes>; F],
    state: Vec<Lanes>,
    ahead: Vec<Lanes>,
    /// Each force at the points of the past, the last first.
    past: [[Lanes; KEPT]; F],
    /// At so many points they are known.
    known: [usize; LANES],
}

/// States that do not depend on any others, and the forces that drive them.
struct Part {
    states: Vec<usize>,
    forces: Vec<usize>,
    /// For each state what its next value is of each entry of `from`.
    propagator: Vec<Lanes>,
    from: Vec<Lanes>,
}

impl<const F: usize> ExponentialAbreast<F> {
    /// With room for systems like this one; all lanes are free.
    pub fn like(one: &ExponentialAdams<F>) -> Self {
        const NOTHING: Lanes = [0.0; LANES];
        let states = || vec![NOTHING; one.state.len()];
        let part = |part: &super::Part| Part {
            states: part.states.clone(),
            forces: part.forces.clone(),
            propagator: vec![NOTHING; part.states.len() * part.from.len()],
            from: vec![NOTHING; part.from.len()],
        };
        Self {
            parts: one.parts.iter().map(part).collect(),
            whole: array::from_fn(|_| states()),
            last_order: array::from_fn(|_| states()),
            state: states(),
            ahead: states(),
            past: [[NOTHING; KEPT]; F],
            known: [0; LANES],
        }
    }

    /// True where a system has its states and forces in the same places.
    pub fn fits(&self, one: &ExponentialAdams<F>) -> bool {
        let places = self.parts.iter().map(|part| (&part.states, &part.forces));
        places.eq(one.parts.iter().map(|part| (&part.states, &part.forces)))
    }

    /// Goes on in a lane from where a system is.
    pub fn take(&mut self, lane: usize, one: &ExponentialAdams<F>) {
        let put = |rows: &mut [Lanes], values: &[f64]| {
            rows.iter_mut().zip(values).for_each(|(row, value)| row[lane] = *value);
        };
        for (part, own) in self.parts.iter_mut().zip(&one.parts) {
            let (columns, blocks) = (part.from.len(), &own.propagators[one.rung]);
            put(&mut part.from, &own.from);
            for (row, entries) in part.propagator.chunks_exact_mut(columns).enumerate() {
                let block = &blocks[row / 4 * columns..][..columns];
                let column = entries.iter_mut().zip(block);
                column.for_each(|(entry, rows)| entry[lane] = rows[row % 4]);
            }
        }
        let corrections = &one.corrections[one.rung];
        for force in 0..F {
            put(&mut self.whole[force], &corrections.whole[force]);
            put(&mut self.last_order[force], &corrections.last_order[force]);
            put(&mut self.past[force], &one.past[force]);
        }
        put(&mut self.state, &one.state);
        self.known[lane] = one.known;
    }

    /// Gives a lane back to its system: where it is, and what forces were there before. The lane is free.
    pub fn give(&mut self, lane: usize, one: &mut ExponentialAdams<F>) {
        let get = |values: &mut [f64], rows: &[Lanes]| {
            values.iter_mut().zip(rows).for_each(|(value, row)| *value = row[lane]);
        };
        get(&mut one.state, &self.state);
        for (past, own) in one.past.iter_mut().zip(&self.past) {
            get(past, own);
        }
        one.known = self.known[lane];
        for (part, own) in self.parts.iter_mut().zip(&mut one.parts) {
            get(&mut own.from, &part.from);
            // What nobody drives any more would decay to numbers that are slow to compute with.
            part.from.iter_mut().for_each(|entry| entry[lane] = 0.0);
        }
    }

    /// True where enough of the past is known in a lane for a step of twice the length.
    pub fn may_lengthen(&self, lane: usize) -> bool {
        self.known[lane] == KEPT
    }

    /// Foresees the next states.
    #[inline(always)]
    pub fn foresee(&mut self) {
        for part in &self.parts {
            let factors = part.from.as_chunks::<4>().0;
            let rows = part.propagator.chunks_exact(part.from.len());
            for (row, &place) in rows.zip(&part.states) {
                // Four sums, as in one system alone.
                let mut sums = [[0.0; LANES]; 4];
                for (entries, factors) in row.as_chunks::<4>().0.iter().zip(factors) {
                    for k in 0..4 {
                        for lane in 0..LANES {
                            sums[k][lane] += entries[k][lane] * factors[k][lane];
                        }
                    }
                }
                for lane in 0..LANES {
                    self.ahead[place][lane] = (sums[0][lane] + sums[1][lane]) + (sums[2][lane] + sums[3][lane]);
                }
            }
        }
    }

    /// The next states, as they are foreseen.
    pub fn ahead(&self) -> &[Lanes] {
        &self.ahead
    }

    /// The states.
    pub fn state(&self) -> &[Lanes] {
        &self.state
    }

    /// Steps to where the states were foreseen, with the forces as they are there, and says which lanes did: where the error
    /// is more than `relative` of a state and `absolute`, the state stays as it was.
    #[inline(always)]
    pub fn advance(&mut self, force: &[Lanes; F], relative: f64, absolute: &[f64]) -> [bool; LANES] {
        let mut off = *force;
        for (off, past) in off.iter_mut().zip(&self.past) {
            for lane in 0..LANES {
                let term = |point: usize| EXTRAPOLATION[point] * past[point][lane];
                off[lane] -= (1..PAST).fold(term(0), |sum, point| sum + term(point));
            }
        }
        let good = self.are_within(&off, relative, absolute);
        self.go_on(force, &off, &good);
        good
    }

    #[inline(always)]
    fn are_within(&self, off: &[Lanes; F], relative: f64, absolute: &[f64]) -> [bool; LANES] {
        let n = self.state.len();
        let (ahead, absolute) = (&self.ahead[..n], &absolute[..n]);
        let errors = self.last_order.each_ref().map(|error| &error[..n]);
        let mut within = [0.0; LANES];
        for i in 0..n {
            for lane in 0..LANES {
                let error = (0..F).fold(0.0, |sum, f| sum + errors[f][i][lane] * off[f][lane]);
                let excess = error.abs() - (absolute[i] + relative * ahead[i][lane].abs());
                within[lane] += if excess <= 0.0 { 1.0 } else { 0.0 };
            }
        }
        within.map(|within| within == n as f64)
    }

    #[inline(always)]
    fn go_on(&mut self, force: &[Lanes; F], off: &[Lanes; F], good: &[bool; LANES]) {
        let n = self.state.len();
        let (ahead, state) = (&self.ahead[..n], &mut self.state[..n]);
        let corrections = self.whole.each_ref().map(|correction| &correction[..n]);
        for i in 0..n {
            for lane in 0..LANES {
                let next = (0..F).fold(ahead[i][lane], |sum, f| sum + corrections[f][i][lane] * off[f][lane]);
                state[i][lane] = if good[lane] { next } else { state[i][lane] };
            }
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
                places[PAST] = off[force];
            }
        }
    }
}
