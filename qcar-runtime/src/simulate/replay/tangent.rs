//! Derivatives of the signals of a replay by parameters, inputs and initial states, integrated with the motion.
//!
//! Each stage of the Runge-Kutta method is differentiated with the model's own Jacobians: `K = A S + ∂f/∂p`, `A S +
//! B u` for the log amplitude of an input, or `A S + B` for its zero. So the result is the derivative of the computed
//! motion itself, whatever the length of its steps. At a kink of a law the stage decides which side counts; forces are continuous there, so the
//! sensitivities do not jump. Where a state decays within a step, its derivatives follow the exponential method of
//! [`decay`](super::decay), even if the motion does not: it may rest there, but its derivatives would grow.
//!
//! Source: Hairer, Norsett, Wanner, Solving ordinary differential equations I, section I.14.

// The motion at the stages, and the Jacobians there.
mod stages;
// What acts on the derivatives.
mod effects;
// The derivatives of the states from part to part.
mod slopes;

use super::Reading;
use super::decay::{Decay, Weights};
use super::stepper::{Taken, within};
use crate::model::{LANES, Lanes, Model};
use crate::solver::rk4;
use crate::vectors::over_lanes;
use effects::Effects;
use slopes::Advance;
use stages::{Jacobians, Part, STAGES};

/// What a signal is differentiated by.
#[derive(Clone, Debug, PartialEq)]
pub enum Direction {
    /// These parameters, which change together.
    Parameters(Vec<usize>),
    /// The log amplitude of an excitation.
    Amplitude(usize),
    /// A constant that is added to the force of an excitation.
    Zero(usize),
    /// The initial value of a state.
    Initial(usize),
}

/// A step of a replay.
#[derive(Clone, Copy)]
pub struct Step<'n> {
    /// Inputs at its start, middle and end.
    pub nodes: [&'n [f64]; 3],
    /// Length, s.
    pub length: f64,
    /// How it was taken.
    pub taken: Taken,
    /// True if the readings are taken at its start.
    pub is_read: bool,
    /// State at its start, if it is known.
    pub from: Option<&'n [f64]>,
}

impl Step<'_> {
    /// Number of its parts.
    fn parts(&self) -> u32 {
        1 << self.taken.halvings
    }
}

/// A motion with its derivatives along some directions.
pub struct Tangent<'a> {
    model: &'a dyn Model,
    p: &'a [f64],
    directions: &'a [Direction],
    readings: &'a [Reading],
    constants: Vec<f64>,
    x: Vec<f64>,
    /// Derivatives of the states, for each block of directions: a row of lanes for each state.
    slopes: Vec<Lanes>,
    of_states: Effects,
    of_readings: Effects,
    decay: Decay<'a>,
    jacobians: Jacobians,
    /// Weights of all states in the parts in which one decays.
    weights: Vec<Weights>,
    /// Workspace of the motion: slopes of the stages, the state at the end of a step, and inputs of a part of a step.
    k: [Vec<f64>; 5],
    x_end: Vec<f64>,
    inputs: [Vec<f64>; 3],
    /// Workspace of the derivatives: direct effects on the states and on the readings, the points at which these are
    /// taken, their derivatives, and rows of a block.
    direct: [Vec<Lanes>; 2],
    read_at: Vec<usize>,
    read: Vec<Lanes>,
    work: [Vec<Lanes>; 6],
}

impl<'a> Tangent<'a> {
    /// A motion that begins at rest, and its readings.
    pub fn new(model: &'a dyn Model, p: &'a [f64], directions: &'a [Direction], readings: &'a [Reading]) -> Self {
        let about = model.about();
        let (n, m, blocks) = (about.states.len(), about.inputs.len(), directions.len().div_ceil(LANES));
        let mut constants = vec![0.0; about.constants];
        model.prepare(p, &mut constants);
        let of_states = Effects::on_states(model, directions);
        Self {
            model,
            p,
            directions,
            readings,
            constants,
            x: vec![0.0; n],
            slopes: vec![[0.0; LANES]; blocks * n],
            decay: Decay::new(model, p),
            of_states,
            of_readings: Effects::on_readings(model, directions, readings),
            jacobians: Jacobians::default(),
            weights: Vec::new(),
            k: std::array::from_fn(|_| vec![0.0; n]),
            x_end: vec![0.0; n],
            inputs: std::array::from_fn(|_| vec![0.0; m]),
            direct: Default::default(),
            read_at: Vec::new(),
            read: Vec::new(),
            work: std::array::from_fn(|_| vec![[0.0; LANES]; n]),
        }
    }

    /// Number of directions.
    pub fn directions(&self) -> usize {
        self.directions.len()
    }

    /// Sets a state to a measured value, which depends on nothing. The states `with` it move along by these factors.
    pub fn set(&mut self, state: usize, value: f64, with: &[(usize, f64)]) {
        let states = self.x.len();
        let by = value - self.x[state];
        self.x[state] = value;
        with.iter().for_each(|&(other, factor)| self.x[other] += factor * by);
        for rows in self.slopes.chunks_exact_mut(states) {
            let own = std::mem::replace(&mut rows[state], [0.0; LANES]);
            for &(other, factor) in with {
                rows[other]
                    .iter_mut()
                    .zip(own)
                    .for_each(|(slope, own)| *slope -= factor * own);
            }
        }
    }

    /// Adds a deviation to a state, and to those that move along.
    pub fn deviate(&mut self, state: usize, by: f64, with: &[(usize, f64)]) {
        self.x[state] += by;
        with.iter().for_each(|&(other, factor)| self.x[other] += factor * by);
    }

    /// Begins the derivatives by those initial states for which `with` gives what moves along.
    pub fn begin<'w>(&mut self, with: impl Fn(usize) -> Option<&'w [(usize, f64)]>) {
        for (lane, direction) in self.directions.iter().enumerate() {
            if let Direction::Initial(state) = *direction
                && let Some(with) = with(state)
            {
                let first = lane / LANES * self.x.len();
                for (other, factor) in std::iter::once((state, 1.0)).chain(with.iter().copied()) {
                    self.slopes[first + other][lane % LANES] += factor;
                }
            }
        }
    }

    /// Takes the steps of some samples, and adds the derivatives of the readings to `signals`, a row for each reading
    /// and direction. All Jacobians of these steps are evaluated at once.
    pub fn follow(&mut self, steps: &[Step<'_>], signals: &mut [Vec<f64>]) {
        let parts = steps.iter().map(|step| step.parts() as usize).sum();
        let sizes = (self.x.len(), self.model.about().inputs.len());
        self.jacobians.stages.prepare(parts, sizes);
        steps.iter().for_each(|step| self.step(step));
        self.jacobians.evaluate_matrices(self.model, self.p);
        self.find_decays();
        self.jacobians.evaluate_parameters(self.model, self.p);
        self.advance_slopes();
        self.store(signals);
    }

    /// Finds the states that decay within a part, by their fastest rates at its stages.
    fn find_decays(&mut self) {
        let Self {
            decay,
            jacobians,
            weights,
            ..
        } = self;
        weights.clear();
        for place in 0..jacobians.stages.parts.len() {
            let h = jacobians.stages.parts[place].length;
            let points = || STAGES * place..STAGES * (place + 1);
            let rate = |nonzero: usize| {
                points()
                    .map(|point| jacobians.matrix(nonzero, point))
                    .fold(0.0, f64::min)
            };
            let decaying = decay
                .own
                .iter()
                .map(|&(nonzero, state)| (state, Weights::new(rate(nonzero), h)));
            let decaying: Vec<_> = decaying.filter(|(_, own)| own.decays()).collect();
            if decaying.is_empty() {
                continue;
            }
            let first = weights.len();
            weights.resize(first + self.x.len(), Weights::new(0.0, h));
            decaying.iter().for_each(|&(state, own)| weights[first + state] = own);
            jacobians.stages.parts[place].weights = Some(first);
        }
    }

    /// Advances the motion by a step in its parts.
    fn step(&mut self, step: &Step<'_>) {
        if let Some(state) = step.from {
            self.x.copy_from_slice(state);
        }
        let parts = step.parts();
        let length = step.length / f64::from(parts);
        for part in 0..parts {
            self.jacobians.stages.parts.push(Part {
                length,
                weights: None,
                is_read: step.is_read && part == 0,
            });
            if parts == 1 {
                self.part(step.nodes, length, step.taken.decays);
            } else {
                let mut inputs = std::mem::take(&mut self.inputs);
                within(step.nodes, (part, parts), &mut inputs);
                self.part(inputs.each_ref().map(Vec::as_slice), length, step.taken.decays);
                self.inputs = inputs;
            }
        }
    }

    /// Advances the motion by the last of the known parts.
    fn part(&mut self, inputs: [&[f64]; 3], length: f64, may_decay: bool) {
        let Self { model, constants, .. } = self;
        let stages = &mut self.jacobians.stages;
        let first = STAGES * (stages.parts.len() - 1);
        model.derivative(constants, &self.x, inputs[0], &mut self.k[0]);
        stages.put(first, &self.x, inputs[0]);
        let mut stage = 1;
        let derivative = |c: f64, x: &[f64], k: &mut [f64]| {
            // The slope at the end of the step is that of the next one, which evaluates it with its own inputs.
            if stage < STAGES {
                let u = inputs[(2.0 * c) as usize];
                model.derivative(constants, x, u, k);
                stages.put(first + stage, x, u);
            }
            // A step that is repeated puts its stages again.
            stage = stage % STAGES + 1;
        };
        if may_decay {
            self.decay
                .step(derivative, (inputs, length), &self.x, &mut self.k, &mut self.x_end);
        } else {
            rk4::step(derivative, length, &self.x, &mut self.k, &mut self.x_end);
        }
        self.x.copy_from_slice(&self.x_end);
    }

    /// Advances the derivatives of the states, and takes those of the readings.
    fn advance_slopes(&mut self) {
        let (states, readings, blocks) = (self.x.len(), self.readings.len(), self.directions.len().div_ceil(LANES));
        let stages = &self.jacobians.stages;
        let points = stages.count();
        let read = stages.parts.iter().enumerate().filter(|(_, part)| part.is_read);
        self.read_at.clear();
        self.read_at.extend(read.map(|(place, _)| STAGES * place));
        let reads = self.read_at.len() * readings;
        self.read.resize(blocks * reads, [0.0; LANES]);
        let [direct, read_direct] = &mut self.direct;
        self.of_states.direct(&self.jacobians, 0..points, blocks, direct);
        let read_at = self.read_at.iter().copied();
        self.of_readings.direct(&self.jacobians, read_at, blocks, read_direct);
        for block in 0..blocks {
            over_lanes(Advance {
                jacobians: &self.jacobians,
                weights: &self.weights,
                of_states: (&self.of_states, &direct[block * points * states..][..points * states]),
                readings: self.readings,
                of_readings: (&self.of_readings, &read_direct[block * reads..][..reads]),
                slopes: &mut self.slopes[block * states..][..states],
                work: self.work.each_mut().map(Vec::as_mut_slice),
                read: &mut self.read[block * reads..][..reads],
            });
        }
    }

    /// Adds the derivatives of the readings to their signals.
    fn store(&self, signals: &mut [Vec<f64>]) {
        let (count, readings) = (self.directions.len(), self.readings.len());
        let reads = self.read_at.len() * readings;
        for (place, signal) in signals.iter_mut().enumerate() {
            let (reading, lane) = (place / count, place % count);
            let of_block = &self.read[lane / LANES * reads..][..reads];
            let own = of_block.iter().skip(reading).step_by(readings);
            signal.extend(own.map(|row| row[lane % LANES]));
        }
    }
}
