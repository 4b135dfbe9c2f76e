//! What sensors with errors show of a prediction.

use std::f64::consts::TAU;

use nalgebra::Complex;

use super::calibration::{Form, SENSOR};
use super::nuisance::{Nuisance, rms};
use crate::discover::observe::{Evidence, Kind, Series};
use crate::transmissibility::Point;

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

impl Nuisance {
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
            Kind::Passage | Kind::Travel | Kind::Width | Kind::Speed | Kind::Cycle(_) => {
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
