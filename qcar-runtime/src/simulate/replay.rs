//! A model driven by what was recorded: sweeps of a rig, and any other time history.

use super::failure::SimulateError;
use super::recorded::Recorded;
use super::sampling::{AntiAlias, Grid, Tape};
use super::settings::Settings;
use crate::model::{Model, StateKind};
use crate::solver::{Effort, Step, System};

/// What a model does under recorded inputs.
#[derive(Clone, Debug, PartialEq)]
pub struct Replay {
    /// Each output of the model at the samples of the record, through [`AntiAlias`].
    pub outputs: Vec<Vec<f64>>,
    /// Each state at the samples of the record.
    pub states: Vec<Vec<f64>>,
    /// What the integration cost.
    pub effort: Effort,
}

/// Drives a model, with a value for each of its parameters, by recorded inputs.
///
/// It begins at rest, or where a road was recorded, moving along with it; what the first instants do to it then is a
/// transient of the model, not of the measurement.
///
/// # Errors
/// Too few parameters, and an integration that stops early.
pub fn replay<M: Model + ?Sized>(
    model: &M,
    parameters: &[f64],
    recorded: &Recorded,
    settings: &Settings,
) -> Result<Replay, SimulateError> {
    let about = model.about();
    let (found, expected) = (parameters.len(), about.parameters.len());
    if found != expected {
        return Err(SimulateError::Count {
            name: "the parameter set",
            found,
            expected,
        });
    }
    let mut constants = vec![0.0; about.constants];
    model.prepare(parameters, &mut constants);
    let jumps = recorded.jumps();
    // Inputs that are held make accelerations jump.
    let oversampling = if jumps.is_empty() {
        AntiAlias::CONTINUOUS
    } else {
        AntiAlias::JUMPING
    };
    let (states, width) = (about.states.len(), about.states.len() + about.outputs.len());
    let grid = Grid::new(recorded.rate(), recorded.samples(), oversampling);
    let span = (grid.start(), grid.end());
    let mut x = riding(model, recorded, span.0);
    let mut rig = Rig {
        model,
        constants,
        recorded,
        inputs: vec![0.0; about.inputs.len()],
        leg: span.0,
        tape: Tape::new(grid, width),
        room: vec![0.0; width],
    };
    let longest_step = 1.0 / recorded.rate();
    let effort = settings.integrate(about, &mut rig, span, (longest_step, &jumps), &mut x)?;
    Ok(Replay {
        outputs: (states..width).map(|output| rig.tape.filtered(output)).collect(),
        states: (0..states).map(|state| rig.tape.plain(state).to_vec()).collect(),
        effort,
    })
}

/// All that moves along an axis rides on the road that was recorded there.
fn riding<M: Model + ?Sized>(model: &M, recorded: &Recorded, t: f64) -> Vec<f64> {
    let states = model.about().states.iter();
    let riding = states.map(|state| {
        let [height, velocity] = recorded.road(&state.axis, t).unwrap_or_default();
        match state.kind {
            StateKind::Position => height,
            StateKind::Velocity => velocity,
            StateKind::Inner => 0.0,
        }
    });
    riding.collect()
}

/// A model on its rig, with its records.
struct Rig<'a, M: ?Sized> {
    model: &'a M,
    constants: Vec<f64>,
    recorded: &'a Recorded,
    inputs: Vec<f64>,
    /// When the present leg began, s: until its end, held inputs stay as they were then.
    leg: f64,
    /// The states, and after them the outputs.
    tape: Tape,
    /// Room for a point of it.
    room: Vec<f64>,
}

impl<M: Model + ?Sized> System for Rig<'_, M> {
    fn derivative(&mut self, t: f64, x: &[f64], dx: &mut [f64]) {
        self.recorded.at(t, self.leg, &mut self.inputs);
        self.model.derivative(&self.constants, x, &self.inputs, dx);
    }

    fn enter(&mut self, t: f64, _x: &mut [f64]) {
        self.leg = t;
    }

    fn accept(&mut self, step: &Step<'_>) {
        while let Some(t) = self.tape.next(step.end) {
            let (x, y) = self.room.split_at_mut(step.start_state().len());
            step.at(t, x);
            self.recorded.at(t, self.leg, &mut self.inputs);
            self.model.outputs(&self.constants, x, &self.inputs, y);
            self.tape.record(self.room.iter().copied());
        }
    }
}
