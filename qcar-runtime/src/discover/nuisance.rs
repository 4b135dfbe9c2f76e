//! What sensors may be wrong by, in all runs alike: unknowns of their own, held by a prior.
//!
//! A calibrated accelerometer is off by 0.5 to 1 % in gain and by a few tenths of a degree in phase, smoothly in
//! frequency. Taken as noise, such an error would look like a hundred independent proofs of some small effect; taken as
//! an unknown of the sensor, it is estimated along with the parameters, and only what no calibration can explain is a
//! gap. The error of a sensor is `exp(Σ_k c_k φ_k(f))` with real coefficients `c_k ~ N(0, σ_k²)`.

use std::f64::consts::TAU;

use nalgebra::Complex;

use super::evidence::{Evidence, Kind, Series};
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
}

/// Prior of a sensor: 0.7 % of gain in all, its half in what varies with frequency; 0.2° of phase and 50 µs of delay.
///
/// Thesis section 3.4 has capacitive accelerometers; their data sheets give 0.5 to 1 % of gain and the phase of a
/// first-order filter at several hundred hertz.
pub const SENSOR: [Shape; 6] = [
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
];

/// The systematic errors of all sensors of the evidence.
#[derive(Clone, Debug, PartialEq)]
pub struct Nuisance {
    /// The sensors, references among them.
    pub sensors: Vec<Point>,
    /// The lowest and highest frequency of the polynomials, Hz.
    pub band: (f64, f64),
}

impl Nuisance {
    /// One set of errors for each sensor of the evidence.
    pub fn of(evidence: &Evidence) -> Self {
        let references = evidence.runs.iter().map(|run| run.stimulus.reference());
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
            sensors,
            band: (
                frequencies().fold(f64::INFINITY, f64::min),
                frequencies().fold(0.0, f64::max),
            ),
        }
    }

    /// Number of coefficients: [`SENSOR`] for each sensor in turn.
    pub fn len(&self) -> usize {
        self.sensors.len() * SENSOR.len()
    }

    /// True without any sensor.
    pub fn is_empty(&self) -> bool {
        self.sensors.is_empty()
    }

    /// The standard deviation of each coefficient before any measurement.
    pub fn sigmas(&self) -> Vec<f64> {
        self.sensors
            .iter()
            .flat_map(|_| SENSOR.map(|shape| shape.sigma))
            .collect()
    }

    /// For each value of a series, what each of the coefficients adds to its logarithm.
    ///
    /// Response and reference are read at their own frequencies: `order` times that of the excitation, and that.
    pub fn slopes(&self, evidence: &Evidence, series: &Series) -> Vec<(usize, Vec<Complex<f64>>)> {
        let mut slopes = self.of_sensor(&series.sensor, series, 1.0, |at| series.kind.frequency(at));
        // What a wrong input does to a history is no factor, and parameters take it up.
        if let Kind::Harmonic(_) = series.kind {
            let reference = evidence.runs[series.run].stimulus.reference();
            slopes.extend(self.of_sensor(reference, series, -1.0, Some));
        }
        slopes
    }

    fn of_sensor(
        &self,
        sensor: &Point,
        series: &Series,
        sign: f64,
        frequency: impl Fn(f64) -> Option<f64>,
    ) -> Vec<(usize, Vec<Complex<f64>>)> {
        let Some(place) = self.sensors.iter().position(|s| s == sensor) else {
            return Vec::new();
        };
        let column = |(k, shape): (usize, &Shape)| {
            let slope = series.at.iter().map(|&at| sign * self.shape(shape.form, frequency(at)));
            (place * SENSOR.len() + k, slope.collect())
        };
        SENSOR.iter().enumerate().map(column).collect()
    }

    /// Without a frequency, as in a time history, only a gain remains.
    fn shape(&self, form: Form, frequency: Option<f64>) -> Complex<f64> {
        let Some(f) = frequency else {
            return Complex::from(if form == Form::Gain(0) { 1.0 } else { 0.0 });
        };
        match form {
            Form::Gain(degree) => Complex::from(self.chebyshev(degree, f)),
            Form::Phase(degree) => Complex::I * self.chebyshev(degree, f),
            Form::Delay => -Complex::I * TAU * f,
        }
    }

    fn chebyshev(&self, degree: usize, f: f64) -> f64 {
        let (first, last) = self.band;
        let u = (2.0 * (f / first).ln() / (last / first).ln().max(f64::MIN_POSITIVE) - 1.0).clamp(-1.0, 1.0);
        (degree as f64 * u.acos()).cos()
    }
}
