//! Derivatives of the signals of a replay by parameters, inputs and initial states, integrated with the motion.
//!
//! Each stage of the Runge-Kutta method is differentiated with the model's own Jacobians: `K = A S + ∂f/∂p`, or `A S + B u` for the
//! log amplitude of an input. So the result is the derivative of the computed motion itself, whatever the length of its steps. At a
//! kink of a law the stage decides which side counts; forces are continuous there, so the sensitivities do not jump. Only where an
//! inner state would not decay within a step, the step is halved further: a motion may rest there, but its derivatives would grow.
//!
//! Source: Hairer, Norsett, Wanner, Solving ordinary differential equations I, section I.14.

use super::Reading;
use super::stepper::within;
use crate::model::{InputKind, LANES, Lanes, Matrix, Model, Points};
use crate::solver::rk4;

/// What a signal is differentiated by.
#[derive(Clone, Debug, PartialEq)]
pub enum Direction {
    /// These parameters, which change together.
    Parameters(Vec<usize>),
    /// The log amplitude of an excitation.
    Amplitude(usize),
    /// The initial value of a state.
    Initial(usize),
}

/// Stages of a Runge-Kutta step.
const STAGES: usize = 4;
/// Position of each stage in its step.
const AT: [f64; STAGES] = [0.0, 0.5, 0.5, 1.0];
/// Weight of each stage.
const WEIGHTS: [f64; STAGES] = [1.0 / 6.0, 1.0 / 3.0, 1.0 / 3.0, 1.0 / 6.0];

/// Longest step times rate of decay of a state, for which the method still lets it decay.
const LONGEST: f64 = 2.5;
/// Most further halvings of a step for that reason.
const MOST: u8 = 3;

/// A step of a replay.
#[derive(Clone, Copy)]
pub struct Step<'n> {
    /// Inputs at its start, middle and end.
    pub nodes: [&'n [f64]; 3],
    /// Length, s.
    pub length: f64,
    /// How often it was halved.
    pub halvings: u8,
    /// True if the readings are taken at its start.
    pub is_read: bool,
    /// State at its start, if it is known.
    pub from: Option<&'n [f64]>,
}

impl Step<'_> {
    /// Number of its parts if it is halved some times more.
    fn parts(&self, finer: u8) -> u32 {
        1 << (self.halvings + finer)
    }
}

/// A nonzero of a Jacobian: its position in the model's list, its row, and its column.
type Nonzero = (usize, usize, usize);

/// A direct effect on a row: the nonzero with its position, its row, the input by which it is multiplied, and the direction.
struct Source {
    nonzero: usize,
    row: usize,
    input: Option<usize>,
    lane: usize,
}

/// Effects on the derivatives of the states, or on the outputs.
#[derive(Default)]
struct Effects {
    /// Of the states.
    states: Vec<Nonzero>,
    /// Of inputs whose amplitude changes.
    inputs: Vec<Source>,
    /// Of parameters.
    parameters: Vec<Source>,
}

impl Effects {
    fn of(model: &dyn Model, directions: &[Direction], of_outputs: bool) -> Self {
        let about = model.about();
        let (by_states, by_inputs) = match of_outputs {
            true => (Matrix::C, Matrix::D),
            false => (Matrix::A, Matrix::B),
        };
        let mut effects = Effects::default();
        for (nonzero, entry) in about.matrices.iter().enumerate() {
            let (row, column) = (usize::from(entry.row), usize::from(entry.column));
            if entry.matrix == by_states {
                effects.states.push((nonzero, row, column));
            } else if entry.matrix == by_inputs {
                let excitation = match about.inputs[column].kind {
                    InputKind::Motion(place, _) | InputKind::Force(place) => usize::from(place),
                    InputKind::Gravity => continue,
                };
                let lanes = lanes(directions, |own| *own == Direction::Amplitude(excitation));
                effects.inputs.extend(lanes.map(|lane| Source {
                    nonzero,
                    row,
                    input: Some(column),
                    lane,
                }));
            }
        }
        for (nonzero, &(output, row, parameter)) in about.parameter_jacobian.iter().enumerate() {
            let has =
                |own: &Direction| matches!(own, Direction::Parameters(own) if own.contains(&usize::from(parameter)));
            if output == of_outputs {
                effects.parameters.extend(lanes(directions, has).map(|lane| Source {
                    nonzero,
                    row: usize::from(row),
                    input: None,
                    lane,
                }));
            }
        }
        effects
    }

    /// The derivatives of the rows along all directions at a point, from those of the states.
    fn at(&self, jacobians: &Jacobians, point: usize, states: &[Lanes], rows: &mut [Lanes], blocks: usize) {
        rows.fill([0.0; LANES]);
        for source in &self.inputs {
            let u = source.input.map_or(1.0, |input| jacobians.stages.u(point, input));
            rows.as_flattened_mut()[source.place(blocks)] += jacobians.matrix(source.nonzero, point) * u;
        }
        for source in &self.parameters {
            rows.as_flattened_mut()[source.place(blocks)] += jacobians.parameter(source.nonzero, point);
        }
        for &(nonzero, row, column) in &self.states {
            let factor = jacobians.matrix(nonzero, point);
            let of_column = &states[column * blocks..][..blocks];
            add(factor, of_column, &mut rows[row * blocks..][..blocks]);
        }
    }

    /// Fastest decay of a state at a point, 1/s, by its own value alone.
    fn fastest_decay(&self, jacobians: &Jacobians, point: usize) -> f64 {
        let own = self.states.iter().filter(|(_, row, column)| row == column);
        own.fold(0.0, |most: f64, &(nonzero, ..)| {
            most.max(-jacobians.matrix(nonzero, point))
        })
    }
}

impl Source {
    fn place(&self, blocks: usize) -> usize {
        self.row * blocks * LANES + self.lane
    }
}

/// Adds a multiple of some rows to others.
fn add(factor: f64, from: &[Lanes], into: &mut [Lanes]) {
    for (into, from) in into.iter_mut().zip(from) {
        for lane in 0..LANES {
            into[lane] += factor * from[lane];
        }
    }
}

fn lanes(directions: &[Direction], has: impl Fn(&Direction) -> bool) -> impl Iterator<Item = usize> {
    let with = directions.iter().enumerate().filter(move |(_, own)| has(own));
    with.map(|(lane, _)| lane).collect::<Vec<_>>().into_iter()
}

/// States and inputs at the stages of the parts of some steps: a row of all points for each.
#[derive(Default)]
struct Stages {
    /// Number of points.
    count: usize,
    x: Vec<f64>,
    u: Vec<f64>,
    parts: Vec<Part>,
}

/// A part of a step.
struct Part {
    /// The step, by its place among those that are followed together.
    step: usize,
    /// Length, s.
    length: f64,
    /// True if the readings are taken at its start.
    is_read: bool,
}

impl Stages {
    /// Makes room for some parts of a model with as many states and inputs.
    fn prepare(&mut self, parts: usize, (states, inputs): (usize, usize)) {
        self.count = STAGES * parts;
        self.x.resize(states * self.count, 0.0);
        self.u.resize(inputs * self.count, 0.0);
        self.parts.clear();
    }

    fn put(&mut self, point: usize, x: &[f64], u: &[f64]) {
        for (rows, values) in [(&mut self.x, x), (&mut self.u, u)] {
            let places = rows.iter_mut().skip(point).step_by(self.count);
            places.zip(values).for_each(|(place, value)| *place = *value);
        }
    }

    fn u(&self, point: usize, input: usize) -> f64 {
        self.u[input * self.count + point]
    }
}

/// The Jacobians at the stages of some steps: a row of all points for each nonzero.
#[derive(Default)]
struct Jacobians {
    stages: Stages,
    matrices: Vec<f64>,
    parameters: Vec<f64>,
}

impl Jacobians {
    fn evaluate(&mut self, model: &dyn Model, p: &[f64]) {
        let (stages, about) = (&self.stages, model.about());
        let points = Points {
            count: stages.count,
            x: &stages.x,
            u: &stages.u,
        };
        self.matrices.resize(about.matrices.len() * stages.count, 0.0);
        self.parameters
            .resize(about.parameter_jacobian.len() * stages.count, 0.0);
        model.matrices_at(p, &points, &mut self.matrices);
        model.parameter_jacobian_at(p, &points, &mut self.parameters);
    }

    fn matrix(&self, nonzero: usize, point: usize) -> f64 {
        self.matrices[nonzero * self.stages.count + point]
    }

    fn parameter(&self, nonzero: usize, point: usize) -> f64 {
        self.parameters[nonzero * self.stages.count + point]
    }
}

/// A motion with its derivatives along some directions.
pub struct Tangent<'a> {
    model: &'a dyn Model,
    p: &'a [f64],
    directions: &'a [Direction],
    constants: Vec<f64>,
    x: Vec<f64>,
    /// Rows of all directions for each state: `blocks` rows of lanes.
    slopes: Vec<Lanes>,
    blocks: usize,
    of_rates: Effects,
    of_outputs: Effects,
    jacobians: Jacobians,
    /// State before some steps.
    before: Vec<f64>,
    /// How often each step is halved beyond its own halvings.
    finer: Vec<u8>,
    /// Workspace of the motion: slopes of the stages, the state at the end of a step, and inputs of a part of a step.
    k: [Vec<f64>; 5],
    x_end: Vec<f64>,
    inputs: [Vec<f64>; 3],
    /// Workspace of the derivatives: those of the stages' slopes, of a stage's states, and of the outputs.
    slope_k: [Vec<Lanes>; STAGES],
    stage: Vec<Lanes>,
    outputs: Vec<Lanes>,
}

impl<'a> Tangent<'a> {
    /// A motion that begins at rest.
    pub fn new(model: &'a dyn Model, p: &'a [f64], directions: &'a [Direction]) -> Self {
        let about = model.about();
        let (n, m, blocks) = (about.states.len(), about.inputs.len(), directions.len().div_ceil(LANES));
        let mut constants = vec![0.0; about.constants];
        model.prepare(p, &mut constants);
        let rows = |count: usize| vec![[0.0; LANES]; count * blocks];
        Self {
            model,
            p,
            directions,
            constants,
            x: vec![0.0; n],
            slopes: rows(n),
            blocks,
            of_rates: Effects::of(model, directions, false),
            of_outputs: Effects::of(model, directions, true),
            jacobians: Jacobians::default(),
            before: vec![0.0; n],
            finer: Vec::new(),
            k: std::array::from_fn(|_| vec![0.0; n]),
            x_end: vec![0.0; n],
            inputs: std::array::from_fn(|_| vec![0.0; m]),
            slope_k: std::array::from_fn(|_| rows(n)),
            stage: rows(n),
            outputs: rows(about.outputs.len()),
        }
    }

    /// Number of directions.
    pub fn directions(&self) -> usize {
        self.directions.len()
    }

    /// Sets a state to a measured value, on which nothing depends.
    pub fn set(&mut self, state: usize, value: f64) {
        self.x[state] = value;
        self.slopes[state * self.blocks..][..self.blocks].fill([0.0; LANES]);
    }

    /// Begins a motion with these deviations of its states. Its derivatives by initial states begin at one.
    pub fn begin(&mut self, deviations: &[(usize, f64)]) {
        deviations.iter().for_each(|&(state, by)| self.x[state] += by);
        for (lane, direction) in self.directions.iter().enumerate() {
            if let Direction::Initial(state) = *direction {
                self.slopes.as_flattened_mut()[state * self.blocks * LANES + lane] += 1.0;
            }
        }
    }

    /// Takes the steps of some samples, and adds the derivatives of the readings to `signals`, a row for each reading and
    /// direction. All Jacobians of these steps are evaluated at once.
    pub fn follow(&mut self, steps: &[Step<'_>], readings: &[Reading], signals: &mut [Vec<f64>]) {
        self.before.copy_from_slice(&self.x);
        self.finer.clear();
        self.finer.resize(steps.len(), 0);
        loop {
            self.x.copy_from_slice(&self.before);
            let parts = steps.iter().zip(&self.finer).map(|(step, finer)| step.parts(*finer));
            let sizes = (self.x.len(), self.model.about().inputs.len());
            self.jacobians
                .stages
                .prepare(parts.map(|parts| parts as usize).sum(), sizes);
            for (place, step) in steps.iter().enumerate() {
                self.step(place, step);
            }
            self.jacobians.evaluate(self.model, self.p);
            if !self.refine() {
                break;
            }
        }
        for part in 0..self.jacobians.stages.parts.len() {
            if self.jacobians.stages.parts[part].is_read {
                self.read(part, readings, signals);
            }
            self.advance_slopes(part);
        }
    }

    /// Halves the steps further in which a state would not decay. False if there is none.
    fn refine(&mut self) -> bool {
        let mut further = vec![0_u8; self.finer.len()];
        for (place, part) in self.jacobians.stages.parts.iter().enumerate() {
            let points = STAGES * place..STAGES * (place + 1);
            let decays = points.map(|point| self.of_rates.fastest_decay(&self.jacobians, point));
            let times = decays.fold(0.0, f64::max) * part.length / LONGEST;
            let halvings = times.log2().ceil().clamp(0.0, f64::from(MOST - self.finer[part.step]));
            further[part.step] = further[part.step].max(halvings as u8);
        }
        self.finer
            .iter_mut()
            .zip(&further)
            .for_each(|(finer, further)| *finer += further);
        further.iter().any(|&further| further > 0)
    }

    /// Advances the motion by a step in its parts.
    fn step(&mut self, place: usize, step: &Step<'_>) {
        if let Some(state) = step.from {
            self.x.copy_from_slice(state);
        }
        let parts = step.parts(self.finer[place]);
        let length = step.length / f64::from(parts);
        for part in 0..parts {
            self.jacobians.stages.parts.push(Part {
                step: place,
                length,
                is_read: step.is_read && part == 0,
            });
            if parts == 1 {
                self.part(step.nodes, length);
            } else {
                let mut inputs = std::mem::take(&mut self.inputs);
                within(step.nodes, (part, parts), &mut inputs);
                self.part(inputs.each_ref().map(Vec::as_slice), length);
                self.inputs = inputs;
            }
        }
    }

    /// Advances the motion by the last of the known parts.
    fn part(&mut self, inputs: [&[f64]; 3], length: f64) {
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
                stage += 1;
            }
        };
        rk4::step(derivative, length, &self.x, &mut self.k, &mut self.x_end);
        self.x.copy_from_slice(&self.x_end);
    }

    fn read(&mut self, part: usize, readings: &[Reading], signals: &mut [Vec<f64>]) {
        let (blocks, count) = (self.blocks, self.directions.len());
        let outputs = &mut self.outputs;
        self.of_outputs
            .at(&self.jacobians, STAGES * part, &self.slopes, outputs, blocks);
        for (signals, reading) in signals.chunks_exact_mut(count).zip(readings) {
            let (of, row) = match *reading {
                Reading::Output(output) => (&self.outputs, output),
                Reading::State(state) => (&self.slopes, state),
            };
            let slopes = of[row * blocks..][..blocks].as_flattened();
            signals
                .iter_mut()
                .zip(slopes)
                .for_each(|(signal, slope)| signal.push(*slope));
        }
    }

    fn advance_slopes(&mut self, part: usize) {
        let (blocks, h) = (self.blocks, self.jacobians.stages.parts[part].length);
        for (stage, at) in AT.iter().enumerate() {
            self.stage.copy_from_slice(&self.slopes);
            if stage > 0 {
                add(at * h, &self.slope_k[stage - 1], &mut self.stage);
            }
            let point = STAGES * part + stage;
            let into = &mut self.slope_k[stage];
            self.of_rates.at(&self.jacobians, point, &self.stage, into, blocks);
        }
        for (weight, k) in WEIGHTS.iter().zip(&self.slope_k) {
            add(weight * h, k, &mut self.slopes);
        }
    }
}
