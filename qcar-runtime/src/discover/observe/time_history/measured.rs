//! Reads a time history: sample-by-sample responses.

use nalgebra::Complex;

use super::noise::noise;
use super::restarts::{drifts, restarts};
use crate::campaign::{Campaign, History, Recording};
use crate::discover::observe::sensor::sensors;
use crate::discover::observe::series::LEAST_NOISE;
use crate::discover::observe::{Band, Evidence, Kind, Recordings, Run, Series, Spread, Stimulus, excitation_of};
use crate::error::{InputError, Place, Problem};
use crate::mean::deviation;
use crate::model::About;
use crate::transmissibility::{Point, signal};

/// Share of a record at each end that is not compared, because the band limit of the inputs is inaccurate there.
const ENDS: f64 = 0.02;
/// Largest number of values of a series. Neighbours in time are similar, so more values add little information.
const MOST_VALUES: usize = 2000;
/// Smallest error of any calibration and any model of a real system, as a share of the RMS of the response.
const FLOOR: f64 = 0.005;

impl Evidence {
    pub(in crate::discover::observe) fn add_history(
        &mut self,
        campaign: &Campaign,
        about: &About,
        run: &crate::campaign::Run,
        recording: &Recording,
    ) -> Result<(), InputError> {
        let Recording {
            band_limited, periodic, ..
        } = *recording;
        let history = campaign.history(run)?;
        let known = self.keep_known(about, &run.name, sensors(about, &history));
        let (inputs, responses): (Vec<_>, Vec<_>) = known
            .into_iter()
            .partition(|point| excitation_of(about, point).is_some());
        if responses.is_empty() {
            self.notices
                .push(format!("{}: no response was recorded; the run is left out", run.name));
            return Ok(());
        }
        if inputs.is_empty() {
            self.notices.push(format!(
                "{}: no input of the model was recorded; the run is taken for one that nothing drives",
                run.name
            ));
        }
        let mut signals = Vec::new();
        for point in inputs {
            let samples = signal(&history, &point)?;
            signals.push((point, samples));
        }
        let (place, rate) = (self.runs.len(), history.sample_rate);
        let driven: Vec<&[f64]> = signals.iter().map(|(_, samples)| samples.as_slice()).collect();
        if periodic {
            check_periodic(about, campaign, run, signals.is_empty())?;
        }
        let band = recording.band.map(|band| Band::new(band, rate));
        let ends = if band_limited && !signals.is_empty() && !periodic {
            ENDS
        } else {
            0.0
        };
        let reach = band.as_ref().filter(|_| !periodic).map_or(0, Band::half);
        let stride = band.as_ref().map_or(1, |band| band.stride(rate));
        let cut = reach.max((ends * history.len() as f64) as usize);
        let Some(inside) = inside(history.len(), cut, stride) else {
            return Err(too_short(&history, recording, reach));
        };
        let (mut recorded, mut noises) = (Vec::new(), Vec::new());
        for sensor in responses {
            let samples = signal(&history, &sensor)?;
            let noise = noise(&samples, &driven, periodic);
            let compared = band.as_ref().map(|band| band.of(&samples, periodic));
            let compared = compared.as_ref().unwrap_or(&samples);
            let passed = band.as_ref().map_or(1.0, Band::of_noise) * noise;
            let times = |k: usize| history.start + k as f64 / rate;
            self.series
                .push(series(place, sensor.clone(), (compared, passed), inside.clone(), times));
            recorded.push((sensor, samples));
            noises.push(noise);
        }
        // A periodic motion ends as it begins.
        let (spread, restarts) = if periodic {
            (Spread::default(), Vec::new())
        } else {
            let spread = Spread::of(&recorded, &noises, &signals, rate);
            (spread, restarts(about, run.role, &recorded, rate))
        };
        let first = signals.first().unwrap_or(&recorded[0]);
        self.runs.push(Run {
            name: run.name.clone(),
            role: run.role,
            level: deviation(&first.1),
            stimulus: Stimulus::History {
                restarts,
                inputs: Recordings {
                    start: history.start,
                    samples: history.len(),
                    whole: history.start..history.start + history.len() as f64 / rate,
                    signals,
                },
                rate,
                band_limited,
                spread,
                band,
                periodic,
            },
        });
        Ok(())
    }
}

/// Evenly spaced samples of a record without `cut` samples at each end; `None` if too few are left.
fn inside(samples: usize, cut: usize, stride: usize) -> Option<impl Iterator<Item = usize> + Clone> {
    const FEWEST: usize = 20;
    let left = samples.saturating_sub(2 * cut);
    let inside = (cut..cut + left).step_by(left.div_ceil(MOST_VALUES).max(stride));
    (inside.len() >= FEWEST).then_some(inside)
}

fn too_short(history: &History, recording: &Recording, reach: usize) -> InputError {
    let seconds = |samples: usize| samples as f64 / history.sample_rate;
    let found = format!("a record of {} s", seconds(history.len()));
    let (expected, remedy) = match recording.band {
        Some((low, high)) => (
            format!(
                "one longer than the {} s that the filter of `band = [{low}, {high}]` takes, by 20 samples of that band",
                seconds(2 * reach)
            ),
            "widen the band towards zero, leave it out, or export a longer record",
        ),
        None => ("at least 20 samples".into(), "export the whole record"),
    };
    Problem::new(&history.file, Place::File, found, expected, remedy).into()
}

/// Checks that a motion can be periodic: it has an excitation, and every mass is held.
///
/// # Errors
/// Fails if the motion cannot be periodic.
fn check_periodic(
    about: &About,
    campaign: &Campaign,
    run: &crate::campaign::Run,
    is_free: bool,
) -> Result<(), InputError> {
    let adrift = (0..about.states.len()).find(|&state| drifts(about, state));
    let why = match adrift {
        _ if is_free => "no input of the model that drives it".to_owned(),
        Some(state) => format!("`{}` of the model, which nothing holds", about.states[state].name),
        None => return Ok(()),
    };
    let place = Place::Name(format!("run {}, periodic", run.name));
    let remedy = "leave `periodic` out: the state at the beginning is estimated then";
    Err(Problem::new(campaign.manifest(), place, why, "a motion that repeats", remedy).into())
}

fn series(
    run: usize,
    sensor: Point,
    (samples, noise): (&[f64], f64),
    inside: impl Iterator<Item = usize> + Clone,
    time: impl Fn(usize) -> f64,
) -> Series {
    let at: Vec<f64> = inside.clone().map(time).collect();
    let mut series = Series {
        run,
        sensor,
        kind: Kind::Time,
        sigma: vec![noise.hypot(FLOOR * deviation(samples)); at.len()],
        noise: vec![noise.hypot(LEAST_NOISE * deviation(samples)); at.len()],
        least_discrepancy: FLOOR,
        at,
        value: inside.map(|k| Complex::from(samples[k])).collect(),
    };
    let step = (series.at[series.at.len() - 1] - series.at[0]) / series.at.len() as f64;
    series.thin(((series.half_a_period() / (IN_HALF_A_PERIOD * step)) as usize).max(1));
    series
}

/// Values in half a mean period of a record: they resolve its first eight harmonics, and more add little information.
const IN_HALF_A_PERIOD: f64 = 8.0;
