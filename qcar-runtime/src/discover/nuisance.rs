//! What sensors may be wrong by, in all runs alike: unknowns of their own, held by a prior.
//!
//! A calibrated accelerometer is off by 0.5 to 1 % in gain and by a few tenths of a degree in phase, smoothly in
//! frequency. Taken as noise, such an error would look like a hundred independent proofs of some small effect; taken as
//! an unknown of the sensor, it is estimated along with the parameters, and only what no calibration can explain is a
//! gap. The error of a sensor is `exp(Σ_k c_k φ_k(f))` with real coefficients `c_k ~ N(0, σ_k²)`;
//! in a time history there is an offset too.

use std::collections::BTreeMap;
use std::f64::consts::TAU;

use nalgebra::Complex;

use super::observe::{Evidence, Kind, Misread, Prediction, Run, Series, Stimulus};
use crate::campaign::{Axis, Role};
use crate::model::{About, State};
use crate::transmissibility::Point;

/// A way in which a sensor may be wrong.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shape {
    /// What it is.
    pub form: Form,
    /// Standard deviation of its coefficient before any measurement.
    pub sigma: f64,
}

/// The form of an error over frequency.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Form {
    /// Gain: the Chebyshev polynomial of this degree in the logarithm of frequency, 1 being its amplitude.
    Gain(usize),
    /// Phase, rad, in the same polynomials.
    Phase(usize),
    /// A delay, s.
    Delay,
    /// What the sensor of a time history reads at zero, relative to the RMS value of what it reads.
    Offset,
}

/// Prior of a sensor: 0.7 % of gain in all, its half in what varies with frequency; 0.2° of phase and 50 µs of delay; a
/// tenth of what is read for the offset of a history.
///
/// Thesis section 3.4 has capacitive accelerometers; their data sheets give 0.5 to 1 % of gain and the phase of a
/// first-order filter at several hundred hertz.
pub const SENSOR: [Shape; 7] = [
    Shape {
        form: Form::Gain(0),
        sigma: 0.007,
    },
    Shape {
        form: Form::Gain(1),
        sigma: 0.0035,
    },
    Shape {
        form: Form::Gain(2),
        sigma: 0.0025,
    },
    Shape {
        form: Form::Gain(3),
        sigma: 0.0015,
    },
    Shape {
        form: Form::Phase(0),
        sigma: 0.003,
    },
    Shape {
        form: Form::Delay,
        sigma: 5e-5,
    },
    Shape {
        form: Form::Offset,
        sigma: 0.1,
    },
];

/// The most that a calibration is wrong by, in standard deviations of its prior. What is beyond is a fault of the sensor:
/// a gap, which has to be explained.
///
/// Two sensors that are compared may both be wrong, so that a ratio of them is allowed twice as much.
pub const STRAINED: f64 = 2.0;

/// A predicted series as a sensor with errors shows it.
#[derive(Clone, Debug, PartialEq)]
pub struct Shown {
    /// The values.
    pub value: Vec<Complex<f64>>,
    /// By how much the prediction counts in each of them.
    pub factor: Vec<Complex<f64>>,
    /// Their derivatives along the coefficients, by place.
    pub slopes: Vec<(usize, Vec<Complex<f64>>)>,
}

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

    /// How late the sensor of each series is against what drove its run, where that is no phase, and how much harder each
    /// run was driven than its reference shows: in proportion to the amplitude nothing would come of that, but laws bend.
    pub fn misread(&self, evidence: &Evidence, coefficients: &[f64]) -> Misread {
        let late = |series: &Series| {
            let delays = self.late_by(evidence, series).into_iter();
            delays.map(|(k, times)| times * coefficients[k]).sum()
        };
        let louder = |run: &Run| {
            let gains = self.reference_gains(run);
            (-gains.map(|k| coefficients[k]).sum::<f64>()).exp()
        };
        let begun = |run: &Run| {
            let own = self.beginnings_of(run);
            own.map(|(k, own)| (own.state.clone(), coefficients[k])).collect()
        };
        Misread {
            late: evidence.series.iter().map(late).collect(),
            louder: evidence.runs.iter().map(louder).collect(),
            begun: evidence.runs.iter().map(begun).collect(),
        }
    }

    /// The derivatives of a prediction along the coefficients by which it is misread, by place.
    pub fn misread_slopes(&self, evidence: &Evidence, prediction: &Prediction) -> Vec<(usize, Vec<Complex<f64>>)> {
        let mut slopes = self.delays(evidence, prediction);
        let run = &evidence.runs[evidence.series[prediction.series].run];
        for (k, own) in self.beginnings_of(run) {
            let slope = prediction.begun.iter().find(|(state, _)| *state == own.state);
            slopes.extend(slope.map(|(_, slope)| (k, slope.clone())));
        }
        if let Some(louder) = &prediction.louder {
            let along = |k| (k, louder.iter().map(|slope| -slope).collect());
            slopes.extend(self.reference_gains(run).map(along));
        }
        slopes
    }

    /// The coefficients of the states with which a run begins.
    fn beginnings_of(&self, run: &Run) -> impl Iterator<Item = (usize, &Beginning)> {
        let first = self.of_sensors();
        let all = self.beginnings.iter().enumerate();
        all.filter(|(_, own)| own.run == run.name)
            .map(move |(k, own)| (first + k, own))
    }

    /// The coefficients of the mean gain of a run's reference.
    fn reference_gains(&self, run: &Run) -> impl Iterator<Item = usize> {
        let of = |sensor| {
            let own = self.coefficient(sensor, Form::Gain(0));
            own.into_iter().chain(self.suspected(sensor, Form::Gain(0)))
        };
        run.stimulus.reference().into_iter().flat_map(of)
    }

    /// The derivatives of a prediction along the coefficients that make its series late, by place.
    fn delays(&self, evidence: &Evidence, prediction: &Prediction) -> Vec<(usize, Vec<Complex<f64>>)> {
        let Some(delay) = &prediction.delay else {
            return Vec::new();
        };
        let mut times: BTreeMap<usize, f64> = BTreeMap::new();
        let shifts = delay.shares.iter().map(|&(series, share)| (series, -share));
        for (series, share) in std::iter::once((prediction.series, 1.0)).chain(shifts) {
            for (k, by) in self.late_by(evidence, &evidence.series[series]) {
                *times.entry(k).or_default() += share * by;
            }
        }
        let along = |(k, times): (usize, f64)| (k, delay.slope.iter().map(|slope| slope * times).collect());
        times.into_iter().map(along).collect()
    }

    /// The coefficients that make a series late over time, and how many times.
    fn late_by(&self, evidence: &Evidence, series: &Series) -> Vec<(usize, f64)> {
        let prior = || self.coefficient(&series.sensor, Form::Delay).map(|k| (k, 1.0));
        let suspects = |sensor, times| self.suspected(sensor, Form::Delay).map(move |k| (k, times));
        match (series.kind, &evidence.runs[series.run].stimulus) {
            (Kind::Passage, _) => prior().into_iter().chain(suspects(&series.sensor, 1.0)).collect(),
            // Of several inputs each would have to be shifted for itself.
            (Kind::Time, Stimulus::History { inputs, .. }) if inputs.signals.len() == 1 => {
                let input = suspects(&inputs.signals[0].0, -1.0);
                suspects(&series.sensor, 1.0).chain(input).collect()
            }
            (Kind::Time, _) => suspects(&series.sensor, 1.0).collect(),
            (Kind::Harmonic(_) | Kind::Travel | Kind::Width | Kind::Cycle(_), _) => Vec::new(),
        }
    }

    /// The place of a sensor's coefficient.
    fn coefficient(&self, sensor: &Point, form: Form) -> Option<usize> {
        let place = self.sensors.iter().position(|s| s == sensor)?;
        let shape = SENSOR.iter().position(|shape| shape.form == form)?;
        Some(place * SENSOR.len() + shape)
    }

    /// The places of the suspects' coefficients of a form in which a sensor is.
    fn suspected(&self, sensor: &Point, form: Form) -> impl Iterator<Item = usize> {
        let place = self.sensors.iter().position(|s| s == sensor);
        let is_it =
            move |suspect: &Suspect| suspect.form == form && place.is_some_and(|k| suspect.sensors.contains(&k));
        let suspects = self.suspects.iter().enumerate();
        suspects
            .filter(move |(_, s)| is_it(s))
            .map(|(k, _)| self.of_calibration() + k)
    }

    /// What a sensor with errors of these coefficients shows of a predicted series.
    pub fn show(&self, evidence: &Evidence, series: &Series, value: &[Complex<f64>], coefficients: &[f64]) -> Shown {
        let logarithmic = self.slopes(evidence, series);
        let mut exponent = vec![Complex::ZERO; value.len()];
        for (k, slope) in &logarithmic {
            exponent
                .iter_mut()
                .zip(slope)
                .for_each(|(sum, slope)| *sum += slope * coefficients[*k]);
        }
        let factor: Vec<Complex<f64>> = exponent.into_iter().map(|exponent| exponent.exp()).collect();
        let scaled: Vec<Complex<f64>> = value
            .iter()
            .zip(&factor)
            .map(|(value, factor)| value * factor)
            .collect();
        let along = |slope: Vec<Complex<f64>>| slope.iter().zip(&scaled).map(|(slope, value)| slope * value).collect();
        let mut slopes: Vec<_> = logarithmic.into_iter().map(|(k, slope)| (k, along(slope))).collect();
        let offset = self.offset(evidence, series);
        let added = offset.map_or(0.0, |(k, unit)| unit * coefficients[k]);
        slopes.extend(offset.map(|(k, unit)| (k, vec![Complex::from(unit); value.len()])));
        Shown {
            value: scaled.iter().map(|value| value + added).collect(),
            factor,
            slopes,
        }
    }

    /// The coefficient of an offset, and what one of it adds: a record has it of its sensor, a K&C curve one of its own size.
    fn offset(&self, evidence: &Evidence, series: &Series) -> Option<(usize, f64)> {
        if !evidence.runs[series.run].stimulus.holds_rest() {
            return None;
        }
        let place = self.coefficient(&series.sensor, Form::Offset)?;
        let unit = match series.kind {
            Kind::Time if self.without_offset.iter().any(|(sensor, _)| *sensor == series.sensor) => return None,
            Kind::Time => self.reads[place / SENSOR.len()],
            Kind::Travel => rms(series.value.iter()),
            _ => return None,
        };
        Some((place, unit))
    }

    /// What the sensors of records read at zero, with standard errors (NaN where nothing tells it), by coefficients and
    /// theirs; SI.
    pub fn offsets(&self, coefficients: &[f64], stderr: &[f64]) -> Vec<(Point, f64, f64)> {
        let records = self.sensors.iter().zip(&self.reads);
        let records = records.filter(|(sensor, reads)| {
            let is_it = |(own, _): &(Point, String)| own == *sensor;
            **reads > 0.0 && !self.without_offset.iter().any(is_it)
        });
        let offset = |(sensor, reads): (&Point, &f64)| {
            let k = self.coefficient(sensor, Form::Offset)?;
            Some((sensor.clone(), reads * coefficients[k], reads * stderr[k]))
        };
        records.filter_map(offset).collect()
    }

    /// For each value of a series, what each of the coefficients adds to its logarithm.
    ///
    /// Response and reference are read at their own frequencies: `order` times that of the excitation, and that.
    fn slopes(&self, evidence: &Evidence, series: &Series) -> Vec<(usize, Vec<Complex<f64>>)> {
        let constant = |k: usize| (k, vec![Complex::ONE; series.at.len()]);
        match series.kind {
            Kind::Harmonic(order) => {
                let mut slopes = self.of_sensor(&series.sensor, series, 1.0, order as f64);
                let reference = evidence.runs[series.run].stimulus.reference();
                slopes.extend(reference.map_or_else(Vec::new, |point| self.of_sensor(point, series, -1.0, 1.0)));
                slopes
            }
            // Over a wide band the mean gain is what counts.
            Kind::Passage | Kind::Travel | Kind::Width | Kind::Cycle(_) => {
                let own = self.coefficient(&series.sensor, Form::Gain(0));
                own.into_iter()
                    .chain(self.suspected(&series.sensor, Form::Gain(0)))
                    .map(constant)
                    .collect()
            }
            // Driven by what was recorded, a gain is what parameters are too: that of a calibration stays with the
            // uncertainty of the values.
            Kind::Time => self.suspected(&series.sensor, Form::Gain(0)).map(constant).collect(),
        }
    }

    /// Of the errors of one sensor, read at so many times the frequency of the series.
    fn of_sensor(&self, sensor: &Point, series: &Series, sign: f64, times: f64) -> Vec<(usize, Vec<Complex<f64>>)> {
        let factors = SENSOR
            .iter()
            .map(|shape| shape.form)
            .filter(|&form| form != Form::Offset);
        let own = factors.filter_map(|form| Some((self.coefficient(sensor, form)?, form)));
        let suspects = [Form::Gain(0), Form::Delay]
            .into_iter()
            .flat_map(|form| self.suspected(sensor, form).map(move |k| (k, form)));
        let column = |(k, form): (usize, Form)| {
            let slope = series.at.iter().map(|&at| sign * self.shape(form, times * at));
            (k, slope.collect())
        };
        own.chain(suspects).map(column).collect()
    }

    fn shape(&self, form: Form, f: f64) -> Complex<f64> {
        match form {
            Form::Gain(degree) => Complex::from(self.chebyshev(degree, f)),
            Form::Phase(degree) => Complex::I * self.chebyshev(degree, f),
            Form::Delay => -Complex::I * TAU * f,
            Form::Offset => unreachable!("an offset is no factor"),
        }
    }

    fn chebyshev(&self, degree: usize, f: f64) -> f64 {
        let (first, last) = self.band;
        let u = (2.0 * (f / first).ln() / (last / first).ln().max(f64::MIN_POSITIVE) - 1.0).clamp(-1.0, 1.0);
        (degree as f64 * u.acos()).cos()
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
fn rms<'a>(values: impl Iterator<Item = &'a Complex<f64>>) -> f64 {
    let (power, count) = values.fold((0.0, 0), |(power, count), value| (power + value.norm_sqr(), count + 1));
    (power / f64::from(count.max(1))).sqrt()
}
