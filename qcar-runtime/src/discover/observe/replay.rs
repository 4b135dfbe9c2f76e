//! A model driven by what was recorded: what its sensors would have recorded.
//!
//! Inputs are known at nodes that are half a step apart, so that the classical Runge-Kutta method never has to guess
//! between them; a step is halved where a law is too stiff for it.

// Recorded inputs at the nodes of an integration.
mod input;
// One parameter set at work, or several side by side.
mod side;
// From one node to the next.
mod stepper;

pub use input::{Between, Recorded};

use std::cmp::Ordering;
use std::sync::OnceLock;

use rayon::prelude::*;

use crate::model::{About, LANES, Model, Quantity, SignalKind, StateKind};
use crate::response::signal::{SignalError, missing, output_of};
use input::rows;
use side::{Alone, Several, Side};
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

/// What a replay gives, of each set that took part: a set is a lane of the rows.
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

/// A parameter set, and where states begin elsewhere than they were seen: by so much.
#[derive(Clone, Debug)]
pub struct Moved {
    /// The values of the parameters.
    pub p: Vec<f64>,
    /// States and by how much.
    pub begin: Vec<(usize, f64)>,
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

    /// What follows from the parameters.
    pub fn run(&self, moved: &Moved) -> Replayed {
        let mut alone = Alone::new(self.model, &moved.p);
        let rest = vec![0.0; self.model.about().states.len()];
        self.repeated(&mut alone, rest, &moved.begin, Steps::Found)
    }

    /// The signals of other parameters in the steps of a replay: their difference is that of parameters alone.
    pub fn like(&self, other: &Replayed, moved: &[Moved]) -> Vec<Vec<Vec<f64>>> {
        self.together(moved, Steps::Like(other))
    }

    /// The signals of other beginnings beside a replay, and no longer than they differ from it: from there on they are its own.
    pub fn beside(&self, other: &Replayed, moved: &[Moved]) -> Vec<Vec<Vec<f64>>> {
        self.together(moved, Steps::Beside(other))
    }

    /// As many sets at once as there are lanes.
    fn together(&self, moved: &[Moved], steps: Steps<'_>) -> Vec<Vec<Vec<f64>>> {
        let some = |moved: &[Moved]| match moved {
            [one] => {
                let mut alone = Alone::new(self.model, &one.p);
                vec![self.other(&mut alone, &one.begin, steps).signals]
            }
            several => {
                let mut lanes = Several::new(self.model, several);
                let replayed = self.other(&mut lanes, &side::begin(several), steps);
                side::apart(replayed.signals, several.len())
            }
        };
        moved.par_chunks(LANES).flat_map_iter(some).collect()
    }

    /// In the steps of another replay: from its beginning, which is near the one of a motion that repeats.
    fn other<S: Side>(&self, side: &mut S, begin: &[(usize, f64)], steps: Steps<'_>) -> Replayed {
        let first = match steps {
            Steps::Like(other) if self.how.periodic => other.states[0].clone(),
            _ => vec![0.0; self.model.about().states.len()],
        };
        let first = first.iter().flat_map(|&x| std::iter::repeat_n(x, S::LANES)).collect();
        match steps {
            Steps::Beside(_) => self.advance(side, (first, begin), steps),
            _ => self.repeated(side, first, begin, steps),
        }
    }

    /// From a state, or of a motion that repeats a period of it.
    fn repeated<S: Side>(&self, side: &mut S, from: Vec<f64>, begin: &[(usize, f64)], steps: Steps<'_>) -> Replayed {
        let mut replayed = self.advance(side, (from, begin), steps);
        let periods = if self.how.periodic { PERIODS } else { 0 };
        for _ in 0..periods {
            if replayed.repeats() {
                break;
            }
            replayed = self.advance(side, (replayed.end, &[]), steps);
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
    fn advance<S: Side>(
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
                begin.iter().for_each(|&(place, by)| x[place] += by);
            }
            if let Steps::Beside(other) = taken
                && has_joined::<S>(&x, &other.states[sample], &mut apart)
            {
                let rest = signals.chunks_exact_mut(S::LANES).zip(&other.signals);
                rest.flat_map(|(lanes, other)| lanes.iter_mut().map(move |signal| (signal, other)))
                    .for_each(|(signal, other)| signal.extend_from_slice(&other[sample..]));
                break;
            }
            stepper.side.outputs(&x, &inputs[first], &mut y);
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
fn has_joined<S: Side>(x: &[f64], other: &[f64], apart: &mut [f64]) -> bool {
    const TRACE: f64 = 1e-4;
    let mut joined = true;
    for (place, (x, apart)) in x.iter().zip(apart).enumerate() {
        let difference = (x - other[place / S::LANES]).abs();
        *apart = apart.max(difference);
        joined &= difference <= TRACE * *apart;
    }
    joined
}

/// The values of one state or output of all sets.
fn lanes_of<S: Side>(of: &mut [f64], place: usize) -> &mut [f64] {
    &mut of[place * S::LANES..][..S::LANES]
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
