//! What sensors may be wrong by, in all runs alike: unknowns of their own, held by a prior.
//!
//! A calibrated accelerometer is off by 0.5 to 1 % in gain and by a few tenths of a degree in phase, smoothly in
//! frequency. Taken as noise, such an error would look like a hundred independent proofs of some small effect; taken as
//! an unknown of the sensor, it is estimated along with the parameters, and only what no calibration can explain is a
//! gap. The error of a sensor is `exp(Σ_k c_k φ_k(f))` with real coefficients `c_k ~ N(0, σ_k²)`;
//! in a time history there is an offset too.

use nalgebra::Complex;

use super::calibration::{Form, SENSOR};
use crate::campaign::{Axis, Role};
use crate::discover::observe::{Evidence, Kind, Run, Series, Stimulus};
use crate::mean::mean;
use crate::model::{About, State};
use crate::transmissibility::Point;

/// The systematic errors of all sensors of the evidence.
#[derive(Clone, Debug, PartialEq)]
pub struct Nuisance {
    /// The sensors, references among them.
    pub sensors: Vec<Point>,
    /// The lowest and highest frequency of the polynomials, Hz.
    pub band: (f64, f64),
    /// What is suspected beside their calibration.
    pub suspects: Vec<Suspect>,
    /// The RMS value of what each sensor reads in all records; zero without any.
    pub reads: Vec<f64>,
    /// Sensors of records that are given no offset, and what of the model stands for it: a parameter or a state.
    pub without_offset: Vec<(Point, String)>,
    /// The states of a model with which records begin.
    pub beginnings: Vec<Beginning>,
}

/// A state of a model when a record begins: how far it is from where a sensor saw it, or from rest.
#[derive(Clone, Debug, PartialEq)]
pub struct Beginning {
    /// The run's file.
    pub run: String,
    /// The state's name in the model.
    pub state: String,
    /// Standard deviation before any measurement, in the unit of the state.
    pub sigma: f64,
}

/// An error that some sensors have in common: they are one device, or are read through one.
#[derive(Clone, Debug, PartialEq)]
pub struct Suspect {
    /// Places of the sensors in [`Nuisance::sensors`].
    pub sensors: Vec<usize>,
    /// How they are wrong.
    pub form: Form,
    /// Standard deviation of its coefficient before any measurement.
    pub sigma: f64,
}

impl Nuisance {
    /// One set of errors for each sensor of the evidence.
    pub fn of(evidence: &Evidence) -> Self {
        let references = evidence.runs.iter().filter_map(|run| run.stimulus.reference());
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
        Self {
            reads: sensors.iter().map(|sensor| reads(evidence, sensor)).collect(),
            without_offset: Vec::new(),
            sensors,
            band: (
                frequencies().fold(f64::INFINITY, f64::min),
                frequencies().fold(0.0, f64::max),
            ),
            suspects: Vec::new(),
            beginnings: Vec::new(),
        }
    }

    /// The same with the sensors of a location under suspicion, those of one axis or of all: an error of this form that
    /// they have in common may be of the size `sigma`. `None` where the evidence has no such sensor, or no other axis.
    pub fn suspecting(mut self, location: &str, axis: Option<Axis>, form: Form, sigma: f64) -> Option<Self> {
        let is_it = |sensor: &Point| sensor.location == location && axis.is_none_or(|axis| sensor.axis == axis);
        let sensors: Vec<usize> = (0..self.sensors.len()).filter(|&k| is_it(&self.sensors[k])).collect();
        let first = &self.sensors[*sensors.first()?];
        if axis.is_none() && sensors.iter().all(|&k| self.sensors[k].axis == first.axis) {
            return None;
        }
        self.suspects.push(Suspect { sensors, form, sigma });
        Some(self)
    }

    /// The same with the states with which this model begins the records that are fitted, in place of those of another.
    pub fn beginning(mut self, about: &About, evidence: &Evidence) -> Self {
        let fitted = evidence.runs.iter().filter(|run| run.role == Role::Fit);
        let of_run = |run: &Run| {
            let Stimulus::History { spread, .. } = &run.stimulus else {
                return Vec::new();
            };
            let states = about.states.iter();
            let beginning = |state: &State| {
                Some(Beginning {
                    run: run.name.clone(),
                    state: state.name.to_string(),
                    sigma: spread.sigma(state)?,
                })
            };
            states.filter_map(beginning).collect()
        };
        self.beginnings = fitted.flat_map(of_run).collect();
        self
    }

    /// Number of coefficients: [`SENSOR`] for each sensor in turn, one for each suspect, and one for each beginning.
    pub fn len(&self) -> usize {
        self.of_sensors() + self.beginnings.len()
    }

    /// Number of coefficients before those of the beginnings.
    pub fn of_sensors(&self) -> usize {
        self.of_calibration() + self.suspects.len()
    }

    /// Number of coefficients before those of the suspects.
    pub fn of_calibration(&self) -> usize {
        self.sensors.len() * SENSOR.len()
    }

    /// True without any sensor.
    pub fn is_empty(&self) -> bool {
        self.sensors.is_empty()
    }

    /// The standard deviation of each coefficient before any measurement.
    pub fn sigmas(&self) -> Vec<f64> {
        let priors = self.sensors.iter().flat_map(|_| SENSOR.map(|shape| shape.sigma));
        priors
            .chain(self.suspects.iter().map(|suspect| suspect.sigma))
            .chain(self.beginnings.iter().map(|beginning| beginning.sigma))
            .collect()
    }

    /// The place of a sensor's coefficient.
    pub(super) fn coefficient(&self, sensor: &Point, form: Form) -> Option<usize> {
        let place = self.sensors.iter().position(|s| s == sensor)?;
        let shape = SENSOR.iter().position(|shape| shape.form == form)?;
        Some(place * SENSOR.len() + shape)
    }

    /// The places of the suspects' coefficients of a form in which a sensor is.
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

/// The RMS value of what a sensor reads in all records.
fn reads(evidence: &Evidence, sensor: &Point) -> f64 {
    let is_it = |series: &&Series| {
        let holds_rest = evidence.runs[series.run].stimulus.holds_rest();
        series.kind == Kind::Time && series.sensor == *sensor && holds_rest
    };
    let records = evidence.series.iter().filter(is_it);
    rms(records.flat_map(|series| &series.value))
}

/// Root of the mean square; zero of nothing.
pub(super) fn rms<'a>(values: impl Iterator<Item = &'a Complex<f64>>) -> f64 {
    mean(values.map(Complex::norm_sqr)).sqrt()
}
