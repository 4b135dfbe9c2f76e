//! All metrics of a model: of rides over courses, of transmissibilities and of modes.

use std::collections::BTreeSet;

use rayon::current_num_threads;
use rayon::prelude::*;

use super::course::Course;
use super::name::{Measure, Metric, What, metrics};
use super::record::{FilteredRecord, Impact};
use super::travel::WithTravel;
use super::vibration::Vibrations;
use crate::campaign::RoleNames;
use crate::free_motions::growing;
use crate::model::{About, Model, Quantity, Signal, SignalKind};
use crate::modes::{are_equal, dynamics, vibrations};
use crate::resonance::{self, Peak};
use crate::response::parameters::Values;
use crate::response::signal::driver;
use crate::roles::Roles;
use crate::simulate::{
    Car, RecordedSignals, Ride, RideCase, Settings, SimulateError, Tangent, Variant, ride, rides_abreast, tangent,
};
use crate::tyre::Tyre;

/// The roads and channels on which the metrics of a model are computed.
pub struct Ground<'a> {
    model: WithTravel<'a>,
    /// The tyre and its static load, N; `None` if no road is driven.
    tyre: Option<(Tyre, f64)>,
    courses: Vec<Course>,
    metrics: Vec<Metric>,
    readings: Vec<Reading>,
    /// Position of the output that responds to an obstacle first.
    wheel: Option<usize>,
    impossible: Option<Box<Impossible<'a>>>,
    settings: Settings,
}

/// Why parameters are not physical; `None` if they are.
type Impossible<'a> = dyn Fn(&[f64]) -> Option<String> + Send + Sync + 'a;

/// Accelerations of a ride.
#[derive(Clone, Debug, PartialEq)]
pub struct Trace {
    /// Time at which the wheel reaches the obstacle, s.
    pub onset: f64,
    /// Acceleration of each mass, m/s².
    pub accelerations: Vec<(Signal, Vec<f64>)>,
}

/// One metric on one run.
#[derive(Clone, Debug, PartialEq)]
pub struct Reading {
    /// Position of the metric.
    pub metric: usize,
    /// Index of the course, for metrics of rides.
    pub course: Option<usize>,
}

/// Values of readings and their derivatives.
#[derive(Clone, Debug, PartialEq)]
pub struct Slopes {
    /// The value of each reading.
    pub values: Vec<f64>,
    /// For each reading, its derivative along each direction.
    pub slopes: Vec<Vec<f64>>,
}

/// Reason why a design has no value of a metric.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[expect(missing_docs, reason = "the message says it")]
pub enum MetricError {
    #[error("{reason}")]
    Impossible { reason: String },
    #[error("run `{course}`: {reason}")]
    Ride { course: String, reason: SimulateError },
    #[error(
        "run `{course}`: the wheel has no upward peak, or the record ends within 0.1 s of it; drive over an obstacle for longer"
    )]
    NoImpact { course: String },
    #[error("`{metric}`: the model has {found} modes with these parameters")]
    NoVibration { metric: String, found: usize },
    #[error("`{metric}`: no input drives this channel")]
    NotDriven { metric: String },
    #[error(
        "`{metric}`: the mode at {frequency:.4} Hz is undamped, so the channel is infinite there; give the mode damping"
    )]
    Undamped { metric: String, frequency: f64 },
}

impl<'a> Ground<'a> {
    /// A ground without readings; [`Ground::choose`] sets them.
    ///
    /// `values` determine the number of modes.
    pub fn new(
        model: &'a dyn Model,
        values: &Values,
        names: &RoleNames,
        tyre: Option<(Tyre, f64)>,
        courses: Vec<Course>,
    ) -> Self {
        let model = WithTravel::new(model, names);
        let mut metrics = metrics(model.about(), vibrations(&dynamics(&model, values.as_slice())).len());
        metrics.retain(|metric| tyre.is_some() || !metric.what.is_ridden());
        let wheel = Roles::of(model.about(), names)
            .ok()
            .and_then(|roles| felt_first(model.about(), &roles));
        Self {
            model,
            tyre,
            courses,
            metrics,
            readings: Vec::new(),
            wheel,
            impossible: None,
            settings: Settings::default(),
        }
    }

    /// Simulates rides with these settings instead of the default ones.
    #[must_use]
    pub fn riding(mut self, settings: Settings) -> Self {
        self.settings = settings;
        self
    }

    /// Refuses parameter sets for which `impossible` gives a reason.
    #[must_use]
    pub fn refusing(mut self, impossible: impl Fn(&[f64]) -> Option<String> + Send + Sync + 'a) -> Self {
        self.impossible = Some(Box::new(impossible));
        self
    }

    /// All metrics that the model has.
    pub fn metrics(&self) -> &[Metric] {
        &self.metrics
    }

    /// The courses that are driven.
    pub fn courses(&self) -> &[Course] {
        &self.courses
    }

    /// The description of the model, including the added output.
    pub fn about(&self) -> &About {
        self.model.about()
    }

    /// The readings, in the order of the results.
    pub fn readings(&self) -> &[Reading] {
        &self.readings
    }

    /// Sets the readings to measure.
    pub fn choose(&mut self, readings: Vec<Reading>) {
        self.readings = readings;
    }

    /// The readings of a metric: one for each course; for a metric of an impact, one for each course with an obstacle.
    pub fn readings_of(&self, metric: usize) -> Vec<Reading> {
        let of_impact = matches!(
            self.metrics[metric].what,
            What::Ride(_, Measure::Peak | Measure::AfterShake)
        );
        if !self.metrics[metric].what.is_ridden() {
            return vec![Reading { metric, course: None }];
        }
        let courses = self.courses.iter().enumerate();
        let fitting = courses.filter(|(_, course)| course.obstacle || !of_impact);
        fitting
            .map(|(place, _)| Reading {
                metric,
                course: Some(place),
            })
            .collect()
    }

    /// The value of each reading.
    ///
    /// # Errors
    /// Fails if the parameters are refused, if a ride fails, or if a metric has no value with these parameters.
    pub fn measure(&self, values: &Values) -> Result<Vec<f64>, MetricError> {
        Ok(self.measure_with(values, &[])?.values)
    }

    /// The value of each reading, and its derivative along each direction. A direction has an entry for every
    /// parameter; the entry of a tied parameter is zero or that of its leader.
    ///
    /// # Errors
    /// Fails as [`Ground::measure`] does.
    pub fn measure_with(&self, values: &Values, directions: &[Vec<f64>]) -> Result<Slopes, MetricError> {
        self.check_possible(values)?;
        let courses = self.ridden_courses();
        let ridden: Result<Vec<Signals>, MetricError> = if directions.is_empty() {
            let each = courses.len().div_ceil(current_num_threads()).max(1);
            let parts = courses.par_chunks(each);
            let some =
                |courses: &[usize]| self.drive_abreast(&courses.iter().map(|&own| (values, own)).collect::<Vec<_>>());
            parts.flat_map_iter(some).collect()
        } else {
            let one = |&course: &usize| self.drive(values, course, directions);
            courses.par_iter().map(one).collect()
        };
        self.read(values, &courses, ridden?, directions)
    }

    /// [`Ground::measure`] for several designs, whose rides are simulated side by side on this thread.
    pub fn measure_all(&self, designs: &[Values]) -> Vec<Result<Vec<f64>, MetricError>> {
        let courses = self.ridden_courses();
        let possible: Vec<_> = designs.iter().map(|values| self.check_possible(values)).collect();
        let ridable = designs.iter().zip(&possible).filter(|(_, possible)| possible.is_ok());
        let runs: Vec<_> = ridable
            .flat_map(|(values, _)| courses.iter().map(move |&course| (values, course)))
            .collect();
        let mut ridden = self.drive_abreast(&runs).into_iter();
        let measured = designs.iter().zip(possible).map(|(values, possible)| {
            possible?;
            // Takes all rides of a design from the iterator, even if one of them failed.
            let own: Vec<_> = ridden.by_ref().take(courses.len()).collect();
            let own = own.into_iter().collect::<Result<_, _>>()?;
            Ok(self.read(values, &courses, own, &[])?.values)
        });
        measured.collect()
    }

    fn check_possible(&self, values: &Values) -> Result<(), MetricError> {
        let reason = self.impossible.as_ref().and_then(|why| why(values.as_slice()));
        reason.map_or(Ok(()), |reason| Err(MetricError::Impossible { reason }))
    }

    /// Why a metric that needs no ride has no value with these parameters.
    ///
    /// # Errors
    /// Fails as [`Ground::measure`] does.
    pub fn check_at_rest(&self, values: &Values, metric: usize) -> Result<(), MetricError> {
        let own = &self.metrics[metric];
        match own.what {
            What::Peak(_) | What::PeakFrequency(_) => AtRest::new(self, values, &[]).find(self, values, own).map(drop),
            What::Ride(..) | What::Frequency(_) | What::Damping(_) => Ok(()),
        }
    }

    /// The metrics of modes whose eigenvalue is that of another mode too. They have no derivatives, because a change may
    /// part both.
    pub fn of_equal_modes(&self, values: &Values) -> Vec<usize> {
        let roots = vibrations(&dynamics(&self.model, values.as_slice()));
        let is_repeated = |place: usize| {
            let mut others = (0..roots.len()).filter(|&other| other != place);
            place < roots.len() && others.any(|other| are_equal(roots[place], roots[other]))
        };
        let of_mode = |metric: &usize| match self.metrics[*metric].what {
            What::Frequency(place) | What::Damping(place) => is_repeated(place),
            What::Ride(..) | What::Peak(_) | What::PeakFrequency(_) => false,
        };
        (0..self.metrics.len()).filter(of_mode).collect()
    }

    /// True if a motion of the model at rest grows with these parameters.
    pub fn is_unstable(&self, values: &Values) -> bool {
        growing(&self.model, values).is_some()
    }

    /// The courses of all readings.
    fn ridden_courses(&self) -> Vec<usize> {
        let courses: BTreeSet<usize> = self.readings.iter().filter_map(|reading| reading.course).collect();
        courses.into_iter().collect()
    }

    /// The readings, from the signals of each course.
    fn read(
        &self,
        values: &Values,
        courses: &[usize],
        ridden: Vec<Signals>,
        directions: &[Vec<f64>],
    ) -> Result<Slopes, MetricError> {
        let at_rest = AtRest::new(self, values, directions);
        let mut found = Slopes {
            values: Vec::new(),
            slopes: Vec::new(),
        };
        for reading in &self.readings {
            let (value, slopes) = match (self.metrics[reading.metric].what, reading.course) {
                (What::Ride(signal, measure), Some(course)) => {
                    let place = courses.iter().position(|own| *own == course);
                    let signals = &ridden[place.expect("every course is ridden")];
                    let seen = FilteredRecord::new(measure, &signals.values[signal], signals.rate, &signals.impact);
                    let slope = |slopes: &Vec<Vec<f64>>| seen.slope(&slopes[signal], &signals.impact);
                    (seen.value(), signals.slopes.iter().map(slope).collect())
                }
                _ => at_rest.find(self, values, &self.metrics[reading.metric])?,
            };
            found.values.push(value);
            found.slopes.push(slopes);
        }
        Ok(found)
    }

    /// The signals of several parameter sets, each on a course.
    fn drive_abreast(&self, runs: &[(&Values, usize)]) -> Vec<Result<Signals, MetricError>> {
        let mut found: Vec<_> = runs.iter().map(|_| None).collect();
        let (Some(&(values, _)), Some(_)) = (runs.first(), self.tyre) else {
            return Vec::new();
        };
        let car = self.car(values);
        let ridden = runs
            .iter()
            .map(|&(values, course)| (values.as_slice(), self.courses[course].drive()));
        let ridden: Vec<RideCase<'_>> = ridden.collect();
        let done = |number: usize, ride: Result<Ride, SimulateError>| {
            let course = &self.courses[runs[number].1];
            found[number] = Some(self.signals(course, ride.map(|ride| self.tangent_of(ride))));
        };
        rides_abreast(&car, &ridden, &self.settings, &self.kept(), done);
        found.into_iter().map(|own| own.expect("each ride ends")).collect()
    }

    /// The outputs that readings need, and the one that determines the onset of an impact.
    fn kept(&self) -> RecordedSignals {
        let is_kept = |output: usize| self.reads(output) || self.wheel == Some(output);
        let about = self.car_model().about();
        RecordedSignals {
            outputs: (0..about.outputs.len()).map(is_kept).collect(),
            force: self.reads(self.model.about().outputs.len()),
            area: false,
        }
    }

    fn drive(&self, values: &Values, course: usize, directions: &[Vec<f64>]) -> Result<Signals, MetricError> {
        let course = &self.courses[course];
        let (car, drive) = (self.car(values), course.drive());
        let found = if directions.is_empty() {
            ride(&car, &drive, &self.settings).map(|ride| self.tangent_of(ride))
        } else {
            tangent(&car, &drive, &self.settings, directions).map(|tangent| self.with_added(tangent))
        };
        self.signals(course, found)
    }

    fn signals(&self, course: &Course, found: Result<Tangent, SimulateError>) -> Result<Signals, MetricError> {
        let name = || course.name.clone();
        let Tangent { signals, slopes } = found.map_err(|reason| MetricError::Ride { course: name(), reason })?;
        let impact = match self.wheel {
            _ if !course.obstacle => Some(Impact::none(course.samples)),
            Some(wheel) => Impact::of(&signals[wheel], course.sample_rate),
            None => None,
        };
        Ok(Signals {
            values: signals,
            slopes,
            impact: impact.ok_or_else(|| MetricError::NoImpact { course: name() })?,
            rate: course.sample_rate,
        })
    }

    /// The position of the added output if no reading uses it. All other outputs are rates of states, which cost
    /// nothing.
    fn unasked(&self) -> Option<usize> {
        self.model.added().filter(|added| !self.reads(*added))
    }

    fn car_model(&self) -> &dyn Model {
        match self.unasked() {
            Some(_) => self.model.inner(),
            None => &self.model,
        }
    }

    fn car<'v>(&'v self, values: &'v Values) -> Car<'v, dyn Model + 'v> {
        let (tyre, load) = self.tyre.expect("what is ridden has a tyre");
        Car {
            model: self.car_model(),
            parameters: values.as_slice(),
            tyre,
            load,
            variant: Variant::Complete,
        }
    }

    /// The signals of a ride: outputs, then the force of the tyre.
    fn tangent_of(&self, ride: Ride) -> Tangent {
        let [vertical, _] = ride.force;
        self.with_added(Tangent {
            signals: ride.outputs.into_iter().chain([vertical]).collect(),
            slopes: Vec::new(),
        })
    }

    /// Inserts an empty signal for the added output if it was not simulated.
    fn with_added(&self, mut found: Tangent) -> Tangent {
        if let Some(added) = self.unasked() {
            let all = found.slopes.iter_mut().chain([&mut found.signals]);
            all.for_each(|own| own.insert(added, Vec::new()));
        }
        found
    }

    /// Accelerations of each mass on a course.
    ///
    /// # Errors
    /// Fails as [`Ground::measure`] does.
    pub fn trace(&self, values: &Values, course: usize) -> Result<Trace, MetricError> {
        let signals = self.drive(values, course, &[])?;
        let outputs = self.about().outputs.iter().zip(signals.values);
        let accelerations = outputs.filter(|(own, _)| own.signal.kind == SignalKind::Motion(Quantity::Acceleration));
        Ok(Trace {
            onset: signals.impact.onset as f64 / signals.rate,
            accelerations: accelerations
                .map(|(own, values)| (own.signal.clone(), values))
                .collect(),
        })
    }

    /// True if a reading needs an output.
    fn reads(&self, output: usize) -> bool {
        let what = |reading: &Reading| self.metrics[reading.metric].what;
        self.readings
            .iter()
            .any(|own| matches!(what(own), What::Ride(of, _) if of == output))
    }
}

/// The output that responds to an obstacle first: the acceleration of the wheel, else that of the next mass.
fn felt_first(about: &About, roles: &Roles) -> Option<usize> {
    let place = |mass: &str| {
        let signal = Signal {
            location: mass.to_string().into(),
            axis: roles.axis.clone().into(),
            kind: SignalKind::Motion(Quantity::Acceleration),
        };
        about.outputs.iter().position(|output| output.signal == signal)
    };
    roles.feeling().find_map(place)
}

/// The results of a ride.
struct Signals {
    values: Vec<Vec<f64>>,
    /// For each direction, the derivative of each signal.
    slopes: Vec<Vec<Vec<f64>>>,
    impact: Impact,
    rate: f64,
}

/// Readings that need no ride.
struct AtRest<'d> {
    directions: &'d [Vec<f64>],
    /// `None` if no reading is that of a mode.
    vibrations: Option<Vibrations<'d>>,
}

impl<'d> AtRest<'d> {
    fn new(ground: &Ground<'_>, values: &Values, directions: &'d [Vec<f64>]) -> Self {
        let number = |reading: &Reading| match ground.metrics[reading.metric].what {
            What::Frequency(place) | What::Damping(place) => Some(place + 1),
            _ => None,
        };
        let highest = ground.readings.iter().filter_map(number).max();
        let up_to = |count: usize| Vibrations::of(&ground.model, values.as_slice(), count, directions);
        Self {
            directions,
            vibrations: highest.map(up_to),
        }
    }

    fn find(&self, ground: &Ground<'_>, values: &Values, metric: &Metric) -> Result<(f64, Vec<f64>), MetricError> {
        let directions = self.directions;
        let vibration = |place: usize, which: usize| {
            let own = self.vibrations.as_ref().and_then(|all| all.mode(place));
            let (value, slopes) = own.ok_or_else(|| MetricError::NoVibration {
                metric: metric.name.clone(),
                found: self.vibrations.as_ref().map_or(0, Vibrations::count),
            })?;
            Ok((value[which], slopes.iter().map(|slope| slope[which]).collect()))
        };
        let resonance = |channel: usize, which: usize| {
            let channel = &ground.about().channels[channel];
            let survey = driver(ground.about(), channel).map(|own| resonance::survey(&ground.model, values, own));
            let (ends, wanted) = ([&channel.numerator, &channel.denominator], !directions.is_empty());
            let own = survey.and_then(|survey| resonance::highest(&survey, values, ends, wanted));
            let metric = metric.name.clone();
            let own = match own {
                Some(Peak::Finite(own)) => own,
                Some(Peak::Infinite(frequency)) => return Err(MetricError::Undamped { metric, frequency }),
                None => return Err(MetricError::NotDriven { metric }),
            };
            let along = |direction: &Vec<f64>| own.slopes.iter().map(|(k, slope)| slope[which] * direction[*k]).sum();
            Ok((own.value[which], directions.iter().map(along).collect()))
        };
        match metric.what {
            What::Frequency(place) => vibration(place, 0),
            What::Damping(place) => vibration(place, 1),
            What::Peak(channel) => resonance(channel, 0),
            What::PeakFrequency(channel) => resonance(channel, 1),
            What::Ride(..) => unreachable!("a ride has a course"),
        }
    }
}
