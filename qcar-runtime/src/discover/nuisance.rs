//! What sensors may be wrong by, in all runs alike: unknowns of their own, held by a prior.
//!
//! A calibrated accelerometer is off by 0.5 to 1 % in gain and by a few tenths of a degree in phase, smoothly in
//! frequency. Taken as noise, such an error would look like a hundred independent proofs of some small effect; taken as
//! an unknown of the sensor, it is estimated along with the parameters, and only what no calibration can explain is a
//! gap. The error of a sensor is `exp(Σ_k c_k φ_k(f))` with real coefficients `c_k ~ N(0, σ_k²)`;
//! in a time history there is an offset too.

use std::f64::consts::TAU;

use nalgebra::Complex;

use super::evidence::{Evidence, Kind, Series};
use crate::campaign::Axis;
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
    /// Coefficients under suspicion: the place of each, and its standard deviation before any measurement.
    pub suspects: Vec<(usize, f64)>,
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
            sensors,
            band: (
                frequencies().fold(f64::INFINITY, f64::min),
                frequencies().fold(0.0, f64::max),
            ),
            suspects: Vec::new(),
        }
    }

    /// The same with a sensor under suspicion: its error of this form may be of the size `sigma`. `None` where no such
    /// sensor is in the evidence.
    pub fn suspecting(mut self, location: &str, axis: Axis, form: Form, sigma: f64) -> Option<Self> {
        let is_it = |sensor: &Point| sensor.location == location && sensor.axis == axis;
        let sensor = self.sensors.iter().position(is_it)?;
        let shape = SENSOR.iter().position(|shape| shape.form == form)?;
        self.suspects.push((sensor * SENSOR.len() + shape, sigma));
        Some(self)
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
        let priors = self.sensors.iter().flat_map(|_| SENSOR.map(|shape| shape.sigma));
        let mut sigmas: Vec<f64> = priors.collect();
        self.suspects.iter().for_each(|&(place, sigma)| sigmas[place] = sigma);
        sigmas
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
        let offset = self.offset(series);
        let added = offset.map_or(0.0, |(k, unit)| unit * coefficients[k]);
        slopes.extend(offset.map(|(k, unit)| (k, vec![Complex::from(unit); value.len()])));
        Shown {
            value: scaled.iter().map(|value| value + added).collect(),
            factor,
            slopes,
        }
    }

    /// The coefficient of a history's offset, and what one of it adds.
    fn offset(&self, series: &Series) -> Option<(usize, f64)> {
        let place = self.sensors.iter().position(|s| *s == series.sensor)?;
        let form = SENSOR.iter().position(|shape| shape.form == Form::Offset)?;
        let power: f64 = series.value.iter().map(|value| value.norm_sqr()).sum();
        let rms = (power / series.value.len() as f64).sqrt();
        matches!(series.kind, Kind::Time | Kind::Travel).then_some((place * SENSOR.len() + form, rms))
    }

    /// For each value of a series, what each of the coefficients adds to its logarithm.
    ///
    /// Response and reference are read at their own frequencies: `order` times that of the excitation, and that.
    fn slopes(&self, evidence: &Evidence, series: &Series) -> Vec<(usize, Vec<Complex<f64>>)> {
        match series.kind {
            Kind::Harmonic(order) => {
                let mut slopes = self.of_sensor(&series.sensor, series, 1.0, order as f64);
                let reference = evidence.runs[series.run].stimulus.reference();
                slopes.extend(reference.map_or_else(Vec::new, |point| self.of_sensor(point, series, -1.0, 1.0)));
                slopes
            }
            // Over a wide band the mean gain is what counts.
            Kind::Passage | Kind::Travel | Kind::Width | Kind::Cycle(_) => self.gain(series).into_iter().collect(),
            // Driven by what was recorded, a gain is what parameters are too: it stays with the uncertainty of the values.
            Kind::Time => Vec::new(),
        }
    }

    /// The mean gain of the sensor of a series.
    fn gain(&self, series: &Series) -> Option<(usize, Vec<Complex<f64>>)> {
        let place = self.sensors.iter().position(|s| *s == series.sensor)?;
        let form = SENSOR.iter().position(|shape| shape.form == Form::Gain(0))?;
        Some((place * SENSOR.len() + form, vec![Complex::ONE; series.at.len()]))
    }

    /// Of the errors of one sensor, read at so many times the frequency of the series.
    fn of_sensor(&self, sensor: &Point, series: &Series, sign: f64, times: f64) -> Vec<(usize, Vec<Complex<f64>>)> {
        let Some(place) = self.sensors.iter().position(|s| s == sensor) else {
            return Vec::new();
        };
        let column = |(k, shape): (usize, &Shape)| {
            let slope = series.at.iter().map(|&at| sign * self.shape(shape.form, times * at));
            (place * SENSOR.len() + k, slope.collect())
        };
        let factors = SENSOR
            .iter()
            .enumerate()
            .filter(|(_, shape)| shape.form != Form::Offset);
        factors.map(column).collect()
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
