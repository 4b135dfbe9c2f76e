//! Readings of sensors with errors for a predicted series.

use std::f64::consts::TAU;

use nalgebra::Complex;

use super::calibration::{Form, SENSOR};
use super::nuisance::{Nuisance, rms};
use crate::discover::observe::{Evidence, Kind, Series};
use crate::transmissibility::Point;

/// Reading of a sensor with errors for a predicted series.
#[derive(Clone, Debug, PartialEq)]
pub struct SensorOutput {
    /// Readings.
    pub value: Vec<Complex<f64>>,
    /// Factor of the sensor errors on each predicted value.
    pub factor: Vec<Complex<f64>>,
    /// Derivatives of the readings by the coefficients, each with the position of its coefficient.
    pub slopes: Vec<(usize, Vec<Complex<f64>>)>,
}

impl Nuisance {
    /// Applies the sensor errors with these coefficients to a predicted series.
    pub fn sensor_output(
        &self,
        evidence: &Evidence,
        series: &Series,
        value: &[Complex<f64>],
        coefficients: &[f64],
    ) -> SensorOutput {
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
        SensorOutput {
            value: scaled.iter().map(|value| value + added).collect(),
            factor,
            slopes,
        }
    }

    /// Position of the offset coefficient of a series, and the offset for a coefficient of 1: the RMS of all records of
    /// the sensor, or of the K&C curve. `None` if the series has no offset.
    fn offset(&self, evidence: &Evidence, series: &Series) -> Option<(usize, f64)> {
        if !evidence.runs[series.run].stimulus.passes_mean() {
            return None;
        }
        let place = self.coefficient(&series.sensor, Form::Offset)?;
        let unit = match series.kind {
            Kind::Time if self.without_offset.iter().any(|(sensor, _)| *sensor == series.sensor) => return None,
            Kind::Time => self.reads[place / self.of_a_sensor()],
            Kind::Travel => rms(series.value.iter()),
            _ => return None,
        };
        Some((place, unit))
    }

    /// Zero offset of each sensor with records and its standard error, SI. The error is NaN if the data do not
    /// determine it.
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

    /// Derivatives of the logarithm of each value of a series by the coefficients.
    ///
    /// The errors of the reference apply at the excitation frequency, those of the response at `order` times that
    /// frequency.
    fn slopes(&self, evidence: &Evidence, series: &Series) -> Vec<(usize, Vec<Complex<f64>>)> {
        let constant = |k: usize| (k, vec![Complex::ONE; series.at.len()]);
        match series.kind {
            Kind::Harmonic(order) => {
                let mut slopes = self.of_sensor(&series.sensor, series, 1.0, order as f64);
                let references = evidence.runs[series.run].stimulus.references();
                slopes.extend(
                    references
                        .into_iter()
                        .flat_map(|point| self.of_sensor(point, series, -1.0, 1.0)),
                );
                slopes
            }
            // A calibration curve and a phase belong to one frequency. Over a wide band only the mean gain matters.
            Kind::Time | Kind::Passage | Kind::Travel | Kind::Width | Kind::Speed | Kind::Cycle(_) => {
                self.mean_gains(&series.sensor).map(constant).collect()
            }
        }
    }

    /// Log derivatives by the errors of one sensor at `times` the frequency of the series.
    fn of_sensor(&self, sensor: &Point, series: &Series, sign: f64, times: f64) -> Vec<(usize, Vec<Complex<f64>>)> {
        let curve = (0..self.shelves).map(Form::Shelf);
        let factors = SENSOR.iter().map(|shape| shape.form).chain(curve);
        let factors = factors.filter(|&form| form != Form::Offset);
        let own = factors.filter_map(|form| Some((self.coefficient(sensor, form)?, form)));
        let suspects = [Form::Gain, Form::Delay]
            .into_iter()
            .flat_map(|form| self.suspected(sensor, form).map(move |k| (k, form)));
        let column = |(k, form): (usize, Form)| {
            let slope = series.at.iter().map(|&at| sign * self.shape(form, times * at));
            (k, slope.collect())
        };
        own.chain(suspects).map(column).collect()
    }

    /// Derivative of the logarithm of a reading at a frequency (Hz) by the coefficient of a form.
    fn shape(&self, form: Form, f: f64) -> Complex<f64> {
        match form {
            Form::Gain => Complex::ONE,
            Form::Shelf(place) => shelf(f / self.corner(place)),
            Form::Phase => Complex::I,
            Form::Delay => -Complex::I * TAU * f,
            Form::Offset => unreachable!("an offset is no factor"),
        }
    }

    /// Corner frequency of a shelf, Hz: in the middle of its share of the band.
    fn corner(&self, place: usize) -> f64 {
        let (first, last) = self.band;
        first * (last / first).powf((place as f64 + 0.5) / self.shelves as f64)
    }
}

/// Logarithm of the response of a first-order shelf of small height over that height, at a frequency relative to its
/// corner: of `(1 + ix e^(h/2)) / (1 + ix e^(-h/2)) · e^(-h/2)`. It has minimum phase.
fn shelf(x: f64) -> Complex<f64> {
    let ix = Complex::new(0.0, x);
    (ix - 1.0) / (ix + 1.0) / 2.0
}
