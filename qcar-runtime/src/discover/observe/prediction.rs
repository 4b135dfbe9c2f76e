//! What a model says of one series, and why it may say nothing.

use nalgebra::Complex;
use thiserror::Error;

use super::run::Run;
use crate::model::About;
use crate::response::parameters::ParameterError;
use crate::response::signal::SignalError;
use crate::simulate::SimulateError;

/// A parameter that may move.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Free {
    /// Its place among the parameters of the model; one that leads its ties.
    pub parameter: usize,
    /// Lowest value.
    pub lower: f64,
    /// Highest value.
    pub upper: f64,
}

/// What a model says of one series.
#[derive(Clone, Debug, PartialEq)]
pub struct Prediction {
    /// Place in [`Evidence::series`](super::Evidence::series).
    pub series: usize,
    /// A value for each of the series.
    pub value: Vec<Complex<f64>>,
    /// For each free parameter the derivatives of the values.
    pub slopes: Vec<Vec<Complex<f64>>>,
    /// What a delay of sensors does to values over time; `None` where it only turns their phase, or nothing.
    pub delay: Option<Delay>,
    /// The derivatives of the values by the logarithm of the amplitude that drove the run; `None` where they do not
    /// depend on it.
    pub louder: Option<Vec<Complex<f64>>>,
    /// The derivatives of the values by the states of the model when the record begins, by their names; none where the
    /// prediction was not differentiated, or does not begin with a record.
    pub begun: Vec<(String, Vec<Complex<f64>>)>,
}

/// What errors of sensors change in a prediction itself, not only in what they show of it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Misread {
    /// How late the sensor of each series is, s; without entries none is.
    pub late: Vec<f64>,
    /// By what factor each run was driven harder than its reference shows; without entries none was.
    pub louder: Vec<f64>,
    /// For each run, which states began elsewhere than sensors saw them (or than at rest), and by how much, SI; without
    /// entries none did.
    pub begun: Vec<Vec<(String, f64)>>,
}

impl Misread {
    pub(super) fn begun(&self, run: usize) -> &[(String, f64)] {
        self.begun.get(run).map_or(&[], Vec::as_slice)
    }

    pub(super) fn louder(&self, run: usize) -> f64 {
        self.louder.get(run).copied().unwrap_or(1.0)
    }
}

/// What delays do to a series over time.
#[derive(Clone, Debug, PartialEq)]
pub struct Delay {
    /// The derivatives of the values by a delay (s) of their own sensor.
    pub slope: Vec<Complex<f64>>,
    /// Series of the same run, and which share of a delay of their sensors shifts the clock of the whole run.
    pub shares: Vec<(usize, f64)>,
}

impl Prediction {
    /// Adds what was found to be missing; nothing where nothing was.
    pub fn add(&mut self, missing: &[Complex<f64>]) {
        self.value
            .iter_mut()
            .zip(missing)
            .for_each(|(value, missing)| *value += missing);
    }
}

/// Why a model says nothing of the evidence.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum PredictError {
    /// A sensor measures what the model cannot give.
    #[error(transparent)]
    Signal(#[from] SignalError),
    /// No run may be fitted.
    #[error("no run may be fitted; give at least one with sensors at places of the model `role = \"fit\"`")]
    NothingToFit,
    /// The model gives no number anywhere near its start values.
    #[error("the model gives no finite response near its start values; give it other start values")]
    NoNumber,
    /// A parameter has no value.
    #[error("{}", .0.iter().map(ToString::to_string).collect::<Vec<_>>().join("; "))]
    Parameters(Vec<ParameterError>),
    /// What drove a run is no input of the model.
    #[error(
        "model `{model}` has no input `{location}`, which drives {run}; choose a model that has it, or leave the run out"
    )]
    NoInput {
        /// The model's name.
        model: String,
        /// What drives.
        location: String,
        /// The run's file.
        run: String,
    },
    /// A link that was measured alone is none of the model, or cannot stand alone.
    #[error(
        "model `{model}` has no link `{link}` along {axis} that could stand on a dynamometer by itself; choose a model that has it, or \
         leave {run} out"
    )]
    NoLink {
        /// The model's name.
        model: String,
        /// The link.
        link: String,
        /// Its axis.
        axis: &'static str,
        /// The run's file.
        run: String,
    },
    /// The model cannot roll over the road.
    #[error("{run}: {reason}")]
    Ride {
        /// The run's file.
        run: String,
        /// Why.
        reason: SimulateError,
    },
}

impl PredictError {
    /// Of a run that something drives which is no input of the model.
    pub(super) fn no_input(about: &About, run: &Run, location: &str) -> Self {
        PredictError::NoInput {
            model: about.name.to_string(),
            location: location.to_owned(),
            run: run.name.clone(),
        }
    }
}
