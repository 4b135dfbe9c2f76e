//! Simulated passages over an obstacle, shifted in time to match the measurement.
//!
//! The clock of a record may be wrong by a few milliseconds, which is no error of the model. So each run is shifted as
//! a whole to its best agreement, and the part of a derivative that equals a shift is removed (variable projection:
//! Golub and Pereyra, SIAM J. Numer. Anal. 10, 1973).

use nalgebra::Complex;

use super::measured::TIMING;
use crate::discover::observe::{
    Delay, Evidence, Free, Means, Passage, PredictError, Prediction, Pulses, Series, signal_of,
};
use crate::model::Model;
use crate::response::parameters::Values;
use crate::response::signal::output_of;
use crate::simulate::{Car, Drive, Method, Settings, SimulateError, Variant, ride, variation};

/// Integration method; its error is far below that of a tyre model.
const METHOD: Method = Method::Adaptive(3e-6);
/// Change of a parameter relative to its value, along which derivatives are taken: small enough for a linear response,
/// and large against rounding errors.
const DIFFERENCE: f64 = 3e-3;
/// Gauss-Newton steps for the shift; the first one achieves nearly all.
const STEPS: usize = 4;

pub fn passage(
    model: &dyn Model,
    values: &Values,
    delays: &[f64],
    free: &[Free],
    evidence: &Evidence,
    (run, passage): (usize, &Passage),
) -> Result<Vec<Prediction>, PredictError> {
    let series: Vec<(usize, &Series)> = evidence
        .series
        .iter()
        .enumerate()
        .filter(|(_, s)| s.run == run)
        .collect();
    let mut outputs = Vec::new();
    for (_, series) in &series {
        outputs.push(output_of(model.about(), &signal_of(model.about(), &series.sensor))?.0);
    }
    let changes: Vec<f64> = free
        .iter()
        .map(|free| free.change(values.as_slice()[free.parameter], DIFFERENCE))
        .collect();
    let moved = free.iter().zip(&changes).map(|(free, change)| {
        let mut moved = values.clone();
        moved.set(free.parameter, values.as_slice()[free.parameter] + change);
        moved
    });
    let moved: Vec<Values> = moved.collect();
    let failed = |reason| PredictError::Ride {
        run: evidence.runs[run].name.clone(),
        reason,
    };
    let base = accelerations(model, values, passage, &outputs).map_err(failed)?;
    let (car, drive) = car_and_drive(model, values, passage);
    let moved: Vec<(&[f64], f64)> = moved.iter().map(Values::as_slice).zip(changes).collect();
    let slopes = variation(&car, &drive, &outputs, &moved, passage.points_a_sample).map_err(failed)?;
    let measured = Measured {
        means: passage.means,
        delays: series
            .iter()
            .map(|(place, _)| delays.get(*place).copied().unwrap_or(0.0))
            .collect(),
        places: series.iter().map(|(place, _)| *place).collect(),
        series: series.into_iter().map(|(_, series)| series).collect(),
    };
    Ok(measured.predictions(&base, &slopes))
}

/// Car and drive of a passage.
fn car_and_drive<'a>(
    model: &'a dyn Model,
    values: &'a Values,
    passage: &'a Passage,
) -> (Car<'a, dyn Model + 'a>, Drive<'a>) {
    let car = Car {
        model,
        parameters: values.as_slice(),
        tyre: passage.tyre,
        load: passage.load,
        variant: Variant::Complete,
    };
    let rate = passage.means.rate();
    let drive = Drive {
        road: &passage.road,
        speed: passage.speed,
        sample_rate: rate,
        samples: (passage.duration * rate).ceil() as usize + 1,
    };
    (car, drive)
}

/// Outputs of a passage at the sample times of the record.
fn accelerations(
    model: &dyn Model,
    values: &Values,
    passage: &Passage,
    outputs: &[usize],
) -> Result<Vec<Vec<f64>>, SimulateError> {
    let (car, drive) = car_and_drive(model, values, passage);
    let settings = Settings {
        method: METHOD,
        most_steps: (passage.most_steps * passage.duration).ceil() as usize,
    };
    let ride = ride(&car, &drive, &settings)?;
    Ok(outputs.iter().map(|&output| ride.outputs[output].clone()).collect())
}

/// Measured series of a run.
struct Measured<'a> {
    means: Means,
    series: Vec<&'a Series>,
    /// Positions of the series in the evidence.
    places: Vec<usize>,
    /// Delay of the sensor of each series, s.
    delays: Vec<f64>,
}

/// For each series its values and their derivatives by the shift.
type Shifted = Vec<(Vec<f64>, Vec<f64>)>;

impl Measured<'_> {
    fn predictions(&self, base: &[Vec<f64>], slopes: &[Vec<Vec<f64>>]) -> Vec<Prediction> {
        let shift = self.best_shift(base);
        let here = self.shifted(base, shift);
        let pulses = self.pulses(shift, base.first().map_or(0, Vec::len));
        let slopes = slopes.iter().map(|records| {
            let slopes = pulses.iter().zip(records).map(|(pulses, record)| pulses.means(record));
            self.without_shift(slopes.collect(), &here, shift)
        });
        let slopes: Vec<Vec<Vec<f64>>> = slopes.collect();
        let complex = |values: &[f64]| values.iter().copied().map(Complex::from).collect::<Vec<_>>();
        let shares = self.shares(&here, shift);
        let predict = |(column, &place): (usize, &usize)| Prediction {
            series: place,
            value: complex(&here[column].0),
            slopes: slopes
                .iter()
                .map(|of_parameter| complex(&of_parameter[column]))
                .collect(),
            delay: Some(Delay {
                slope: complex(&here[column].1),
                shares: shares.clone(),
            }),
            by_drive: Vec::new(),
            by_initial_states: Vec::new(),
        };
        self.places.iter().enumerate().map(predict).collect()
    }

    /// Values and derivatives of the series for records that begin `shift` (s) later, with the delay of each sensor.
    fn shifted(&self, records: &[Vec<f64>], shift: f64) -> Shifted {
        let read = |((series, delay), record): ((&&Series, &f64), &Vec<f64>)| {
            let means = series.at.iter().map(|t| self.means.at(record, t - shift - delay));
            means.map(|(mean, slope)| (mean, -slope)).unzip()
        };
        self.series.iter().zip(&self.delays).zip(records).map(read).collect()
    }

    /// The pulses of each series for records of `samples` samples that begin `shift` (s) later.
    fn pulses(&self, shift: f64, samples: usize) -> Vec<Pulses> {
        let of = |(series, delay): (&&Series, &f64)| {
            let instants = series.at.iter().map(|t| t - shift - delay);
            self.means.pulses(instants, samples)
        };
        self.series.iter().zip(&self.delays).map(of).collect()
    }

    /// Share of each sensor's delay that the common shift absorbs, by series; empty if the shift is at its limit.
    fn shares(&self, here: &Shifted, shift: f64) -> Vec<(usize, f64)> {
        let square = |(series, (_, by_shift)): (&&Series, &(Vec<f64>, Vec<f64>))| -> f64 {
            let scaled = by_shift.iter().zip(&series.sigma).map(|(slope, sigma)| slope / sigma);
            scaled.map(|slope| slope * slope).sum()
        };
        let squares: Vec<f64> = self.series.iter().zip(here).map(square).collect();
        let all: f64 = squares.iter().sum();
        if shift.abs() >= TIMING || all == 0.0 {
            return Vec::new();
        }
        let shares = squares.iter().map(|square| square / all);
        self.places.iter().copied().zip(shares).collect()
    }

    /// Shift at which the records agree best with the measurement (Gauss-Newton).
    fn best_shift(&self, records: &[Vec<f64>]) -> f64 {
        (0..STEPS).fold(0.0, |shift: f64, _| {
            let here = self.shifted(records, shift);
            let residuals: Vec<Vec<f64>> = self
                .series
                .iter()
                .zip(&here)
                .map(|(series, (values, _))| series.value.iter().zip(values).map(|(y, m)| y.re - m).collect())
                .collect();
            (shift + self.share_of_shift(&residuals, &here)).clamp(-TIMING, TIMING)
        })
    }

    /// Component of a shift in a change of all series, by weighted least squares.
    fn share_of_shift(&self, changes: &[Vec<f64>], here: &Shifted) -> f64 {
        let (mut product, mut square) = (0.0, 0.0);
        for ((series, change), (_, by_shift)) in self.series.iter().zip(changes).zip(here) {
            for ((change, by_shift), sigma) in change.iter().zip(by_shift).zip(&series.sigma) {
                product += change * by_shift / (sigma * sigma);
                square += by_shift * by_shift / (sigma * sigma);
            }
        }
        if square > 0.0 { product / square } else { 0.0 }
    }

    /// Removes the component of the shift from a derivative; nothing is removed if the shift is at its limit.
    fn without_shift(&self, mut slopes: Vec<Vec<f64>>, here: &Shifted, shift: f64) -> Vec<Vec<f64>> {
        if shift.abs() < TIMING {
            let share = self.share_of_shift(&slopes, here);
            for (slope, (_, by_shift)) in slopes.iter_mut().zip(here) {
                slope
                    .iter_mut()
                    .zip(by_shift)
                    .for_each(|(slope, by_shift)| *slope -= share * by_shift);
            }
        }
        slopes
    }
}
