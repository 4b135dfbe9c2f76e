//! A time history as evidence: the responses themselves, sample by sample.

use nalgebra::Complex;

use super::noise::noise;
use super::restart::{Spread, restarts};
use super::{Evidence, Kind, Recordings, Run, Series, Stimulus, excitation_of};
use crate::campaign::Campaign;
use crate::error::InputError;
use crate::model::About;
use crate::transmissibility::{Point, points, signal};

/// Share of a record at each of its ends near which inputs are not known that a band limit needs.
const ENDS: f64 = 0.02;
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
        if responses.is_empty() {
            self.notices
                .push(format!("{}: no response was recorded; the run is left out", run.file));
            return Ok(());
        }
        if inputs.is_empty() {
            self.notices.push(format!(
                "{}: no input of the model was recorded; the run is taken for one that nothing drives",
                run.file
            ));
        }
        let mut signals = Vec::new();
        for point in inputs {
            let samples = signal(&history, &point)?;
            signals.push((point, samples));
        }
        let (place, rate) = (self.runs.len(), history.sample_rate);
        let driven: Vec<&[f64]> = signals.iter().map(|(_, samples)| samples.as_slice()).collect();
        let ends = if band_limited && !signals.is_empty() { ENDS } else { 0.0 };
        let (mut recorded, mut noises) = (Vec::new(), Vec::new());
        for sensor in responses {
            let samples = signal(&history, &sensor)?;
            let noise = noise(&samples, &driven, false);
            let inside = inside(samples.len(), ends);
            let times = |k: usize| history.start + k as f64 / rate;
            self.series
                .push(series(place, sensor.clone(), (&samples, noise), inside, times));
            recorded.push((sensor, samples));
            noises.push(noise);
        }
        let spread = Spread::of(&recorded, &noises, &signals, rate);
        let first = signals.first().unwrap_or(&recorded[0]);
        self.runs.push(Run {
            name: run.file.clone(),
            role: run.role,
            level: rms(&first.1),
            stimulus: Stimulus::History {
                restarts: restarts(about, run.role, &recorded, rate),
                inputs: Recordings {
                    start: history.start,
                    samples: history.len(),
                    signals,
                },
                rate,
                band_limited,
                spread,
            },
        });
        Ok(())
    }
}

/// The samples of a record that are compared: some, evenly, without those of its ends.
fn inside(samples: usize, ends: f64) -> impl Iterator<Item = usize> + Clone {
    let cut = (ends * samples as f64) as usize;
    (cut..samples - cut).step_by((samples - 2 * cut).div_ceil(MOST))
}

fn series(
    run: usize,
    sensor: Point,
    (samples, noise): (&[f64], f64),
    inside: impl Iterator<Item = usize> + Clone,
    time: impl Fn(usize) -> f64,
) -> Series {
    let at: Vec<f64> = inside.clone().map(time).collect();
    Series {
        run,
        sensor,
        kind: Kind::Time,
        sigma: vec![noise.hypot(FLOOR * rms(samples)); at.len()],
        at,
        value: inside.map(|k| Complex::from(samples[k])).collect(),
    }
}

fn rms(samples: &[f64]) -> f64 {
    let mean = samples.iter().sum::<f64>() / samples.len() as f64;
    (samples.iter().map(|sample| (sample - mean).powi(2)).sum::<f64>() / samples.len() as f64).sqrt()
}
