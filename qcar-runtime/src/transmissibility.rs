//! Transmissibilities with their uncertainty from the time histories of a run (thesis sections 2.6 and 3.4.4.2).
//!
//! The sensors of a location are averaged over the sides of the vehicle, the pads to the virtual centre pad. All
//! locations are related to one reference, the pad of a sweep or the force of a time history, and a transmissibility
//! between two of them is the ratio of their responses to it. Noise of the sensor in the denominator then increases the
//! variance of the result instead of its bias.

use std::fmt;
use std::path::PathBuf;

use nalgebra::Complex;

use crate::campaign::{Axis, Channel, History, Quantity, Recording, Side, Test};
use crate::error::{InputError, Place, Problem};
use crate::model::{self, About, Link, SignalKind};
use crate::spectrum::{self, Segments, Trend, Window};

// An estimate at one frequency.
mod line;
// Least squares over the lines of a spectrum.
mod regressors;
// Estimates from the whole record by local rational functions.
mod local;
// Estimates of each harmonic of a sweep.
pub mod harmonics;
// Averages over segments.
mod averaged;
// The law of a sweep.
mod law;
// The frequencies of the estimates.
mod band;

pub use band::logarithmic;
pub use line::Line;

/// A measured location: the sensors of all sides together, or those of one side alone.
#[derive(Clone, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Point {
    /// Location: `pad`, or a mass, link or input of the model.
    pub location: String,
    /// Axis.
    pub axis: Axis,
    /// Quantity.
    pub quantity: Quantity,
    /// Side of the location whose sensors these are; `None` for the mean of all sensors there.
    pub side: Option<Side>,
    /// True if the location turns about the axis.
    pub turns: bool,
}

impl Point {
    /// The mean of all sensors of a place that moves along the axis.
    pub fn new(location: &str, axis: Axis, quantity: Quantity) -> Self {
        let (location, side, turns) = (location.to_owned(), None, false);
        Point {
            location,
            axis,
            quantity,
            side,
            turns,
        }
    }

    /// The mean of all sensors like this one.
    pub fn of(sensor: &Channel) -> Self {
        let turns = sensor.turns;
        Point {
            turns,
            ..Point::new(&sensor.location, sensor.axis.clone(), sensor.quantity)
        }
    }

    /// The SI unit of its signal.
    pub fn unit(&self) -> &'static str {
        self.quantity.unit_of(self.turns)
    }

    /// The kind of the model's signal here: a displacement is the stretch of a link of this name, or a position.
    pub fn kind(&self, about: &About) -> SignalKind {
        let is_it = |link: &Link| link.name == self.location && link.axis == self.axis.name();
        match self.quantity {
            Quantity::Force => SignalKind::Force,
            Quantity::Displacement if about.links.iter().any(is_it) => SignalKind::Stretch,
            Quantity::Displacement => SignalKind::Motion(model::Quantity::Position),
            Quantity::Velocity => SignalKind::Motion(model::Quantity::Velocity),
            Quantity::Acceleration => SignalKind::Motion(model::Quantity::Acceleration),
        }
    }

    /// The same location with the sensors of one side alone.
    pub fn on(&self, side: Side) -> Self {
        let side = Some(side);
        Point { side, ..self.clone() }
    }

    /// The location, and its side.
    pub fn place(&self) -> String {
        let side = self.side.map_or(String::new(), |side| format!(" {}", side.name()));
        format!("{}{side}", self.location)
    }

    /// True if a sensor belongs to the point.
    pub fn has(&self, sensor: &Channel) -> bool {
        let stands_there = self.side.is_none_or(|side| sensor.side == side);
        let is_place = sensor.location == self.location && sensor.axis == self.axis;
        is_place && sensor.quantity == self.quantity && stands_there
    }

    /// The two ends as separate points if a run has sensors at both, otherwise the point itself; a part such as a
    /// sub-frame pitches if they move differently.
    pub fn ends(self, history: &History) -> Vec<Point> {
        let ends = [Side::Front, Side::Rear].map(|end| self.on(end));
        if ends.iter().all(|end| end.is_measured(history)) {
            ends.into()
        } else {
            vec![self]
        }
    }

    /// True if a run has a sensor of the point.
    pub fn is_measured(&self, history: &History) -> bool {
        history.signals.iter().any(|(sensor, _)| self.has(sensor))
    }
}

/// Estimators of frequency responses.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Estimator {
    /// Local rational functions on the spectrum of the whole record: without bias from segments, above all for sweeps.
    ///
    /// Response `(b₀ + b₁δ) / (1 + a₁δ)` and leakage transient `t₀ / (1 + a₁δ)` over the lines around each frequency,
    /// by linear least squares; their residual gives the variance. After McKelvey and Guérin, "Non-parametric frequency
    /// response estimation using a local rational model", IFAC SYSID 2012; Pintelon and Schoukens, "System
    /// Identification", 2nd ed., chapter 7, for the local polynomials that it extends.
    Local {
        /// Fewest lines on each side of a frequency.
        lines: usize,
        /// Half width of the neighbourhood relative to the frequency, if that contains more lines.
        width: f64,
    },
    /// H1 by averaging segments (Bendat and Piersol, "Random Data", 4th ed., chapters 6 and 9).
    ///
    /// For stationary excitation that is long against the response time of the system. A sweep passes a lightly damped
    /// mode too fast for it: with segments of 4 s the magnitude at a body mode is 4 to 9 % too low.
    Welch(Segments),
}

impl Estimator {
    /// Bias below 0.2 % and 0.2° at modes of 1.2 Hz with a damping ratio of 0.1 and 8 Hz with 0.05, in a sweep of 40 s
    /// from 0.5 to 30 Hz. Wider neighbourhoods have more bias and less noise.
    pub const LOCAL: Estimator = Estimator::Local { lines: 8, width: 0.03 };

    /// Hann segments of `seconds` at `rate` Hz with half overlap.
    pub fn welch(seconds: f64, rate: f64) -> Estimator {
        let length = ((seconds * rate).round() as usize).max(2);
        Estimator::Welch(Segments {
            length,
            overlap: length / 2,
            window: Window::Hann,
            trend: Trend::Constant,
        })
    }
}

/// Settings of the estimation.
#[derive(Clone, Debug, PartialEq)]
pub struct Options {
    /// Estimator.
    pub estimator: Estimator,
    /// Frequencies, Hz, increasing; by default 300 on a logarithmic scale over the sweep, or over the band that a time
    /// history excites. Segment averages are given at their own lines between the first and the last of these.
    pub frequencies: Option<Vec<f64>>,
}

impl Default for Options {
    fn default() -> Self {
        Options {
            estimator: Estimator::LOCAL,
            frequencies: None,
        }
    }
}

/// A measured frequency response `to / from` of one run.
#[derive(Clone, Debug, PartialEq)]
pub struct Transmissibility {
    /// File of the run.
    pub file: PathBuf,
    /// Denominator.
    pub from: Point,
    /// Numerator.
    pub to: Point,
    /// Frequencies, Hz.
    pub frequency: Vec<f64>,
    /// Values, in the ratio of the units of the points.
    pub value: Vec<Complex<f64>>,
    /// Variance `E|value - truth|²` of the complex value, half of it in each part.
    pub variance: Vec<f64>,
    /// Coherence: share of the power that the reference explains, the product for both points; 1 without noise.
    pub coherence: Vec<f64>,
}

/// All measured points of a run, in the order of its channels.
pub fn points(history: &History) -> Vec<Point> {
    let mut points = Vec::new();
    for (channel, _) in &history.signals {
        let point = Point::of(channel);
        if !points.contains(&point) {
            points.push(point);
        }
    }
    points
}

/// The mean signal of all sensors of a point: left and right, front and rear, or the one in the centre.
///
/// # Errors
/// Fails if the run recorded none.
pub fn signal(history: &History, point: &Point) -> Result<Vec<f64>, InputError> {
    let sensors: Vec<_> = history
        .signals
        .iter()
        .filter(|(channel, _)| point.has(channel))
        .collect();
    if sensors.is_empty() {
        let measured: Vec<_> = points(history).iter().map(Point::to_string).collect();
        let place = Place::Name(point.to_string());
        let remedy = "remove this, or add the channel to the run";
        return Err(Problem::new(&history.file, place, "no such channel", measured.join(", "), remedy).into());
    }
    let share = 1.0 / sensors.len() as f64;
    Ok((0..history.len())
        .map(|k| sensors.iter().map(|(_, samples)| samples[k]).sum::<f64>() * share)
        .collect())
}

/// Transmissibilities of a run for the pairs `(from, to)`, all estimated by way of `reference`, the excitation.
///
/// # Errors
/// Fails if a point was not measured, if a sensor is dead, if the reference does not move or does not reach the ends of
/// a sweep, or if the record is too short or its rate too low for the frequencies.
pub fn transmissibilities(
    history: &History,
    reference: &Point,
    pairs: &[(Point, Point)],
    options: &Options,
) -> Result<Vec<Transmissibility>, InputError> {
    let involved = pairs.iter().flat_map(|(from, to)| [from, to]);
    let related = Related::new(history, reference, involved, options)?;
    Ok(pairs.iter().map(|pair| related.ratio(history, pair)).collect())
}

/// Checks that the reference of a sweep does what the campaign states: that its frequency grows by the stated law from end
/// to end, and that it has the stated velocity.
///
/// # Errors
/// Fails if it does not, or if its record is too short for the sweep.
pub fn check_sweep(history: &History, reference: &Point) -> Result<(), InputError> {
    let excitation = signal(history, reference)?;
    law::check(history, reference, &excitation)?;
    let spectra = spectrum::transforms(&[excitation]);
    band::frequencies(history, reference, &spectra[0], &Options::default()).map(drop)
}

/// Points and their responses to the first of them.
pub struct Related {
    points: Vec<Point>,
    lines: Vec<Line>,
}

impl Related {
    /// Relates `points` to `reference`, which may be one of them.
    ///
    /// # Errors
    /// Fails as [`transmissibilities`] does.
    pub fn new<'a>(
        history: &History,
        reference: &Point,
        points: impl IntoIterator<Item = &'a Point>,
        options: &Options,
    ) -> Result<Self, InputError> {
        let mut involved = vec![reference.clone()];
        for point in points {
            if !involved.contains(point) {
                involved.push(point.clone());
            }
        }
        let lines = responses(history, &involved, options)?;
        let points = involved;
        Ok(Self { points, lines })
    }

    /// Response of a point to the reference, line by line; `None` for an unknown point.
    pub fn response<'a>(&'a self, point: &Point) -> Option<impl Iterator<Item = Complex<f64>> + use<'a>> {
        let place = self.place(point)?;
        Some(self.lines.iter().map(move |line| line.value[place]))
    }

    /// The ratio of two of the points, `(from, to)`.
    ///
    /// # Panics
    /// If one of them is unknown.
    pub fn ratio(&self, history: &History, pair: &(Point, Point)) -> Transmissibility {
        let place = |point: &Point| self.place(point).expect("it is among them");
        ratio(history, pair, (place(&pair.0), place(&pair.1)), &self.lines)
    }

    fn place(&self, point: &Point) -> Option<usize> {
        self.points.iter().position(|own| own == point)
    }
}

/// The responses of all `points` to the first of them, with their joint covariance.
///
/// # Errors
/// Fails as [`transmissibilities`] does.
pub fn responses(history: &History, points: &[Point], options: &Options) -> Result<Vec<Line>, InputError> {
    let signals = points
        .iter()
        .map(|point| signal(history, point))
        .collect::<Result<Vec<_>, _>>()?;
    let whole = match options.estimator {
        Estimator::Local { .. } => &signals[..],
        Estimator::Welch(_) => &signals[..1],
    };
    let spectra = spectrum::transforms(whole);
    law::check(history, &points[0], &signals[0])?;
    let frequencies = band::frequencies(history, &points[0], &spectra[0], options)?;
    check_alive(history, points)?;
    let (rate, spacing) = (history.sample_rate, history.sample_rate / history.len() as f64);
    let mut lines = match options.estimator {
        Estimator::Local { lines, width } => local::lines(&spectra, spacing, &frequencies, lines, width),
        Estimator::Welch(segments) => averaged::lines(&signals, rate, &frequencies, &segments),
    };
    if let Test::TimeHistory(Recording {
        band_limited: false, ..
    }) = history.test
    {
        lines
            .iter_mut()
            .for_each(|line| line.release(hold(line.frequency / rate)));
    }
    Ok(lines)
}

/// A constant sensor is dead, and would halve the mean of its pair.
fn check_alive(history: &History, points: &[Point]) -> Result<(), InputError> {
    let involved = |channel: &Channel| points.iter().any(|point| point.has(channel));
    let recorded = history.signals.iter().filter(|(channel, _)| involved(channel));
    let dead = recorded.filter(|(_, samples)| samples.iter().all(|sample| *sample == samples[0]));
    let problem = |channel: &Channel| {
        let place = Place::Name(channel.name.clone());
        let remedy = "remove the column if its sensor was dead, or export the record again";
        Problem::new(
            &history.file,
            place,
            "a signal that never changes",
            "a measurement",
            remedy,
        )
    };
    InputError::unless_empty(dead.map(|(channel, _)| problem(channel)).collect(), Some(()))
}

/// Response of a zero-order hold to the sampled signal, at `f` relative to the sample rate.
///
/// Images above half the sample rate are neglected, since second-order systems suppress them.
fn hold(f: f64) -> Complex<f64> {
    let half = std::f64::consts::PI * f;
    Complex::from_polar(if half == 0.0 { 1.0 } else { half.sin() / half }, -half)
}

fn ratio(history: &History, pair: &(Point, Point), (from, to): (usize, usize), lines: &[Line]) -> Transmissibility {
    Transmissibility {
        file: history.file.clone(),
        from: pair.0.clone(),
        to: pair.1.clone(),
        frequency: lines.iter().map(|line| line.frequency).collect(),
        value: lines.iter().map(|line| line.ratio(to, from)).collect(),
        variance: lines.iter().map(|line| line.ratio_variance(to, from)).collect(),
        coherence: lines
            .iter()
            .map(|line| line.coherence[to] * line.coherence[from])
            .collect(),
    }
}

impl fmt::Display for Point {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(out, "{} {} {}", self.place(), self.axis.name(), self.quantity.name())
    }
}
