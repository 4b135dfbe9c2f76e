//! A model driven by what was recorded: what its sensors would have recorded.
//!
//! Inputs are known at nodes that are half a step apart, so that the classical Runge-Kutta method never has to guess
//! between them; a step is halved where a law is too stiff for it.

// Recorded inputs at the nodes of an integration.
mod input;
// From one of them to the next.
mod stepper;

pub use input::{Between, Recorded};

use std::cmp::Ordering;
use std::sync::OnceLock;

use crate::model::{About, Model, Quantity, SignalKind, StateKind};
use crate::response::signal::{SignalError, missing, output_of};
use input::rows;
use stepper::Stepper;

/// Where a sensor's signal is found while time goes on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reading {
    /// An output.
    Output(usize),
    /// A state.
    State(usize),
}

/// A replay of one record, whatever the parameters.
pub struct Replay<'a> {
    model: &'a dyn Model,
    recorded: Vec<Recorded<'a>>,
    how: Between,
    /// At some samples, in their order: states and what they are then. All others go on, from zero at first.
    restarts: Vec<(usize, Vec<(usize, f64)>)>,
    readings: Vec<Reading>,
    /// The inputs at each node.
    nodes: OnceLock<Vec<Vec<f64>>>,
}

/// What a replay gives.
pub struct Replayed {
    /// For each reading its samples; not finite from where the model runs away even with the shortest steps.
    pub signals: Vec<Vec<f64>>,
    /// All states at each sample.
    states: Vec<Vec<f64>>,
    /// They one sample later than the last.
    end: Vec<f64>,
    /// How often each step was halved.
    halvings: Vec<u8>,
}

/// How long the steps of a replay are.
#[derive(Clone, Copy)]
enum Steps<'r> {
    /// As the laws need it.
    Found,
    /// As those of another replay.
    Like(&'r Replayed),
    /// The same, as long as the two differ.
    Beside(&'r Replayed),
}

/// Periods until a motion is taken for one that repeats, whether it does or not,
const PERIODS: usize = 60;
/// and by what share of their largest value states may still differ from a period to the next.
const REPEATED: f64 = 1e-9;

impl<'a> Replay<'a> {
    /// Prepares a replay; the nodes of `how` are overruled.
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

    /// What follows from the parameters, and where states `begin` elsewhere than they were seen: by so much.
    pub fn run(&self, p: &[f64], begin: &[(usize, f64)]) -> Replayed {
        self.repeated(p, begin, Steps::Found)
    }

    /// The same in the steps of another replay: their difference is that of parameters alone.
    pub fn like(&self, other: &Replayed, p: &[f64], begin: &[(usize, f64)]) -> Replayed {
        self.repeated(p, begin, Steps::Like(other))
    }

    /// The same beside another replay, and no longer than the two differ: from there on it is that one.
    pub fn beside(&self, other: &Replayed, p: &[f64], begin: &[(usize, f64)]) -> Replayed {
        self.advance(p, (self.rest(), begin), Steps::Beside(other))
    }

    fn rest(&self) -> Vec<f64> {
        vec![0.0; self.model.about().states.len()]
    }

    /// From rest, or of a motion that repeats a period of it.
    fn repeated(&self, p: &[f64], begin: &[(usize, f64)], steps: Steps<'_>) -> Replayed {
        let mut replayed = self.advance(p, (self.rest(), begin), steps);
        let periods = if self.how.periodic { PERIODS } else { 0 };
        for _ in 0..periods {
            if replayed.repeats() {
                break;
            }
            replayed = self.advance(p, (replayed.end, &[]), steps);
        }
        replayed
    }

    /// For each node the inputs of the model.
    fn inputs(&self, steps: usize) -> Vec<Vec<f64>> {
        let how = Between {
            nodes: 2 * steps,
            ..self.how
        };
        let rows = rows(self.model.about(), &self.recorded, &how);
        let nodes = rows.first().map_or(0, Vec::len);
        (0..nodes).map(|k| rows.iter().map(|row| row[k]).collect()).collect()
    }

    /// From a state with some of it elsewhere.
    fn advance(&self, p: &[f64], (mut x, begin): (Vec<f64>, &[(usize, f64)]), taken: Steps<'_>) -> Replayed {
        let steps = steps(self.how.rate);
        let inputs = self.nodes.get_or_init(|| self.inputs(steps));
        let about = self.model.about();
        let mut constants = vec![0.0; about.constants];
        self.model.prepare(p, &mut constants);
        let mut restarts = self.restarts.iter().peekable();
        let mut y = vec![0.0; about.outputs.len()];
        let mut stepper = Stepper::new(self.model, &constants, 1.0 / (self.how.rate * steps as f64));
        let mut halvings = Vec::with_capacity(inputs.len() / 2);
        let (mut signals, mut states) = (vec![Vec::new(); self.readings.len()], Vec::new());
        let mut apart = vec![0.0_f64; x.len()];
        for (sample, nodes) in inputs.chunks(2 * steps).enumerate() {
            let first = 2 * steps * sample;
            if let Some((_, seen)) = restarts.next_if(|(at, _)| *at == sample) {
                seen.iter().for_each(|&(state, value)| x[state] = value);
                stepper.forget();
            }
            if sample == 0 {
                begin.iter().for_each(|&(state, by)| x[state] += by);
            }
            if let Steps::Beside(other) = taken
                && has_joined(&x, &other.states[sample], &mut apart)
            {
                let rest = signals.iter_mut().zip(&other.signals);
                rest.for_each(|(signal, other)| signal.extend_from_slice(&other[sample..]));
                break;
            }
            self.model.outputs(&constants, &x, &inputs[first], &mut y);
            for (signal, reading) in signals.iter_mut().zip(&self.readings) {
                signal.push(match *reading {
                    Reading::Output(output) => y[output],
                    Reading::State(state) => x[state],
                });
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
        }
    }

    /// The node at which a step ends; what is held stays until the next sample replaces it.
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
    /// True where it ends as it began, or has no number.
    fn repeats(&self) -> bool {
        let most = |state: usize| self.states.iter().map(|x| x[state].abs()).fold(0.0, f64::max);
        let first = self.states.first().unwrap_or(&self.end);
        let mut ends = self.end.iter().zip(first).enumerate();
        ends.all(|(state, (end, first))| {
            (end - first).abs().partial_cmp(&(REPEATED * most(state))) != Some(Ordering::Greater)
        })
    }
}

/// True where no state is apart from another replay's by more than a trace of the farthest it ever was, which is kept.
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

/// Steps of at most a millisecond, and at least two a sample, whose band may reach up to half its rate: they are halved where
/// that is too long.
fn steps(rate: f64) -> usize {
    const LONGEST: f64 = 1e-3;
    ((1.0 / (rate * LONGEST)).ceil() as usize).max(2)
}

/// Where a sensor's signal is found.
///
/// # Errors
/// Where the model neither outputs it nor has it as a state.
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
