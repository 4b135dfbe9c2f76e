//! A model driven by recorded inputs, and the signals of its sensors.
//!
//! Inputs are known at nodes half a step apart, so that the classical Runge-Kutta method needs no interpolation. A step
//! is halved if a law is too stiff for it.

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
use sets::{Alone, ModelSets, Sets};
use stepper::Stepper;

/// Source of a sensor's signal during integration.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reading {
    /// An output.
    Output(usize),
    /// A state.
    State(usize),
}

/// A replay of one record, for any parameters.
pub struct Replay<'a> {
    model: &'a dyn Model,
    recorded: Vec<Recorded<'a>>,
    how: Between,
    /// Samples at which states are set, in order, with the values of these states. All other states continue, from zero
    /// at the start.
    restarts: Vec<(usize, Vec<(usize, f64)>)>,
    readings: Vec<Reading>,
    /// The inputs at each node.
    nodes: OnceLock<Instants>,
}

/// Result of a replay, with a row for each parameter set.
pub struct Replayed {
    /// Samples of each reading; not finite after the model diverges even with the shortest steps.
    pub signals: Vec<Vec<f64>>,
    /// All states at each sample.
    states: Instants,
    /// All states one sample after the last.
    end: Vec<f64>,
    /// Number of halvings of each step.
    halvings: Vec<u8>,
    /// Number of replays until the motion was periodic.
    periods: usize,
}

/// A row of values for each of many instants, all in one list: there are too many to allocate each.
struct Instants {
    width: usize,
    values: Vec<f64>,
}

impl Instants {
    fn count(&self) -> usize {
        self.values.len().checked_div(self.width).unwrap_or(0)
    }

    fn at(&self, instant: usize) -> &[f64] {
        &self.values[instant * self.width..][..self.width]
    }

    /// The values at one place of all rows.
    fn of(&self, place: usize) -> impl Iterator<Item = f64> {
        self.values.iter().skip(place).step_by(self.width).copied()
    }
}

/// Step lengths of a replay.
#[derive(Clone, Copy)]
enum Steps<'r> {
    /// As the laws need.
    Found,
    /// Those of another replay.
    Like(&'r Replayed),
    /// Those of another replay, until the states of the set agree with its states.
    Beside(&'r Replayed),
}

/// Largest number of periods until a motion counts as periodic.
const PERIODS: usize = 60;
/// Largest relative difference of the states between two periods of a periodic motion.
const REPEATED: f64 = 1e-9;

impl<'a> Replay<'a> {
    /// Prepares a replay of records that are valid for the model ([`replay`] checks them).
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

    /// The signals of a parameter set. `begin` has states with the deviation of their initial value from the measured
    /// one.
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

    /// The signals of each of several parameter sets, with the steps and the number of periods of a replay. A remaining
    /// transient is the same in both, so their difference is due to the parameters alone.
    pub fn like(&self, other: &Replayed, p: &[Vec<f64>], begin: &[(usize, f64)]) -> Vec<Vec<Vec<f64>>> {
        let some = |p: &[Vec<f64>]| match p {
            [one] => vec![self.again(&mut Alone::new(self.model, one), begin, other).signals],
            several => {
                let replayed = self.again(&mut ModelSets::new(self.model, several), begin, other);
                sets::apart(replayed.signals, several.len())
            }
        };
        p.par_chunks(LANES).flat_map_iter(some).collect()
    }

    /// Derivative of each signal by some initial states, each with its step for a difference quotient. A linear model
    /// without resets needs no steps.
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

    /// [`Self::by_initial_states`] of a linear model: the response of each reading to a unit initial state.
    fn free_responses(&self, base: &Replayed, p: &[f64], states: &[(usize, f64)]) -> Vec<Vec<Vec<f64>>> {
        let steps = steps(self.how.rate);
        let free = FreeResponse::new(self.model, p, 1.0 / (self.how.rate * steps as f64));
        let of_reading = |reading: &Reading| free.of(*reading, base.halvings.chunks(steps), states);
        let by_reading: Vec<Vec<Vec<f64>>> = self.readings.par_iter().map(of_reading).collect();
        let of_state = |state: usize| by_reading.iter().map(|rows| rows[state].clone()).collect();
        (0..states.len()).map(of_state).collect()
    }

    /// The signals for other initial states. Once all states agree with those of the replay, its samples are copied.
    fn beside(&self, other: &Replayed, p: &[f64], begin: &[(usize, f64)]) -> Vec<Vec<f64>> {
        let mut alone = Alone::new(self.model, p);
        let from = (self.rest::<Alone<'_>>(), begin);
        self.advance(&mut alone, from, Steps::Beside(other)).signals
    }

    /// With the steps of another replay.
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

    /// The inputs of the model at each node.
    fn inputs(&self, steps: usize) -> Instants {
        let rows = rows(self.model.about(), &self.recorded, &self.how, 2 * steps);
        let nodes = rows.first().map_or(0, Vec::len);
        Instants {
            width: rows.len(),
            values: (0..nodes).flat_map(|k| rows.iter().map(move |row| row[k])).collect(),
        }
    }

    /// Integrates from a state with some changed values.
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
        let count = inputs.count();
        let mut halvings = Vec::with_capacity(count / 2);
        let mut signals = vec![Vec::new(); self.readings.len() * S::LANES];
        let mut states = Vec::with_capacity(x.len() * self.how.samples);
        let mut apart = vec![0.0_f64; x.len()];
        for first in (0..count).step_by(2 * steps) {
            let sample = first / (2 * steps);
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
                && has_joined(&x, other.states.at(sample), &mut apart)
            {
                let rest = signals.iter_mut().zip(&other.signals);
                rest.for_each(|(signal, other)| signal.extend_from_slice(&other[sample..]));
                break;
            }
            stepper.sets.outputs(&x, inputs.at(first), &mut y);
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
            states.extend_from_slice(&x);
            for node in (first..first + 2 * steps).step_by(2) {
                let nodes = [node, node + 1, self.end(node, count)];
                let inputs = nodes.map(|node| inputs.at(node));
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
            states: Instants {
                width: x.len(),
                values: states,
            },
            end: x,
            halvings,
            periods: 1,
        }
    }

    /// The node at which a step ends; a held input keeps its value until the next sample.
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
    /// True if the motion ends as it began, or is not finite.
    fn repeats(&self) -> bool {
        let most = |state: usize| self.states.of(state).map(f64::abs).fold(0.0, f64::max);
        let first = match self.states.count() {
            0 => &self.end,
            _ => self.states.at(0),
        };
        let mut ends = self.end.iter().zip(first).enumerate();
        ends.all(|(state, (end, first))| {
            (end - first).abs().partial_cmp(&(REPEATED * most(state))) != Some(Ordering::Greater)
        })
    }
}

/// True if every state differs from that of another replay by a negligible share of its largest difference so far,
/// which is updated.
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

/// The values of one state or output in all sets.
fn lanes_of<S: Sets>(of: &mut [f64], place: usize) -> &mut [f64] {
    &mut of[place * S::LANES..][..S::LANES]
}

/// Whole steps: at most a millisecond, and at least two per sample, since the band may reach half the rate. They are
/// halved where they are too long.
fn steps(rate: f64) -> usize {
    const LONGEST: f64 = 1e-3;
    ((1.0 / (rate * LONGEST)).ceil() as usize).max(2)
}

/// Drives a model at rest with records, for a value of each parameter. Returns each reading at each sample.
///
/// A motion recorded as velocity or acceleration is integrated without its mean, from height zero. Excitations without
/// a record are zero.
///
/// # Errors
/// Fails if parameters are missing, if records are empty, of unequal length, not finite, or of another kind than their
/// excitation, or if a motion is held between samples.
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

/// Source of a sensor's signal.
///
/// # Errors
/// Fails if the model has it neither as an output nor as a state.
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
