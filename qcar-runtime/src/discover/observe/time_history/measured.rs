//! Reads a time history: sample-by-sample responses.

use nalgebra::Complex;

use super::noise::noise;
use super::restarts::{drifts, restarts};
use crate::campaign::{Campaign, History, Recording};
use crate::discover::observe::run::left_out;
use crate::discover::observe::sensor::sensors;
use crate::discover::observe::series::{Choice, LEAST_NOISE};
use crate::discover::observe::{Band, Evidence, Kind, Recordings, Run, Series, Spread, Stimulus, excitation_of};
use crate::error::{InputError, Place, Problem};
use crate::mean::deviation;
use crate::model::About;
use crate::simulate::Accuracy;
use crate::transmissibility::{Point, signal};

/// Largest number of values of a series. Neighbours in time are similar, so more values add little information.
const MOST_VALUES: usize = 2000;
/// Smallest error of any calibration and any model of a real system, as a share of the RMS of the response.
const FLOOR: f64 = 0.005;
/// Values in half a mean period of a record: they resolve its first eight harmonics, and more add little information.
const IN_HALF_A_PERIOD: f64 = 8.0;
/// Fewest values from one restart of a record to the next. A choice: the position and the velocity that are estimated there
/// make the residual smaller by 6 %.
const IN_A_WINDOW: usize = 16;

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
        let Some(Signals { inputs, responses }) = self.signals(about, &run.name, &history)? else {
            return Ok(());
        };
        if periodic {
            check_periodic(about, campaign, run, inputs.is_empty())?;
        }
        let part = Part::of(&history, recording, !inputs.is_empty(), Choice::for_role(run.role))?;
        let (place, rate) = (self.runs.len(), history.sample_rate);
        let driven: Vec<&[f64]> = inputs.iter().map(|(_, samples)| samples.as_slice()).collect();
        let noises = responses.iter().map(|(_, samples)| noise(samples, &driven, periodic));
        let noises: Vec<f64> = noises.collect();
        // A periodic motion ends as it begins.
        let (spread, restarts) = if periodic {
            (Spread::default(), Vec::new())
        } else {
            let mut spread = Spread::of(&responses, &noises, &inputs, rate);
            if part.band.as_ref().is_some_and(|band| !band.passes_mean()) {
                spread.zeros.clear();
            }
            (spread, restarts(about, run.role, &responses, rate))
        };
        let fewest = IN_A_WINDOW * restarts.len();
        let series = responses.iter().zip(&noises);
        self.series
            .extend(series.map(|((sensor, samples), noise)| part.series(place, sensor, (samples, *noise), fewest)));
        let first = inputs.first().unwrap_or(&responses[0]);
        self.runs.push(Run {
            name: run.name.clone(),
            role: run.role,
            level: deviation(&first.1),
            stimulus: Stimulus::History {
                restarts,
                rate,
                band_limited,
                spread,
                band: part.band,
                periodic,
                accuracy: Accuracy::USUAL,
                inputs: Recordings {
                    start: history.start,
                    samples: history.len(),
                    whole: history.start..history.start + history.len() as f64 / rate,
                    signals: inputs,
                },
            },
        });
        Ok(())
    }

    /// Signals of the sensors at places of the model; adds a notice and returns `None` if none is a response.
    fn signals(&mut self, about: &About, run: &str, history: &History) -> Result<Option<Signals>, InputError> {
        let known = self.keep_known(about, run, sensors(about, history));
        let (inputs, responses): (Vec<_>, Vec<_>) = known
            .into_iter()
            .partition(|point| excitation_of(about, point).is_some());
        if responses.is_empty() {
            self.notices
                .push(format!("{run}: no response was recorded; the run is left out"));
            return Ok(None);
        }
        if inputs.is_empty() && !about.excitations.is_empty() {
            self.notices.push(format!(
                "{run}: no input of the model was recorded; the run is taken for one that nothing drives"
            ));
        }
        let read = |points: Vec<Point>| -> Result<Vec<(Point, Vec<f64>)>, InputError> {
            let samples = |point: Point| Ok((point.clone(), signal(history, &point)?));
            points.into_iter().map(samples).collect()
        };
        Ok(Some(Signals {
            inputs: read(inputs)?,
            responses: read(responses)?,
        }))
    }
}

/// Recorded signals, by their sensors.
struct Signals {
    /// Those of the excitations of the model.
    inputs: Vec<(Point, Vec<f64>)>,
    responses: Vec<(Point, Vec<f64>)>,
}

/// The part of a record that is compared.
struct Part {
    /// Time of the first sample, s.
    start: f64,
    /// Sample rate, Hz.
    rate: f64,
    band: Option<Band>,
    periodic: bool,
    /// Samples of the values, before the series is thinned.
    inside: Vec<usize>,
    choice: Choice,
}

impl Part {
    /// # Errors
    /// Fails if the record is too short.
    fn of(history: &History, recording: &Recording, is_driven: bool, choice: Choice) -> Result<Self, InputError> {
        let (rate, periodic) = (history.sample_rate, recording.periodic);
        let band = recording.band.map(|band| Band::new(band, rate));
        let stride = band.as_ref().map_or(1, |band| band.stride(rate));
        let cut = left_out(
            band.as_ref(),
            recording.band_limited && is_driven,
            periodic,
            history.len(),
        );
        let inside = inside(history.len(), cut, stride, choice).ok_or_else(|| too_short(history, recording, cut))?;
        Ok(Self {
            start: history.start,
            rate,
            band,
            periodic,
            inside,
            choice,
        })
    }

    /// Series of a sensor with these samples and their noise. It has at least `fewest` values if the record does.
    fn series(&self, run: usize, sensor: &Point, (samples, noise): (&[f64], f64), fewest: usize) -> Series {
        let filtered = self.band.as_ref().map(|band| band.of(samples, self.periodic));
        let samples = filtered.as_deref().unwrap_or(samples);
        let noise = self.band.as_ref().map_or(1.0, Band::of_noise) * noise;
        let at: Vec<f64> = self.inside.iter().map(|&k| self.start + k as f64 / self.rate).collect();
        let mut series = Series {
            run,
            sensor: sensor.clone(),
            kind: Kind::Time,
            sigma: vec![noise.hypot(FLOOR * deviation(samples)); at.len()],
            noise: vec![noise.hypot(LEAST_NOISE * deviation(samples)); at.len()],
            least_discrepancy: FLOOR,
            at,
            value: self.inside.iter().map(|&k| Complex::from(samples[k])).collect(),
        };
        let step = (series.at[series.at.len() - 1] - series.at[0]) / series.at.len() as f64;
        let usual = (series.half_a_period() / (IN_HALF_A_PERIOD * step)) as usize;
        let step = usual.min(series.at.len() / fewest.max(1)).max(1);
        series.thin(step, self.choice);
        series
    }
}

/// One in each so many samples of a record without `cut` samples at each end; `None` if too few are left.
fn inside(samples: usize, cut: usize, stride: usize, choice: Choice) -> Option<Vec<usize>> {
    const FEWEST: usize = 20;
    let left = samples.saturating_sub(2 * cut);
    let inside = choice.of(cut..cut + left, left.div_ceil(MOST_VALUES).max(stride));
    (inside.len() >= FEWEST).then_some(inside)
}

fn too_short(history: &History, recording: &Recording, reach: usize) -> InputError {
    let seconds = |samples: usize| samples as f64 / history.sample_rate;
    let found = format!("a record of {} s", seconds(history.len()));
    let (expected, remedy) = match recording.band {
        Some((low, high)) => (
            format!(
                "one longer than the {} s that the filter of `band = [{low}, {high}]` takes, by 20 samples of that \
                 band",
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
