//! A model driven by what was recorded: what its sensors would have recorded.
//!
//! Inputs are known at nodes that are half a step apart, so that the classical Runge-Kutta method never has to guess
//! between them; a step is halved where a law is too stiff for it.

// Recorded inputs at the nodes of an integration.
mod input;
// How the readings of a linear model depend on its initial states.
mod initial;
// A model with one parameter set, or with eight.
mod sets;
// Steps of the Runge-Kutta method, with step control.
mod stepper;

pub use input::{Between, Recorded};

use std::cmp::Ordering;
use std::sync::OnceLock;

use rayon::prelude::*;

use super::failure::{SimulateError, positive};
use crate::model::{About, LANES, Model, Quantity, SignalKind, StateKind};
use crate::response::signal::{SignalError, missing, output_of};
use initial::FreeResponse;
use input::rows;
use sets::{Alone, Sets, Several};
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

/// What a replay gives: a row for each set of parameters that took part.
pub struct Replayed {
    /// For each reading its samples; not finite from where the model runs away even with the shortest steps.
    pub signals: Vec<Vec<f64>>,
    /// All states at each sample.
    states: Vec<Vec<f64>>,
    /// They one sample later than the last.
    end: Vec<f64>,
    /// How often each step was halved.
    halvings: Vec<u8>,
    /// How often the record was replayed until the motion repeated.
    periods: usize,
}

/// How long the steps of a replay are.
#[derive(Clone, Copy)]
enum Steps<'r> {
    /// As the laws need it.
    Found,
    /// As those of another replay.
    Like(&'r Replayed),
    /// As those of another replay, until the states of the one set agree with its own.
    Beside(&'r Replayed),
}

/// Periods until a motion is taken for one that repeats, whether it does or not,
const PERIODS: usize = 60;
/// and by what share of their largest value states may still differ from a period to the next.
const REPEATED: f64 = 1e-9;

impl<'a> Replay<'a> {
    /// Prepares a replay of records that suit the model ([`replay`] checks them).
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

    /// The signals of each of several parameter sets, in the steps of a replay and for as many periods: what has not settled is
    /// the same in both, so that their difference is that of the parameters alone.
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

    /// The derivative of each signal by some initial states, each of which comes with its step for a difference quotient. A linear
    /// model whose states run freely needs none.
    pub fn by_initial_states(
        &self,
        base: &Replayed,
        p: &[f64],
        begin: &[(usize, f64)],
        states: &[(usize, f64)],
    ) -> Vec<Vec<Vec<f64>>> {
        let runs_freely = self.restarts.iter().all(|(sample, _)| *sample == 0);
        if self.model.about().linear && runs_freely {
            return self.free_responses(base, p, states);
        }
        let quotient = |&(state, step): &(usize, f64)| {
            let begin: Vec<_> = begin.iter().copied().chain([(state, step)]).collect();
            let moved = self.beside(base, p, &begin);
            let of_signal = |(moved, signal): (&Vec<f64>, &Vec<f64>)| {
                let samples = moved.iter().zip(signal);
                samples.map(|(moved, value)| (moved - value) / step).collect()
            };
            moved.iter().zip(&base.signals).map(of_signal).collect()
        };
        states.par_iter().map(quotient).collect()
    }

    /// [`Self::by_initial_states`] of a linear model: each reading's response to a state that begins at one.
    fn free_responses(&self, base: &Replayed, p: &[f64], states: &[(usize, f64)]) -> Vec<Vec<Vec<f64>>> {
        let steps = steps(self.how.rate);
        let free = FreeResponse::new(self.model, p, 1.0 / (self.how.rate * steps as f64));
        let of_reading = |reading: &Reading| free.of(*reading, base.halvings.chunks(steps), states);
        let by_reading: Vec<Vec<Vec<f64>>> = self.readings.par_iter().map(of_reading).collect();
        let of_state = |state: usize| by_reading.iter().map(|rows| rows[state].clone()).collect();
        (0..states.len()).map(of_state).collect()
    }

    /// The signals of other initial states. Once all states agree with those of the replay, its samples are copied.
    fn beside(&self, other: &Replayed, p: &[f64], begin: &[(usize, f64)]) -> Vec<Vec<f64>> {
        let mut alone = Alone::new(self.model, p);
        let from = (self.rest::<Alone<'_>>(), begin);
        self.advance(&mut alone, from, Steps::Beside(other)).signals
    }

    /// In the steps of another replay.
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

    /// For each node the inputs of the model.
    fn inputs(&self, steps: usize) -> Vec<Vec<f64>> {
        let rows = rows(self.model.about(), &self.recorded, &self.how, 2 * steps);
        let nodes = rows.first().map_or(0, Vec::len);
        (0..nodes).map(|k| rows.iter().map(|row| row[k]).collect()).collect()
    }

    /// From a state with some of it elsewhere.
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

/// The values of one state or output of all sets.
fn lanes_of<S: Sets>(of: &mut [f64], place: usize) -> &mut [f64] {
    &mut of[place * S::LANES..][..S::LANES]
}

/// Steps of at most a millisecond, and at least two a sample, whose band may reach up to half its rate: they are halved where
/// that is too long.
fn steps(rate: f64) -> usize {
    const LONGEST: f64 = 1e-3;
    ((1.0 / (rate * LONGEST)).ceil() as usize).max(2)
}

/// Drives a model, with a value for each of its parameters, by records from rest. Returns each reading at each sample.
///
/// A motion that was recorded as a velocity or acceleration is integrated without its mean, from height zero on. What was not
/// recorded rests at zero.
///
/// # Errors
/// Too few parameters, and records that are empty, of unlike length, not finite, or of another kind than their excitation; a
/// motion that is held.
pub fn replay(
    model: &dyn Model,
    p: &[f64],
    recorded: Vec<Recorded<'_>>,
    how: Between,
    readings: Vec<Reading>,
) -> Result<Vec<Vec<f64>>, SimulateError> {
    let about = model.about();
    positive("the sample rate", how.rate, "Hz")?;
    positive("the number of samples", how.samples as f64, "")?;
    counted("the parameter set", p.len(), about.parameters.len())?;
    recorded.iter().try_for_each(|recorded| check(about, recorded, &how))?;
    Ok(Replay::new(model, recorded, how, Vec::new(), readings)
        .run(p, &[])
        .signals)
}

fn check(about: &About, recorded: &Recorded<'_>, how: &Between) -> Result<(), SimulateError> {
    let Some(excitation) = about.excitations.get(recorded.excitation) else {
        return Err(SimulateError::NoSuchExcitation {
            model: about.name.to_string(),
            excitation: recorded.excitation,
            count: about.excitations.len(),
        });
    };
    let name = || excitation.name.to_string();
    if excitation.force && recorded.power != 0 {
        return Err(SimulateError::ForceByMotion { name: name() });
    }
    if !excitation.force && !how.band_limited {
        return Err(SimulateError::HeldMotion { name: name() });
    }
    counted("a record", recorded.samples.len(), how.samples)?;
    match recorded.samples.iter().position(|value| !value.is_finite()) {
        None => Ok(()),
        Some(sample) => Err(SimulateError::NotFinite {
            name: name(),
            sample,
            value: recorded.samples[sample],
        }),
    }
}

fn counted(name: &'static str, found: usize, expected: usize) -> Result<(), SimulateError> {
    if found == expected {
        Ok(())
    } else {
        Err(SimulateError::Count { name, found, expected })
    }
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
