//! A model driven by recorded inputs, and the signals of its sensors.
//!
//! Inputs are known at nodes half a step apart, so that the classical Runge-Kutta method needs no interpolation. A step
//! is halved if a law is too stiff for it.

// Error and halvings of a step.
mod accuracy;
// Recorded inputs at the nodes of an integration.
mod input;
// States that move along where a record restarts.
mod carried;
// States that decay within a step.
mod decay;
// Steps of the Runge-Kutta method, with step control.
mod stepper;
// How the readings of a linear model depend on its initial states.
mod initial;
// Derivatives of the signals, integrated with the motion.
mod tangent;

pub use accuracy::Accuracy;
pub use input::{Between, Recorded};
pub use tangent::Direction;

use std::cmp::Ordering;
use std::sync::OnceLock;

use rayon::prelude::*;

use super::failure::{SimulateError, positive};
use crate::model::{About, Model, Quantity, SignalKind, StateKind};
use crate::response::signal::{SignalError, missing, output_of};
use carried::Carried;
use initial::FreeResponse;
use input::rows;
use stepper::{Stepper, Taken};
use tangent::{Step, Tangent};

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

/// Deviation of a state from its measured value, or from rest, where a record begins or restarts.
#[derive(Clone, Copy, Debug)]
pub struct Deviation {
    /// The sample.
    pub sample: usize,
    /// Position of the state.
    pub state: usize,
    /// Deviation, in the unit of the state.
    pub by: f64,
}

/// The deviations at a sample.
fn at(sample: usize, deviations: &[Deviation]) -> impl Iterator<Item = &Deviation> {
    deviations.iter().filter(move |own| own.sample == sample)
}

/// Result of a replay.
pub struct Replayed {
    /// Samples of each reading; not finite after the model diverges even with the shortest steps.
    pub signals: Vec<Vec<f64>>,
    /// All states at each sample.
    states: Instants,
    /// All states one sample after the last.
    end: Vec<f64>,
    /// How each step was taken.
    taken: Vec<Taken>,
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

/// Largest number of periods until a motion counts as periodic.
const PERIODS: usize = 60;
/// Steps whose Jacobians are evaluated at once, at least.
const AT_ONCE: usize = 16;
/// Directions that are followed together: two vectors of eight numbers.
const TOGETHER: usize = 16;
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

    /// The signals of a parameter set.
    pub fn run(&self, p: &[f64], begin: &[Deviation]) -> Replayed {
        let rest = vec![0.0; self.model.about().states.len()];
        let mut replayed = self.advance(p, rest, begin);
        let most = if self.how.periodic { PERIODS } else { 0 };
        while replayed.periods <= most && !replayed.repeats() {
            let periods = replayed.periods + 1;
            replayed = self.advance(p, replayed.end, &[]);
            replayed.periods = periods;
        }
        replayed
    }

    /// Derivative of each signal of a replay along some directions, for each of these. Along an initial state, it is that
    /// by the last of its values that were set before.
    ///
    /// Those by initial states of a linear model without resets are its free responses. All others are integrated with
    /// the motion; if it repeats, for as many periods as the replay took to repeat.
    pub fn along(
        &self,
        base: &Replayed,
        (p, begin): (&[f64], &[Deviation]),
        directions: &[Direction],
    ) -> Vec<Vec<Vec<f64>>> {
        let runs_freely = self.model.about().linear && self.restarts.iter().all(|(sample, _)| *sample == 0);
        let free = |direction: &Direction| match *direction {
            Direction::Initial(state) if runs_freely => Some(state),
            _ => None,
        };
        let states: Vec<usize> = directions.iter().filter_map(free).collect();
        let others: Vec<Direction> = directions.iter().filter(|own| free(own).is_none()).cloned().collect();
        let some = |directions: &[Direction]| self.follow(base, (p, begin), directions);
        let others: Vec<_> = others.par_chunks(TOGETHER).flat_map_iter(some).collect();
        let (mut states, mut others) = (self.free_responses(base, p, &states).into_iter(), others.into_iter());
        let next = |own: &Direction| {
            if free(own).is_some() {
                states.next()
            } else {
                others.next()
            }
        };
        directions.iter().filter_map(next).collect()
    }

    /// [`Self::along`] directions that are followed together.
    fn follow(
        &self,
        base: &Replayed,
        (p, begin): (&[f64], &[Deviation]),
        directions: &[Direction],
    ) -> Vec<Vec<Vec<f64>>> {
        let mut tangent = Tangent::new(self.model, p, directions, &self.readings);
        let mut signals = Vec::new();
        let carried = self.carried(p);
        for period in 1..=base.periods {
            let begin = Some(begin).filter(|_| period == 1);
            signals = self.differentiate((&mut tangent, &carried), begin, (base, period));
        }
        let of_direction = |lane: usize| {
            let own = signals.iter_mut().skip(lane).step_by(directions.len());
            own.map(std::mem::take).collect()
        };
        (0..directions.len()).map(of_direction).collect()
    }

    /// Follows one period of a replay, with its steps, from the present state or from the `begin` of a record. A row
    /// for each reading and direction.
    fn differentiate(
        &self,
        (tangent, carried): (&mut Tangent<'_>, &Carried),
        begin: Option<&[Deviation]>,
        (base, period): (&Replayed, usize),
    ) -> Vec<Vec<f64>> {
        let steps = steps(self.how.rate);
        let length = 1.0 / (self.how.rate * steps as f64);
        let inputs = self.nodes.get_or_init(|| self.inputs(steps));
        let count = self.nodes_of_record(steps);
        let mut restarts = self.restarts.iter().peekable();
        let mut signals = vec![Vec::with_capacity(self.how.samples); self.readings.len() * tangent.directions()];
        let mut taken = Vec::new();
        for (sample, own) in base.taken.chunks(steps).enumerate() {
            let restart = restarts.next_if(|(at, _)| *at == sample);
            if restart.is_some() || taken.len() >= AT_ONCE {
                tangent.follow(&taken, &mut signals);
                taken.clear();
            }
            let seen = restart.map_or(&[][..], |(_, seen)| seen);
            let with = |state| if sample == 0 { &[] } else { carried.with(state) };
            for &(state, value) in seen {
                tangent.set(state, value, with(state));
            }
            if let Some(begin) = begin.filter(|_| sample == 0 || restart.is_some()) {
                at(sample, begin).for_each(|own| tangent.deviate(own.state, own.by, with(own.state)));
                let begins = |state| sample == 0 || seen.iter().any(|(own, _)| *own == state);
                tangent.begin(|state| begins(state).then(|| with(state)));
            }
            // The replay has kept the states of its last period alone.
            let known = (period == base.periods).then(|| base.states.at(sample));
            taken.extend(own.iter().enumerate().map(|(step, &taken)| {
                let node = 2 * (sample * steps + step);
                Step {
                    nodes: [node, node + 1, self.end(node, count)].map(|node| inputs.at(node)),
                    length,
                    taken,
                    is_read: step == 0,
                    from: known.filter(|_| step == 0),
                }
            }));
        }
        tangent.follow(&taken, &mut signals);
        signals
    }

    /// Response of each reading of a linear model to a unit initial state, for each of some states.
    fn free_responses(&self, base: &Replayed, p: &[f64], states: &[usize]) -> Vec<Vec<Vec<f64>>> {
        if states.is_empty() {
            return Vec::new();
        }
        let steps = steps(self.how.rate);
        let free = FreeResponse::new(self.model, p, 1.0 / (self.how.rate * steps as f64));
        let of_reading = |reading: &Reading| free.of(*reading, base.taken.chunks(steps), states);
        let by_reading: Vec<Vec<Vec<f64>>> = self.readings.par_iter().map(of_reading).collect();
        let of_state = |state: usize| by_reading.iter().map(|rows| rows[state].clone()).collect();
        (0..states.len()).map(of_state).collect()
    }

    /// What moves along with the states that are set after the beginning.
    fn carried(&self, p: &[f64]) -> Carried {
        let later = self.restarts.iter().filter(|(sample, _)| *sample > 0);
        let mut set: Vec<usize> = later.flat_map(|(_, seen)| seen).map(|(state, _)| *state).collect();
        set.sort_unstable();
        set.dedup();
        Carried::new(self.model, p, &set)
    }

    /// The inputs of the model at each node.
    fn inputs(&self, steps: usize) -> Instants {
        let rows = rows(self.model.about(), &self.recorded, &self.how, 2 * steps);
        let nodes = 0..self.nodes_of_record(steps);
        Instants {
            width: rows.len(),
            values: nodes.flat_map(|k| rows.iter().map(move |row| row[k])).collect(),
        }
    }

    /// Number of integration nodes. A model without inputs has them too: it decays freely.
    fn nodes_of_record(&self, steps: usize) -> usize {
        2 * steps * self.how.samples
    }

    /// Integrates from a state with some changed values.
    fn advance(&self, p: &[f64], mut x: Vec<f64>, begin: &[Deviation]) -> Replayed {
        let steps = steps(self.how.rate);
        let inputs = self.nodes.get_or_init(|| self.inputs(steps));
        let mut restarts = self.restarts.iter().peekable();
        let mut y = vec![0.0; self.model.about().outputs.len()];
        let carried = self.carried(p);
        let mut stepper = Stepper::new(self.model, p, 1.0 / (self.how.rate * steps as f64), self.how.accuracy);
        let count = self.nodes_of_record(steps);
        let mut taken = Vec::with_capacity(count / 2);
        let mut signals = vec![Vec::new(); self.readings.len()];
        let mut states = Vec::with_capacity(x.len() * self.how.samples);
        for first in (0..count).step_by(2 * steps) {
            let sample = first / (2 * steps);
            let with = |state| if sample == 0 { &[] } else { carried.with(state) };
            if let Some((_, seen)) = restarts.next_if(|(at, _)| *at == sample) {
                for &(state, value) in seen {
                    let by = value - x[state];
                    x[state] = value;
                    with(state).iter().for_each(|&(other, factor)| x[other] += factor * by);
                }
                stepper.forget();
            }
            for own in at(sample, begin) {
                x[own.state] += own.by;
                with(own.state)
                    .iter()
                    .for_each(|&(other, factor)| x[other] += factor * own.by);
            }
            stepper.outputs(&x, inputs.at(first), &mut y);
            for (signal, reading) in signals.iter_mut().zip(&self.readings) {
                signal.push(match *reading {
                    Reading::Output(output) => y[output],
                    Reading::State(state) => x[state],
                });
            }
            states.extend_from_slice(&x);
            for node in (first..first + 2 * steps).step_by(2) {
                let nodes = [node, node + 1, self.end(node, count)];
                taken.push(stepper.find(nodes.map(|node| inputs.at(node)), &mut x));
            }
        }
        Replayed {
            signals,
            states: Instants {
                width: x.len(),
                values: states,
            },
            end: x,
            taken,
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
