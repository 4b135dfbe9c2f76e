//! Replays recorded inputs through a model and gives what its sensors would have recorded.
//!
//! Inputs are known at nodes half a step apart, so the classical Runge-Kutta method never interpolates. A step is
//! halved where a law is too stiff for it.

// Recorded inputs at the integration nodes.
mod input;
// A model with one or several parameter sets.
mod sets;
// Runge-Kutta steps with error control.
mod stepper;

pub use input::{Between, Recorded};

use std::cmp::Ordering;
use std::sync::OnceLock;

use rayon::prelude::*;

use crate::model::{About, LANES, Model, Quantity, SignalKind, StateKind};
use crate::response::signal::{SignalError, missing, output_of};
use input::rows;
use sets::{Alone, Sets, Several};
use stepper::Stepper;

/// Source of a sensor's signal in the simulation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reading {
    /// Output of the model, by position.
    Output(usize),
    /// State of the model, by position.
    State(usize),
}

/// Replay of one record, for any parameters.
pub struct Replay<'a> {
    model: &'a dyn Model,
    recorded: Vec<Recorded<'a>>,
    how: Between,
    /// States and values set at some samples, in order of the samples. All states start at zero, and states that are
    /// not set continue.
    restarts: Vec<(usize, Vec<(usize, f64)>)>,
    readings: Vec<Reading>,
    /// Inputs at each node.
    nodes: OnceLock<Vec<Vec<f64>>>,
}

/// Result of a replay, with one row for each parameter set.
pub struct Replayed {
    /// Samples of each reading; not finite once the model diverges even with the shortest steps.
    pub signals: Vec<Vec<f64>>,
    /// All states at each sample.
    states: Vec<Vec<f64>>,
    /// All states one sample after the last.
    end: Vec<f64>,
    /// Number of halvings of each step.
    halvings: Vec<u8>,
    /// Number of replays of the record until the motion repeated.
    periods: usize,
}

/// Step lengths of a replay.
#[derive(Clone, Copy)]
enum Steps<'r> {
    /// As error control requires.
    Found,
    /// As in another replay.
    Like(&'r Replayed),
    /// As in another replay, until its states agree with the own states.
    Beside(&'r Replayed),
}

/// Number of periods after which a motion counts as periodic even if it does not repeat.
const PERIODS: usize = 60;
/// Largest change of a state from period to period that counts as a repetition, relative to its largest value.
const REPEATED: f64 = 1e-9;

impl<'a> Replay<'a> {
    /// Prepares a replay. `how.nodes` is ignored.
    pub fn new(
        model: &'a dyn Model,
        recorded: Vec<Recorded<'a>>,
        how: Between,
        restarts: Vec<(usize, Vec<(usize, f64)>)>,
        readings: Vec<Reading>,
    ) -> Self {
        Self {
            model,
            recorded,
            how,
            restarts,
            readings,
            nodes: Default::default(),
        }
    }

    /// Replays with the parameters `p`. `begin` adds values to initial states, by position.
    pub fn run(&self, p: &[f64], begin: &[(usize, f64)]) -> Replayed {
        let mut alone = Alone::new(self.model, p);
        let mut replayed = self.advance(&mut alone, (self.rest::<Alone<'_>>(), begin), Steps::Found);
        let most = if self.how.periodic { PERIODS } else { 0 };
        while replayed.periods <= most && !replayed.repeats() {
            let periods = replayed.periods + 1;
            replayed = self.advance(&mut alone, (replayed.end, &[]), Steps::Found);
            replayed.periods = periods;
        }
        replayed
    }

    /// Signals for several parameter sets, with the steps and the number of periods of another replay. Transients are
    /// then equal in both, so the difference is due to the parameters alone.
    pub fn like(&self, other: &Replayed, p: &[Vec<f64>], begin: &[(usize, f64)]) -> Vec<Vec<Vec<f64>>> {
        let some = |p: &[Vec<f64>]| match p {
            [one] => vec![self.again(&mut Alone::new(self.model, one), begin, other).signals],
            several => {
                let replayed = self.again(&mut Several::new(self.model, several), begin, other);
                sets::apart(replayed.signals, several.len())
            }
        };
        p.par_chunks(LANES).flat_map_iter(some).collect()
    }

    /// Signals for other initial states. Once all states agree with those of the other replay, its samples are copied.
    pub fn beside(&self, other: &Replayed, p: &[f64], begin: &[(usize, f64)]) -> Vec<Vec<f64>> {
        let mut alone = Alone::new(self.model, p);
        let from = (self.rest::<Alone<'_>>(), begin);
        self.advance(&mut alone, from, Steps::Beside(other)).signals
    }

    /// Replays with the steps of another replay.
    fn again<S: Sets>(&self, sets: &mut S, begin: &[(usize, f64)], other: &Replayed) -> Replayed {
        let mut replayed = self.advance(sets, (self.rest::<S>(), begin), Steps::Like(other));
        for _ in 1..other.periods {
            replayed = self.advance(sets, (replayed.end, &[]), Steps::Like(other));
        }
        replayed
    }

    fn rest<S: Sets>(&self) -> Vec<f64> {
        vec![0.0; self.model.about().states.len() * S::LANES]
    }

    /// Inputs of the model at each node.
    fn inputs(&self, steps: usize) -> Vec<Vec<f64>> {
        let how = Between {
            nodes: 2 * steps,
            ..self.how
        };
        let rows = rows(self.model.about(), &self.recorded, &how);
        let nodes = rows.first().map_or(0, Vec::len);
        (0..nodes).map(|k| rows.iter().map(|row| row[k]).collect()).collect()
    }

    /// Replays the record once from the states `x`, to which `begin` is added.
    fn advance<S: Sets>(
        &self,
        side: &mut S,
        (mut x, begin): (Vec<f64>, &[(usize, f64)]),
        taken: Steps<'_>,
    ) -> Replayed {
        let steps = steps(self.how.rate);
        let inputs = self.nodes.get_or_init(|| self.inputs(steps));
        let about = self.model.about();
        let mut restarts = self.restarts.iter().peekable();
        let mut y = vec![0.0; about.outputs.len() * S::LANES];
        let mut stepper = Stepper::new(
            side,
            (x.len(), about.inputs.len()),
            1.0 / (self.how.rate * steps as f64),
        );
        let mut halvings = Vec::with_capacity(inputs.len() / 2);
        let (mut signals, mut states) = (vec![Vec::new(); self.readings.len() * S::LANES], Vec::new());
        let mut apart = vec![0.0_f64; x.len()];
        for (sample, nodes) in inputs.chunks(2 * steps).enumerate() {
            let first = 2 * steps * sample;
            if let Some((_, seen)) = restarts.next_if(|(at, _)| *at == sample) {
                seen.iter()
                    .for_each(|&(state, value)| lanes_of::<S>(&mut x, state).fill(value));
                stepper.forget();
            }
            if sample == 0 {
                for &(state, by) in begin {
                    lanes_of::<S>(&mut x, state).iter_mut().for_each(|x| *x += by);
                }
            }
            if let Steps::Beside(other) = taken
                && has_joined(&x, &other.states[sample], &mut apart)
            {
                let rest = signals.iter_mut().zip(&other.signals);
                rest.for_each(|(signal, other)| signal.extend_from_slice(&other[sample..]));
                break;
            }
            stepper.sets.outputs(&x, &inputs[first], &mut y);
            for (signals, reading) in signals.chunks_exact_mut(S::LANES).zip(&self.readings) {
                let read = match *reading {
                    Reading::Output(output) => lanes_of::<S>(&mut y, output),
                    Reading::State(state) => lanes_of::<S>(&mut x, state),
                };
                signals
                    .iter_mut()
                    .zip(read)
                    .for_each(|(signal, read)| signal.push(*read));
            }
            states.push(x.clone());
            for node in (first..first + nodes.len()).step_by(2) {
                let nodes = [node, node + 1, self.end(node, inputs.len())];
                let inputs = nodes.map(|node| inputs[node].as_slice());
                halvings.push(match taken {
                    Steps::Found => stepper.find(inputs, &mut x),
                    Steps::Like(other) | Steps::Beside(other) => {
                        let known = other.halvings[halvings.len()];
                        stepper.follow(inputs, known, &mut x);
                        known
                    }
                });
            }
        }
        Replayed {
            signals,
            states,
            end: x,
            halvings,
            periods: 1,
        }
    }

    /// Node at which a step ends. Held inputs keep their value until the next sample replaces it.
    fn end(&self, node: usize, count: usize) -> usize {
        if self.how.band_limited && self.how.periodic {
            (node + 2) % count
        } else if self.how.band_limited {
            (node + 2).min(count - 1)
        } else {
            node + 1
        }
    }
}

impl Replayed {
    /// True if the record ends in its initial states, or is not finite.
    fn repeats(&self) -> bool {
        let most = |state: usize| self.states.iter().map(|x| x[state].abs()).fold(0.0, f64::max);
        let first = self.states.first().unwrap_or(&self.end);
        let mut ends = self.end.iter().zip(first).enumerate();
        ends.all(|(state, (end, first))| {
            (end - first).abs().partial_cmp(&(REPEATED * most(state))) != Some(Ordering::Greater)
        })
    }
}

/// True if every state differs from that of another replay by no more than a trace of its largest difference so far,
/// which `apart` holds.
fn has_joined(x: &[f64], other: &[f64], apart: &mut [f64]) -> bool {
    const TRACE: f64 = 1e-4;
    let mut joined = true;
    for ((x, other), apart) in x.iter().zip(other).zip(apart) {
        let difference = (x - other).abs();
        *apart = apart.max(difference);
        joined &= difference <= TRACE * *apart;
    }
    joined
}

/// Values of one state or output in all sets.
fn lanes_of<S: Sets>(of: &mut [f64], place: usize) -> &mut [f64] {
    &mut of[place * S::LANES..][..S::LANES]
}

/// Steps of a sample: each at most a millisecond, and at least two, since the band may reach half the sample rate.
/// Error control halves them where needed.
fn steps(rate: f64) -> usize {
    const LONGEST: f64 = 1e-3;
    ((1.0 / (rate * LONGEST)).ceil() as usize).max(2)
}

/// Finds the source of a sensor's signal.
///
/// # Errors
/// Fails if the model has neither an output nor a state for it.
pub fn reading(about: &About, signal: &crate::model::Signal) -> Result<Reading, SignalError> {
    let state_kind = match signal.kind {
        SignalKind::Motion(Quantity::Position) => Some(StateKind::Position),
        SignalKind::Motion(Quantity::Velocity) => Some(StateKind::Velocity),
        _ => None,
    };
    let here = |state: &crate::model::State| {
        Some(state.kind) == state_kind && state.location == signal.location && state.axis == signal.axis
    };
    if let Some(state) = about.states.iter().position(here) {
        return Ok(Reading::State(state));
    }
    match output_of(about, signal)? {
        (output, 0) => Ok(Reading::Output(output)),
        _ => Err(missing(about, signal)),
    }
}
