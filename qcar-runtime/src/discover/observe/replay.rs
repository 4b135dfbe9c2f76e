//! A model driven by what was recorded, at fixed steps: what its sensors would have recorded.
//!
//! Inputs are known at nodes that are half a step apart, so that the classical Runge-Kutta method never has to guess
//! between them, and the same record costs the same time for every parameter set.

// Recorded inputs at the nodes of an integration.
mod input;

pub use input::{Between, Recorded};

use std::cmp::Ordering;
use std::sync::OnceLock;

use crate::model::{About, Model, Quantity, SignalKind, StateKind};
use crate::response::signal::{SignalError, output_of};
use input::rows;

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
    /// For each fineness that was needed, the inputs at each node.
    nodes: [OnceLock<Vec<Vec<f64>>>; FINER.len()],
}

/// What a replay gives.
pub struct Replayed {
    /// For each reading its samples; not finite from where the model runs away even at the finest steps.
    pub signals: Vec<Vec<f64>>,
    /// All states at each sample.
    states: Vec<Vec<f64>>,
    /// They one sample later than the last.
    end: Vec<f64>,
    /// Place of the fineness that was needed.
    finer: usize,
}

/// Periods until a motion is taken for one that repeats, whether it does or not,
const PERIODS: usize = 60;
/// and by what share of their largest value states may still differ from a period to the next.
const REPEATED: f64 = 1e-9;

/// How many times finer the steps are taken when a replay runs away: laws may be stiffer than any sampling foresees.
const FINER: [usize; 2] = [1, 4];

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
        let last = FINER.len() - 1;
        let replays = (0..last).map(|finer| self.replay(p, begin, finer));
        let is_finite = |signal: &Vec<f64>| signal.last().is_some_and(|last| last.is_finite());
        let mut replays = replays.filter(|replayed| replayed.signals.iter().all(is_finite));
        replays.next().unwrap_or_else(|| self.replay(p, begin, last))
    }

    /// The same beside another replay, and no longer than the two differ: from there on it is that one.
    pub fn beside(&self, other: &Replayed, p: &[f64], begin: &[(usize, f64)]) -> Replayed {
        let rest = vec![0.0; self.model.about().states.len()];
        self.advance(p, (rest, begin), other.finer, Some(other))
    }

    /// From rest, or of a motion that repeats a period of it.
    fn replay(&self, p: &[f64], begin: &[(usize, f64)], finer: usize) -> Replayed {
        let rest = vec![0.0; self.model.about().states.len()];
        let mut replayed = self.advance(p, (rest, begin), finer, None);
        let periods = if self.how.periodic { PERIODS } else { 0 };
        for _ in 0..periods {
            if replayed.repeats() {
                break;
            }
            replayed = self.advance(p, (replayed.end, &[]), finer, None);
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

    /// From a state with some of it elsewhere, as long as it is not that of another replay.
    fn advance(
        &self,
        p: &[f64],
        (mut x, begin): (Vec<f64>, &[(usize, f64)]),
        finer: usize,
        other: Option<&Replayed>,
    ) -> Replayed {
        let steps = steps(self.how.rate) * FINER[finer];
        let inputs = self.nodes[finer].get_or_init(|| self.inputs(steps));
        let about = self.model.about();
        let mut constants = vec![0.0; about.constants];
        self.model.prepare(p, &mut constants);
        let mut restarts = self.restarts.iter().peekable();
        let mut y = vec![0.0; about.outputs.len()];
        let mut stages = Stages::new(x.len());
        let h = 1.0 / (self.how.rate * steps as f64);
        let (mut signals, mut states) = (vec![Vec::new(); self.readings.len()], Vec::new());
        let mut apart = vec![0.0_f64; x.len()];
        for (sample, nodes) in inputs.chunks(2 * steps).enumerate() {
            let first = 2 * steps * sample;
            if let Some((_, seen)) = restarts.next_if(|(at, _)| *at == sample) {
                seen.iter().for_each(|&(state, value)| x[state] = value);
            }
            if sample == 0 {
                begin.iter().for_each(|&(state, by)| x[state] += by);
            }
            if let Some(other) = other.filter(|other| has_joined(&x, &other.states[sample], &mut apart)) {
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
                stages.advance(self.model, &constants, inputs, h, &mut x);
            }
        }
        Replayed {
            signals,
            states,
            end: x,
            finer,
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

/// Steps of at most a millisecond, and at least four a sample, whose band may reach up to half its rate.
fn steps(rate: f64) -> usize {
    const LONGEST: f64 = 1e-3;
    ((1.0 / (rate * LONGEST)).ceil() as usize).max(4)
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
        _ => Err(SignalError::NoOutput {
            location: signal.location.to_string(),
            quantity: "signal as it was measured",
            model: about.name.to_string(),
        }),
    }
}

/// The stages of a step.
struct Stages {
    k: [Vec<f64>; 4],
    x: Vec<f64>,
}

impl Stages {
    fn new(states: usize) -> Self {
        Self {
            k: std::array::from_fn(|_| vec![0.0; states]),
            x: vec![0.0; states],
        }
    }

    /// `inputs` at the start, the middle and the end of the step.
    fn advance(&mut self, model: &dyn Model, constants: &[f64], inputs: [&[f64]; 3], h: f64, x: &mut [f64]) {
        model.derivative(constants, x, inputs[0], &mut self.k[0]);
        for (stage, input, share) in [(1, 1, 0.5), (2, 1, 0.5), (3, 2, 1.0)] {
            for ((to, x), k) in self.x.iter_mut().zip(&*x).zip(&self.k[stage - 1]) {
                *to = x + share * h * k;
            }
            model.derivative(constants, &self.x, inputs[input], &mut self.k[stage]);
        }
        let [k0, k1, k2, k3] = &self.k;
        for (i, x) in x.iter_mut().enumerate() {
            *x += h / 6.0 * (k0[i] + 2.0 * k1[i] + 2.0 * k2[i] + k3[i]);
        }
    }
}
