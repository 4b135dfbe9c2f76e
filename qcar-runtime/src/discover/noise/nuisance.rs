//! Systematic sensor errors as nuisance parameters with a prior. They are equal in all runs.
//!
//! A calibrated accelerometer is wrong by 0.5 to 1 % in gain and by a few tenths of a degree in phase, smoothly in
//! frequency. Treated as independent noise of a hundred lines, it would be strong evidence for a small effect. As a
//! nuisance parameter, it is estimated together with the model parameters, and only errors beyond every calibration
//! remain in the residual. The error of a sensor is `exp(Σ_k c_k φ_k(f))` with real coefficients `c_k ~ N(0, σ_k²)`;
//! time histories also have an offset.

use nalgebra::Complex;

use super::calibration::{AccuracyClass, Form, SENSOR, SHELVES};
use crate::campaign::{Axis, Role};
use crate::discover::observe::{Evidence, Kind, Run, Series, Stimulus};
use crate::mean::mean;
use crate::model::Model;
use crate::transmissibility::Point;

/// Nuisance parameters of all sensors of the evidence, and the initial states of its records.
#[derive(Clone, Debug, PartialEq)]
pub struct Nuisance {
    /// The sensors, including references.
    pub sensors: Vec<Point>,
    /// Lowest and highest frequency of the calibration curves, Hz.
    pub band: (f64, f64),
    /// Number of shelves of each calibration curve; 0 without frequency responses, which alone show a curve.
    pub shelves: usize,
    /// Accuracy class of the calibration curves.
    pub accuracy: AccuracyClass,
    /// What a fit takes as known.
    pub known: Known,
    /// Suspected errors beyond the calibration.
    pub suspects: Vec<Suspect>,
    /// RMS reading of each sensor over all records whose mean is compared; zero without any.
    pub reads: Vec<f64>,
    /// Sensors whose records have no offset, each with the parameter or state of the model that acts as one.
    pub without_offset: Vec<(Point, String)>,
    /// Unknown initial states of the records.
    pub initial_states: Vec<InitialState>,
}

/// What a fit takes as known about the sensors and the discrepancy.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Known {
    /// Nothing: it estimates the errors of the sensors, their accuracy class and the discrepancy.
    Nothing,
    /// The accuracy class.
    Class,
    /// The accuracy class and the discrepancy.
    Variances,
    /// The accuracy class, and the errors of [`SENSOR`] and the shelves.
    Errors,
}

/// Initial state of a record, as the deviation from the sensor reading at the first sample, or from rest without such a
/// sensor; or the zero of a sensor in this record.
#[derive(Clone, Debug, PartialEq)]
pub struct InitialState {
    /// The run, by its file.
    pub run: String,
    /// Name of the state in the model, or of the zero.
    pub state: String,
    /// Prior standard deviation, in the unit of the state.
    pub sigma: f64,
}

/// An error that several sensors share because they are one device or one acquisition channel.
#[derive(Clone, Debug, PartialEq)]
pub struct Suspect {
    /// Positions of the sensors in [`Nuisance::sensors`].
    pub sensors: Vec<usize>,
    /// Form of the error.
    pub form: Form,
    /// Prior standard deviation of its coefficient.
    pub sigma: f64,
}

impl Nuisance {
    /// The calibration errors of each sensor of the evidence.
    pub fn of(evidence: &Evidence) -> Self {
        let references = evidence.runs.iter().flat_map(|run| run.stimulus.references());
        let mut sensors: Vec<Point> = references
            .chain(evidence.series.iter().map(|s| &s.sensor))
            .cloned()
            .collect();
        sensors.sort();
        sensors.dedup();
        let frequencies = || {
            evidence
                .series
                .iter()
                .flat_map(|s| s.at.iter().filter_map(|&at| s.kind.frequency(at)))
        };
        let shows_curves = evidence.series.iter().any(|s| matches!(s.kind, Kind::Harmonic(_)));
        Self {
            shelves: if shows_curves { SHELVES } else { 0 },
            accuracy: AccuracyClass::default(),
            known: Known::Nothing,
            reads: sensors.iter().map(|sensor| reads(evidence, sensor)).collect(),
            without_offset: Vec::new(),
            sensors,
            band: (
                frequencies().fold(f64::INFINITY, f64::min),
                frequencies().fold(0.0, f64::max),
            ),
            suspects: Vec::new(),
            initial_states: Vec::new(),
        }
    }

    /// Adds a suspected error that the sensors of a location share, along one axis or all axes. `sigma` is its prior
    /// standard deviation. `None` if the evidence has no such sensor, or if all axes are wanted and there is only one.
    pub fn with_suspect(mut self, location: &str, axis: Option<&Axis>, form: Form, sigma: f64) -> Option<Self> {
        let is_it = |sensor: &Point| sensor.location == location && axis.is_none_or(|axis| sensor.axis == *axis);
        let sensors: Vec<usize> = (0..self.sensors.len()).filter(|&k| is_it(&self.sensors[k])).collect();
        let first = &self.sensors[*sensors.first()?];
        if axis.is_none() && sensors.iter().all(|&k| self.sensors[k].axis == first.axis) {
            return None;
        }
        self.suspects.push(Suspect { sensors, form, sigma });
        Some(self)
    }

    /// Replaces the initial states by those of a model in the fitted records, for a value of each parameter.
    pub fn with_initial_states(mut self, model: &dyn Model, p: &[f64], evidence: &Evidence) -> Self {
        let fitted = evidence.runs.iter().filter(|run| run.role == Role::Fit);
        let of_run = |run: &Run| {
            let Stimulus::History { spread, .. } = &run.stimulus else {
                return Vec::new();
            };
            let initial_state = |(state, sigma)| InitialState {
                run: run.name.clone(),
                state,
                sigma,
            };
            spread.unknown(model, p).into_iter().map(initial_state).collect()
        };
        self.initial_states = fitted.flat_map(of_run).collect();
        self
    }

    /// Number of coefficients: [`SENSOR`] and the shelves for each sensor in turn, one for each suspect, and one for
    /// each initial state.
    pub fn count(&self) -> usize {
        self.of_sensors() + self.initial_states.len()
    }

    /// Number of coefficients before those of the initial states.
    pub fn of_sensors(&self) -> usize {
        self.of_calibration() + self.suspects.len()
    }

    /// Number of coefficients before those of the suspects.
    pub fn of_calibration(&self) -> usize {
        self.sensors.len() * self.of_a_sensor()
    }

    /// Number of coefficients of each sensor.
    pub(super) fn of_a_sensor(&self) -> usize {
        SENSOR.len() + self.shelves
    }

    /// Prior standard deviation of each coefficient.
    pub fn sigmas(&self) -> Vec<f64> {
        let shelves = std::iter::repeat_n(self.accuracy.shelf(), self.shelves);
        let of_a_sensor = SENSOR.iter().map(|shape| shape.sigma).chain(shelves);
        let priors = self.sensors.iter().flat_map(|_| of_a_sensor.clone());
        priors
            .chain(self.suspects.iter().map(|suspect| suspect.sigma))
            .chain(self.initial_states.iter().map(|initial_state| initial_state.sigma))
            .collect()
    }

    /// Position of a sensor's coefficient; `None` if the sensor is unknown.
    pub(super) fn coefficient(&self, sensor: &Point, form: Form) -> Option<usize> {
        let place = self.sensors.iter().position(|s| s == sensor)?;
        let own = match form {
            Form::Shelf(shelf) => (shelf < self.shelves).then_some(SENSOR.len() + shelf),
            _ => SENSOR.iter().position(|shape| shape.form == form),
        };
        Some(place * self.of_a_sensor() + own?)
    }

    /// Positions of the coefficients of all calibration curves.
    pub fn shelves(&self) -> impl Iterator<Item = usize> {
        let of_sensor = move |place: usize| {
            let first = place * self.of_a_sensor() + SENSOR.len();
            first..first + self.shelves
        };
        (0..self.sensors.len()).flat_map(of_sensor)
    }

    /// Positions of the coefficients of a sensor's mean gain: that of its calibration and those of suspects.
    pub(super) fn mean_gains(&self, sensor: &Point) -> impl Iterator<Item = usize> {
        let own = self.coefficient(sensor, Form::Gain).into_iter();
        own.chain(self.suspected(sensor, Form::Gain))
    }

    /// Positions of the coefficients of suspects of this form that contain the sensor.
    pub(super) fn suspected(&self, sensor: &Point, form: Form) -> impl Iterator<Item = usize> {
        let place = self.sensors.iter().position(|s| s == sensor);
        let is_it =
            move |suspect: &Suspect| suspect.form == form && place.is_some_and(|k| suspect.sensors.contains(&k));
        let suspects = self.suspects.iter().enumerate();
        suspects
            .filter(move |(_, s)| is_it(s))
            .map(|(k, _)| self.of_calibration() + k)
    }
}

/// RMS of all records of a sensor whose mean is compared; 0 without any.
fn reads(evidence: &Evidence, sensor: &Point) -> f64 {
    let is_it = |series: &&Series| {
        let passes_mean = evidence.runs[series.run].stimulus.passes_mean();
        series.kind == Kind::Time && series.sensor == *sensor && passes_mean
    };
    let records = evidence.series.iter().filter(is_it);
    rms(records.flat_map(|series| &series.value))
}

/// Root mean square; zero without values.
pub(super) fn rms<'a>(values: impl Iterator<Item = &'a Complex<f64>>) -> f64 {
    mean(values.map(Complex::norm_sqr)).sqrt()
}
