//! Prediction of one series, and the errors of a prediction.

use nalgebra::Complex;
use thiserror::Error;

use super::run::Run;
use crate::model::About;
use crate::response::parameters::ParameterError;
use crate::response::signal::SignalError;
use crate::simulate::SimulateError;

/// A free parameter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Free {
    /// Its position among the parameters of the model. It is the leader if other parameters are tied to it.
    pub parameter: usize,
    /// Lower bound, SI.
    pub lower: f64,
    /// Upper bound, SI.
    pub upper: f64,
}

impl Free {
    /// Change of the parameter for a finite difference: `part` of its value, or of a hundredth of its typical size if
    /// that is larger. Negative where the upper bound is closer than that.
    pub(super) fn change(&self, value: f64, part: f64) -> f64 {
        const OF_RANGE: f64 = 1e-2;
        // A positive range may span many decades, so its geometric mean is typical, not its width.
        let typical = if self.lower > 0.0 {
            self.lower.sqrt() * self.upper.sqrt()
        } else {
            (self.upper - self.lower).min(f64::MAX)
        };
        let change = part * value.abs().max(OF_RANGE * typical);
        if value + change > self.upper { -change } else { change }
    }
}

/// Prediction of one series.
#[derive(Clone, Debug, PartialEq)]
pub struct Prediction {
    /// Position in [`Evidence::series`](super::Evidence::series).
    pub series: usize,
    /// Predicted values, one for each value of the series.
    pub value: Vec<Complex<f64>>,
    /// Derivatives of the values by each free parameter.
    pub slopes: Vec<Vec<Complex<f64>>>,
    /// Effect of sensor delays on values over time; `None` if a delay changes only their phase, or nothing.
    pub delay: Option<Delay>,
    /// Derivatives of the values by the log amplitude of each recorded excitation, in the order of
    /// [`Stimulus::references`](super::Stimulus::references). Empty if the values do not depend on it, and without
    /// derivatives.
    pub by_drive: Vec<Vec<Complex<f64>>>,
    /// Derivatives of the values by the initial states of a record, by name. Empty for other runs and without
    /// derivatives.
    pub by_initial_states: Vec<(String, Vec<Complex<f64>>)>,
}

/// Unknown test conditions: they change the prediction itself, not only the readings of its sensors.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TestConditions {
    /// Delay of the sensor of each series, s; missing entries are zero.
    pub delays: Vec<f64>,
    /// For each run, the factor of each true excitation on that of its reference sensor; missing entries are 1.
    pub drive: Vec<Vec<f64>>,
    /// For each run, the initial states; missing entries are zero.
    pub initial_states: Vec<Vec<Initial>>,
}

/// Deviation of a state from the sensor reading, or from rest without a sensor, where a record begins or restarts; or the
/// zero of a sensor in the whole record.
#[derive(Clone, Debug, PartialEq)]
pub struct Initial {
    /// The sample.
    pub sample: usize,
    /// Name of the state, or of the zero.
    pub state: String,
    /// Deviation, SI.
    pub by: f64,
}

impl TestConditions {
    pub(super) fn initial_states_of(&self, run: usize) -> &[Initial] {
        self.initial_states.get(run).map_or(&[], Vec::as_slice)
    }

    /// Factor of the `reference`-th excitation of a run.
    pub(super) fn drive_of(&self, run: usize, reference: usize) -> f64 {
        let factors = self.drive.get(run);
        factors
            .and_then(|factors| factors.get(reference))
            .copied()
            .unwrap_or(1.0)
    }
}

/// Effect of sensor delays on a series over time.
#[derive(Clone, Debug, PartialEq)]
pub struct Delay {
    /// Derivatives of the values by a delay (s) of their own sensor.
    pub slope: Vec<Complex<f64>>,
    /// Series of the same run, each with the share by which a delay of its sensor shifts the clock of the whole run.
    pub shares: Vec<(usize, f64)>,
}

impl Prediction {
    /// Adds the non-steady part to the values; an empty slice adds nothing.
    pub fn add(&mut self, unsteady: &[Complex<f64>]) {
        self.value
            .iter_mut()
            .zip(unsteady)
            .for_each(|(value, unsteady)| *value += unsteady);
    }

    /// Takes [added](Self::add) values away again.
    pub fn subtract(&mut self, unsteady: &[Complex<f64>]) {
        self.value
            .iter_mut()
            .zip(unsteady)
            .for_each(|(value, unsteady)| *value -= unsteady);
    }
}

/// Reason why a model cannot predict the evidence.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum PredictError {
    /// A sensor measures a quantity that the model lacks.
    #[error(transparent)]
    Signal(#[from] SignalError),
    /// No run may be fitted.
    #[error("no run may be fitted; give at least one with sensors at places of the model `role = \"fit\"`")]
    NothingToFit,
    /// The model gives no finite response near its start values.
    #[error("the model gives no finite response near its start values; give it other start values")]
    NoNumber,
    /// A parameter has no value.
    #[error("{}", .0.iter().map(ToString::to_string).collect::<Vec<_>>().join("; "))]
    Parameters(Vec<ParameterError>),
    /// The excitation of a run is no input of the model.
    #[error(
        "model `{model}` has no input `{location}`, which drives {run}; choose a model that has it, or leave the run \
         out"
    )]
    NoInput {
        /// Name of the model.
        model: String,
        /// Location of the excitation.
        location: String,
        /// File of the run.
        run: String,
    },
    /// A link of a dynamometer test is not in the model, or cannot be simulated alone.
    #[error(
        "model `{model}` has no link `{link}` along {axis} that could stand on a dynamometer by itself; choose a model \
         that has it, or leave {run} out"
    )]
    NoLink {
        /// Name of the model.
        model: String,
        /// Name of the link.
        link: String,
        /// Axis of the link.
        axis: String,
        /// File of the run.
        run: String,
    },
    /// The passage over the road cannot be simulated.
    #[error("{run}: {reason}")]
    Ride {
        /// File of the run.
        run: String,
        /// Reason of the simulation.
        reason: SimulateError,
    },
}

impl PredictError {
    /// Error for a run whose excitation is no input of the model.
    pub(super) fn no_input(about: &About, run: &Run, location: &str) -> Self {
        PredictError::NoInput {
            model: about.name.to_string(),
            location: location.to_owned(),
            run: run.name.clone(),
        }
    }
}
