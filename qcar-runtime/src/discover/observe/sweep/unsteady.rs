//! The non-steady part of a sweep: the harmonics that the estimator reads from it, minus the steady harmonics.
//!
//! A sweep never reaches a steady state: friction depends on the motion before, and lightly damped modes keep ringing.
//! A balance of few harmonics truncates laws with kinks. Near the ends of a sweep the estimator mixes harmonics
//! slightly. These errors are small against the response and change little with the parameters. So they are computed
//! once: the model is simulated with the measured motion of the pad, the estimator of the measurement reads the
//! responses, and the difference from the steady harmonics is added to every prediction of a search.

use std::borrow::Cow;

use nalgebra::Complex;
use rayon::prelude::*;

use super::measured::AROUND;
use super::{excitation, linear, nonlinear};
use crate::campaign::Role;
use crate::discover::observe::{Evidence, Kind, PredictError, Series, Stimulus, TestConditions, order_of, signal_of};
use crate::model::{Model, Signal};
use crate::response::Response;
use crate::response::parameters::Values;
use crate::response::ratio::between;
use crate::response::signal::SignalError;
use crate::simulate::replay::reading;
use crate::simulate::{Accuracy, Between, Reading, Recorded, Replay};
use crate::spectrum::{synthesize, transform};
use crate::transmissibility::Point;
use crate::transmissibility::harmonics::Swept;

/// Factor by which the used band extends the band of a sweep on both sides. The faded ends of the sweep lie there, and
/// friction responds to its slow parts. Beyond that the signal is noise of the pad's sensor.
const BEYOND: f64 = 4.0;

/// Non-steady part of each series for the runs of one role. It is empty for series of other runs and for sweeps whose
/// record is not available.
///
/// # Errors
/// Fails if the model lacks a measured quantity.
pub fn unsteady(
    model: &dyn Model,
    values: &Values,
    conditions: &TestConditions,
    evidence: &Evidence,
    role: Role,
) -> Result<Vec<Vec<Complex<f64>>>, PredictError> {
    let mut added = vec![Vec::new(); evidence.series.len()];
    let runs: Vec<usize> = (0..evidence.runs.len())
        .filter(|&run| evidence.runs[run].role == role)
        .collect();
    let of_runs = runs
        .into_par_iter()
        .map(|run| of_run(model, values, conditions.drive_of(run, 0), evidence, run));
    for (series, differences) in of_runs.collect::<Result<Vec<_>, _>>()?.into_iter().flatten() {
        added[series] = differences;
    }
    Ok(added)
}

/// Positions of series, each with its non-steady part.
type Differences = Vec<(usize, Vec<Complex<f64>>)>;

fn of_run(
    model: &dyn Model,
    values: &Values,
    drive: f64,
    evidence: &Evidence,
    run: usize,
) -> Result<Differences, PredictError> {
    let Some(driven) = Driven::of(model, evidence, run, drive)? else {
        return Ok(Vec::new());
    };
    let steady = if model.about().linear {
        linear(model, values, &[], evidence, run)?
    } else {
        nonlinear(model, values, drive, &[], evidence, run)?
    };
    let series: Vec<usize> = steady.iter().map(|own| own.series).collect();
    let shown = if model.about().linear {
        driven.harmonics(model, evidence, &series, |sensors| {
            driven.by_frequency_response(model, values, sensors)
        })?
    } else {
        driven.harmonics(model, evidence, &series, |sensors| {
            driven.by_time_integration(model, values, sensors)
        })?
    };
    let differences = steady.into_par_iter().zip(shown).map(|(steady, shown)| {
        let pairs = shown.iter().zip(&steady.value);
        let differences = pairs.map(|(shown, steady)| shown / drive - steady);
        (steady.series, differences.collect())
    });
    Ok(differences.collect())
}

impl Evidence {
    /// Adds to the uncertainty of each harmonic of the sweeps how much it depends on the motion before the record, which
    /// is not known. This is the difference between two assumptions in a linear model: that the pad was at rest before
    /// the record, and that the axle was at rest where the record begins. Returns false, and changes nothing, if the
    /// difference is below the uncertainty everywhere, or if the model is nonlinear.
    ///
    /// # Errors
    /// Fails if the model lacks a measured quantity.
    pub fn allow_for_starts(&mut self, model: &dyn Model, values: &Values) -> Result<bool, PredictError> {
        if !model.about().linear {
            return Ok(false);
        }
        let evidence = &*self;
        let of_runs = (0..evidence.runs.len()).into_par_iter();
        let of_runs = of_runs.map(|run| by_start(model, values, evidence, run));
        let differences = of_runs.collect::<Result<Vec<_>, _>>()?.concat();
        let is_above_sigma = |(series, by): &(usize, Vec<f64>)| {
            let sigma = &evidence.series[*series].sigma;
            by.iter().zip(sigma).any(|(by, sigma)| by > sigma)
        };
        if !differences.iter().any(is_above_sigma) {
            return Ok(false);
        }
        for (series, by) in differences {
            let Series { sigma, noise, .. } = &mut self.series[series];
            for own in [sigma, noise] {
                own.iter_mut().zip(&by).for_each(|(own, by)| *own = own.hypot(*by));
            }
        }
        Ok(true)
    }
}

/// How much each harmonic of a sweep depends on the motion before it, by positions of series.
fn by_start(
    model: &dyn Model,
    values: &Values,
    evidence: &Evidence,
    run: usize,
) -> Result<Vec<(usize, Vec<f64>)>, PredictError> {
    let Some(driven) = Driven::of(model, evidence, run, 1.0)? else {
        return Ok(Vec::new());
    };
    let of_run = |&series: &usize| evidence.series[series].run == run;
    let series: Vec<usize> = (0..evidence.series.len()).filter(of_run).collect();
    let pad_at_rest = driven.harmonics(model, evidence, &series, |sensors| {
        driven.by_frequency_response(model, values, sensors)
    })?;
    let axle_at_rest = driven.harmonics(model, evidence, &series, |sensors| {
        driven.by_time_integration(model, values, sensors)
    })?;
    let pairs = pad_at_rest.iter().zip(&axle_at_rest);
    let differences =
        pairs.map(|(one, other)| one.iter().zip(other).map(|(one, other)| (one - other).norm()).collect());
    Ok(series.into_iter().zip(differences).collect())
}

/// The signals without duplicates, in order of first use.
fn without_duplicates(signals: &[Signal]) -> Vec<Signal> {
    let mut distinct: Vec<Signal> = Vec::new();
    for signal in signals {
        if !distinct.contains(signal) {
            distinct.push(signal.clone());
        }
    }
    distinct
}

/// Sample-by-sample signals of the sensors of a sweep, starting from rest.
pub fn replayed(
    model: &dyn Model,
    values: &Values,
    evidence: &Evidence,
    run: usize,
) -> Result<Vec<(Point, Vec<f64>)>, PredictError> {
    let Some(driven) = Driven::of(model, evidence, run, 1.0)? else {
        return Ok(Vec::new());
    };
    let sensors = evidence.sensors(run);
    let signals: Vec<Signal> = sensors.iter().map(|sensor| signal_of(model.about(), sensor)).collect();
    let shown = driven.by_time_integration(model, values, &signals)?;
    Ok(sensors.into_iter().cloned().zip(shown).collect())
}

/// Motion of the pad in a sweep, starting from rest.
struct Driven<'a> {
    excitation: usize,
    reference: &'a Point,
    samples: Cow<'a, [f64]>,
    /// Estimator of responses to the measured motion, without the factor `drive`.
    swept: &'a Swept,
    rate: f64,
    /// Lowest and highest frequency, Hz; the signal outside is noise.
    band: (f64, f64),
}

impl<'a> Driven<'a> {
    /// The pad of a run; `drive` is the factor of the true excitation on that of the reference. `None` if the run is
    /// no sweep or its record is not available.
    fn of(model: &dyn Model, evidence: &'a Evidence, run: usize, drive: f64) -> Result<Option<Self>, PredictError> {
        let Stimulus::Sweep {
            reference,
            signal,
            swept: Some(swept),
            rate,
            band,
            ..
        } = &evidence.runs[run].stimulus
        else {
            return Ok(None);
        };
        let is_unscaled = drive == 1.0;
        Ok(Some(Self {
            excitation: excitation(model, evidence, run, reference)?,
            reference,
            samples: if is_unscaled {
                Cow::Borrowed(signal)
            } else {
                signal.iter().map(|sample| drive * sample).collect()
            },
            swept,
            rate: *rate,
            band: (band.0 / BEYOND, band.1 * BEYOND),
        }))
    }

    /// Harmonics of these series, as the estimator of the measurement reads them from the signals that `simulate` gives
    /// for some sensors.
    fn harmonics(
        &self,
        model: &dyn Model,
        evidence: &Evidence,
        series: &[usize],
        simulate: impl Fn(&[Signal]) -> Result<Vec<Vec<f64>>, SignalError>,
    ) -> Result<Vec<Vec<Complex<f64>>>, SignalError> {
        let sensor = |&series: &usize| signal_of(model.about(), &evidence.series[series].sensor);
        let sensors: Vec<Signal> = series.iter().map(sensor).collect();
        // A sensor has one series for each harmonic, all read from the same signal.
        let distinct = without_duplicates(&sensors);
        let spectra: Vec<_> = simulate(&distinct)?
            .par_iter()
            .map(|signal| transform(signal))
            .collect();
        let harmonics = series.par_iter().zip(&sensors).map(|(&series, sensor)| {
            let place = distinct.iter().position(|other| other == sensor).unwrap_or(0);
            harmonics(self.swept, &spectra[place], &evidence.series[series])
        });
        Ok(harmonics.collect())
    }

    /// Sensor signals by time integration, from the axle at rest.
    fn by_time_integration(
        &self,
        model: &dyn Model,
        values: &Values,
        sensors: &[Signal],
    ) -> Result<Vec<Vec<f64>>, SignalError> {
        let recorded = Recorded {
            excitation: self.excitation,
            power: order_of(self.reference),
            samples: &self.samples,
        };
        let how = Between {
            rate: self.rate,
            band_limited: true,
            band: self.band,
            periodic: false,
            samples: self.samples.len(),
            accuracy: Accuracy::USUAL,
        };
        let readings = sensors.iter().map(|sensor| reading(model.about(), sensor));
        let readings: Vec<Reading> = readings.collect::<Result<_, _>>()?;
        Ok(Replay::new(model, vec![recorded], how, Vec::new(), readings)
            .run(values.as_slice(), &[])
            .signals)
    }

    /// Sensor signals of a linear model by its frequency response, from the pad at rest. The record is padded with zeros, since ringing
    /// after its end would otherwise wrap around to its beginning. The mean of the record is removed first.
    fn by_frequency_response(
        &self,
        model: &dyn Model,
        values: &Values,
        sensors: &[Signal],
    ) -> Result<Vec<Vec<f64>>, SignalError> {
        let length = 2 * self.samples.len();
        let mean = self.samples.iter().sum::<f64>() / self.samples.len() as f64;
        let mut padded: Vec<f64> = self.samples.iter().map(|sample| sample - mean).collect();
        padded.resize(length, 0.0);
        let (lines, spacing) = (transform(&padded), self.rate / length as f64);
        let first = (self.band.0 / spacing).ceil() as usize;
        let inside = first..((self.band.1 / spacing) as usize).clamp(first, lines.len());
        let at: Vec<f64> = inside.clone().map(|line| line as f64 * spacing).collect();
        let below = signal_of(model.about(), self.reference);
        let mut response = Response::new(model, self.excitation, &at);
        response.evaluate_values(values.as_slice());
        let answer = |sensor: &Signal| {
            let response = between(&response, values, sensor, &below)?;
            let mut answer = vec![Complex::ZERO; lines.len()];
            for ((answer, line), response) in answer[inside.clone()]
                .iter_mut()
                .zip(&lines[inside.clone()])
                .zip(response.value)
            {
                *answer = line * response;
            }
            let mut shown = synthesize(&answer, length);
            shown.truncate(self.samples.len());
            Ok(shown)
        };
        sensors.par_iter().map(answer).collect()
    }
}

/// Harmonics of a series from the spectrum of a simulated signal.
fn harmonics(swept: &Swept, spectrum: &[Complex<f64>], series: &Series) -> Vec<Complex<f64>> {
    let Kind::Harmonic(order) = series.kind else {
        unreachable!("a sweep has no other series")
    };
    let responses: Vec<f64> = series.at.iter().map(|f| f * order as f64).collect();
    let lines = swept.responses_in(spectrum, &responses, AROUND);
    lines
        .iter()
        .map(|line| line.value[order - 1].unwrap_or_default())
        .collect()
}
