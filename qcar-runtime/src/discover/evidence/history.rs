//! A time history as evidence: the responses themselves, sample by sample.

use nalgebra::Complex;

use super::noise::noise;
use super::restart::restarts;
use super::{Evidence, Kind, Recordings, Run, Series, Stimulus, excitation_of};
use crate::campaign::Campaign;
use crate::error::InputError;
use crate::model::About;
use crate::transmissibility::{Point, points, signal};

/// Share of a record at its start in which a model that started from rest has yet to find its way.
const RUN_IN: f64 = 0.05;
/// Share of a record at its end, beyond which inputs are not known that a band limit needs.
const RUN_OUT: f64 = 0.02;
/// Values of a series: more tell the same, since neighbours in time are alike.
const MOST: usize = 2000;
/// Share of a response's RMS value that no calibration and no model of a real system gets right.
const FLOOR: f64 = 0.005;

impl Evidence {
    pub(super) fn add_history(
        &mut self,
        campaign: &Campaign,
        about: &About,
        run: &crate::campaign::Run,
        band_limited: bool,
    ) -> Result<(), InputError> {
        let history = campaign.history(run)?;
        let known = self.known(about, &run.file, points(&history));
        let (inputs, responses): (Vec<_>, Vec<_>) = known
            .into_iter()
            .partition(|point| excitation_of(about, point).is_some());
        if inputs.is_empty() || responses.is_empty() {
            let missing = if inputs.is_empty() {
                "input of the model"
            } else {
                "response"
            };
            self.notices
                .push(format!("{}: no {missing} was recorded; the run is left out", run.file));
            return Ok(());
        }
        let mut signals = Vec::new();
        for point in inputs {
            let samples = signal(&history, &point)?;
            signals.push((point, samples));
        }
        let (place, rate) = (self.runs.len(), history.sample_rate);
        let driven: Vec<&[f64]> = signals.iter().map(|(_, samples)| samples.as_slice()).collect();
        let mut recorded = Vec::new();
        for sensor in responses {
            let samples = signal(&history, &sensor)?;
            let noise = noise(&samples, &driven, false);
            self.series
                .push(series(place, sensor.clone(), (&samples, noise), (history.start, rate)));
            recorded.push((sensor, samples));
        }
        self.runs.push(Run {
            name: run.file.clone(),
            role: run.role,
            level: rms(&signals[0].1),
            stimulus: Stimulus::History {
                inputs: Recordings {
                    start: history.start,
                    signals,
                },
                rate,
                band_limited,
                restarts: restarts(about, run.role, &recorded, rate),
            },
        });
        Ok(())
    }
}

fn series(run: usize, sensor: Point, (samples, noise): (&[f64], f64), (start, rate): (f64, f64)) -> Series {
    let first = (RUN_IN * samples.len() as f64) as usize;
    let last = samples.len() - (RUN_OUT * samples.len() as f64) as usize;
    let places: Vec<usize> = (first..last).step_by((last - first).div_ceil(MOST)).collect();
    let sigma = noise.hypot(FLOOR * rms(samples));
    Series {
        run,
        sensor,
        kind: Kind::Time,
        at: places.iter().map(|&k| start + k as f64 / rate).collect(),
        value: places.iter().map(|&k| Complex::from(samples[k])).collect(),
        sigma: vec![sigma; places.len()],
    }
}

fn rms(samples: &[f64]) -> f64 {
    let mean = samples.iter().sum::<f64>() / samples.len() as f64;
    (samples.iter().map(|sample| (sample - mean).powi(2)).sum::<f64>() / samples.len() as f64).sqrt()
}
