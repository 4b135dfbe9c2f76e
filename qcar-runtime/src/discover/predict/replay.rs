//! A model driven by what was recorded, at fixed steps: what its sensors would have recorded.
//!
//! Inputs are known at nodes that are half a step apart, so that the classical Runge-Kutta method never has to guess
//! between them, and the same record costs the same time for every parameter set.

use super::input::{Between, Recorded, rows};
use crate::model::{About, Model, Quantity, SignalKind, StateKind};
use crate::response::signal::{SignalError, output_of};

/// Where a sensor's signal is found while time goes on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reading {
    /// An output.
    Output(usize),
    /// A state.
    State(usize),
}

/// A replay of one record, whatever the parameters.
pub struct Replay<'m> {
    model: &'m dyn Model,
    /// For each node the inputs.
    inputs: Vec<Vec<f64>>,
    /// s.
    step: f64,
    /// Steps for each sample.
    steps: usize,
    samples: usize,
    /// States at the start.
    start: Vec<f64>,
    readings: Vec<Reading>,
}

impl<'m> Replay<'m> {
    /// Prepares a replay in which each sample is `steps` steps long; `how.nodes` is overruled.
    pub fn new(
        model: &'m dyn Model,
        recorded: &[Recorded],
        how: Between,
        steps: usize,
        start: Vec<f64>,
        readings: Vec<Reading>,
    ) -> Self {
        let how = Between {
            nodes: 2 * steps,
            ..how
        };
        let rows = rows(model.about(), recorded, &how);
        let nodes = rows.first().map_or(0, Vec::len);
        Self {
            model,
            inputs: (0..nodes).map(|k| rows.iter().map(|row| row[k]).collect()).collect(),
            step: 1.0 / (how.rate * steps as f64),
            steps,
            samples: nodes / how.nodes,
            start,
            readings,
        }
    }

    /// For each reading its samples; not finite from where the model has run away.
    pub fn run(&self, p: &[f64]) -> Vec<Vec<f64>> {
        let about = self.model.about();
        let mut constants = vec![0.0; about.constants];
        self.model.prepare(p, &mut constants);
        let mut x = self.start.clone();
        let mut y = vec![0.0; about.outputs.len()];
        let mut stages = Stages::new(x.len());
        let mut signals = vec![Vec::with_capacity(self.samples); self.readings.len()];
        for sample in 0..self.samples {
            let first = 2 * self.steps * sample;
            self.model.outputs(&constants, &x, &self.inputs[first], &mut y);
            for (signal, reading) in signals.iter_mut().zip(&self.readings) {
                signal.push(match *reading {
                    Reading::Output(output) => y[output],
                    Reading::State(state) => x[state],
                });
            }
            for step in 0..self.steps {
                let node = first + 2 * step;
                let end = (node + 2).min(self.inputs.len() - 1);
                let inputs = [node, node + 1, end].map(|node| self.inputs[node].as_slice());
                stages.advance(self.model, &constants, inputs, self.step, &mut x);
            }
        }
        signals
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
