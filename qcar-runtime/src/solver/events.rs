//! Detects events: changes of sign over a step, located on its dense output.

use super::{After, Effort, Event, Step, System};

/// Distance into the first step of a leg at which the signs are read, relative to the step.
pub(super) const LOOK_AHEAD: f64 = 1e-3;

/// Current sign of each event function, with buffers.
pub(super) struct Watch {
    positive: Vec<bool>,
    values: Vec<f64>,
    at_end: Vec<f64>,
    /// The state at the crossing found last.
    pub state: Vec<f64>,
}

/// A change of sign.
#[derive(Clone, Copy)]
pub(super) struct Crossing {
    pub index: usize,
    pub time: f64,
    rising: bool,
}

impl Watch {
    pub fn new(states: usize, events: usize) -> Self {
        Self {
            positive: vec![true; events],
            values: vec![0.0; events],
            at_end: vec![0.0; events],
            state: vec![0.0; states],
        }
    }

    /// Reads the signs at the beginning of a leg.
    ///
    /// A function whose event began the leg is zero to rounding there, and its sign has no meaning. So the signs are
    /// read a short time `ahead` along the slope.
    pub fn begin<S: System>(&mut self, system: &mut S, t: f64, ahead: f64, x: &[f64], slope: &[f64]) {
        if self.positive.is_empty() {
            return;
        }
        for ((state, x), slope) in self.state.iter_mut().zip(x).zip(slope) {
            *state = x + ahead * slope;
        }
        system.event_values(t + ahead, &self.state, &mut self.values);
        for (positive, value) in self.positive.iter_mut().zip(&self.values) {
            *positive = *value >= 0.0;
        }
    }

    /// Reports the events of a step to the system in the order of time, up to the first that ends the step.
    pub fn first_cut<S: System>(
        &mut self,
        system: &mut S,
        step: &Step<'_>,
        effort: &mut Effort,
    ) -> Option<(After, Crossing)> {
        if self.positive.is_empty() {
            return None;
        }
        system.event_values(step.end, step.states[1], &mut self.at_end);
        while let Some(crossing) = self.next(system, step) {
            let Crossing { index, time, rising } = crossing;
            effort.events += 1;
            let after = system.happen(&Event {
                index,
                time,
                rising,
                state: &self.state,
            });
            if after != After::Continue {
                return Some((after, crossing));
            }
        }
        None
    }

    /// The earliest change of sign that was not reported yet; `state` becomes the state there.
    fn next<S: System>(&mut self, system: &mut S, step: &Step<'_>) -> Option<Crossing> {
        let mut first: Option<Crossing> = None;
        for index in 0..self.positive.len() {
            let rising = self.at_end[index] >= 0.0;
            if rising != self.positive[index] {
                let time = self.locate(system, step, index, rising);
                if first.is_none_or(|f| time < f.time) {
                    first = Some(Crossing { index, time, rising });
                }
            }
        }
        let crossing = first?;
        self.positive[crossing.index] = crossing.rising;
        step.at(crossing.time, &mut self.state);
        Some(crossing)
    }

    /// The first time with the new sign, by bisection, which is safe for any shape of the function.
    fn locate<S: System>(&mut self, system: &mut S, step: &Step<'_>, index: usize, rising: bool) -> f64 {
        let (mut before, mut after) = (step.start, step.end);
        loop {
            let middle = 0.5 * (before + after);
            if middle <= before || middle >= after {
                return after;
            }
            step.at(middle, &mut self.state);
            system.event_values(middle, &self.state, &mut self.values);
            if (self.values[index] >= 0.0) == rising {
                after = middle;
            } else {
                before = middle;
            }
        }
    }
}
