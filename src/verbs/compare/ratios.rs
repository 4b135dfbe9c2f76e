//! Transmissibilities of both sides and of the measurements.

use std::f64::consts::PI;

use nalgebra::Complex;
use qcar_runtime::campaign::{Campaign, Role, Test};
use qcar_runtime::discover::Evidence;
use qcar_runtime::error::InputError;
use qcar_runtime::fit::Level;
use qcar_runtime::fit::measure::levels;
use qcar_runtime::fit::observation::Observation;
use qcar_runtime::fit::quality::{Quality, quality};
use qcar_runtime::model::{About, Channel};
use qcar_runtime::progress::OnProgress;
use qcar_runtime::response::unit::unit;
use qcar_runtime::transmissibility::Options;
use serde::Serialize;

use super::sides::{Measured, Side};
use crate::progress::while_counting;
use crate::report::rounded::{curve, rounded};
use crate::verbs::frf;
use crate::verbs::study::level_responses::{LevelResponses, between, swept_by};
use crate::verbs::study::rig::{Polar, band, nearest, unwrapped};

/// A channel of both models; if measured, in the run of the measurement.
#[derive(Serialize)]
pub(super) struct Ratio {
    pub channel: String,
    /// SI unit of the ratio.
    pub unit: String,
    /// File of the run; of A, if two campaigns are compared.
    pub run: Option<String>,
    /// Role: `fit` or `held_out`.
    role: Option<&'static str>,
    /// Frequencies, Hz.
    pub frequency: Vec<f64>,
    /// Ratios of the models.
    pub a: Polar,
    pub b: Polar,
    /// Ratio of B to A.
    pub change: Polar,
    /// Measured ratios: one of the common campaign, or one of each campaign.
    pub measured: Vec<Curve>,
    /// Ratio of the measurement of B to that of A, for two campaigns.
    measured_change: Option<Polar>,
    /// Fit of each model to the measurement.
    quality: Vec<Quality>,
}

/// A measured ratio.
#[derive(Serialize)]
pub(super) struct Curve {
    pub value: Polar,
    /// Uncertainty to either side.
    pub band: Polar,
    /// Share of the power that the excitation explains, 0 to 1.
    pub coherence: Vec<f64>,
}

/// Summary of a channel.
#[derive(Serialize)]
pub(super) struct Summary<'a> {
    pub channel: &'a str,
    pub run: Option<&'a str>,
    pub role: Option<&'static str>,
    /// Difference of the models.
    pub change: Option<Largest>,
    /// Difference of the measurements of two campaigns.
    pub measured: Option<Largest>,
    /// Magnitude fit of each model, percent.
    pub fit: Option<[f64; 2]>,
    /// Mean coherence of each measurement over the lines, 0 to 1.
    pub coherence: Vec<f64>,
}

/// Largest difference of B from A.
#[derive(Serialize)]
pub(super) struct Largest {
    /// Difference, dB.
    pub magnitude: f64,
    /// Frequency of the largest difference, Hz.
    pub frequency: f64,
    /// Root mean square of the difference over the lines, dB.
    pub rms: f64,
}

impl Ratio {
    pub(super) fn summary(&self) -> Summary<'_> {
        Summary {
            channel: &self.channel,
            run: self.run.as_deref(),
            role: self.role,
            change: self.largest(&self.change),
            measured: self.measured_change.as_ref().and_then(|change| self.largest(change)),
            fit: match self.quality.as_slice() {
                [a, b] => Some([a.fit_magnitude, b.fit_magnitude]),
                _ => None,
            },
            coherence: self.measured.iter().map(Curve::mean_coherence).collect(),
        }
    }

    fn largest(&self, of: &Polar) -> Option<Largest> {
        let lines = of.magnitude.iter().zip(&self.frequency);
        let finite: Vec<_> = lines.filter(|(change, _)| change.is_finite()).collect();
        let (&magnitude, &frequency) = *finite.iter().max_by(|a, b| a.0.abs().total_cmp(&b.0.abs()))?;
        let square = finite.iter().map(|(change, _)| *change * *change).sum::<f64>() / finite.len() as f64;
        Some(Largest {
            magnitude,
            frequency,
            rms: rounded(square.sqrt()),
        })
    }
}

impl Curve {
    fn mean_coherence(&self) -> f64 {
        let known: Vec<f64> = self
            .coherence
            .iter()
            .copied()
            .filter(|share| share.is_finite())
            .collect();
        rounded(known.iter().sum::<f64>() / known.len() as f64)
    }
}

/// Both sides for small motions.
fn at_rest(sides: &[Side; 2]) -> [LevelResponses<'_>; 2] {
    sides
        .each_ref()
        .map(|side| LevelResponses::at_rest(&*side.model, &side.values))
}

/// A side in the runs of a campaign.
fn swept<'a>(side: &'a Side, campaign: &Campaign) -> Result<LevelResponses<'a>, InputError> {
    if side.model.about().linear {
        return Ok(LevelResponses::at_rest(&*side.model, &side.values));
    }
    while_counting(swept_by(&campaign.name, &*side.model), |on_progress| {
        let evidence = Evidence::from_campaign(campaign, side.model.about())?;
        Ok(LevelResponses::new(&*side.model, &side.values, &evidence, on_progress))
    })
}

/// Channels that both models have, without measurements, at these frequencies (Hz).
pub(super) fn modelled(sides: &[Side; 2], frequency: &[f64]) -> Vec<Ratio> {
    let [a, b] = sides.each_ref().map(|side| side.model.about());
    let mut models = at_rest(sides);
    let is_of_b = |own: &&Channel| b.channels.iter().any(|other| other.name == own.name);
    let ratio = |channel: &Channel| {
        let mut value = |side: usize, about| {
            let excitation = frf::excitation(about, channel).ok()?;
            models[side].ratio("", excitation, channel, frequency)
        };
        let values = [value(0, a)?, value(1, b)?];
        Some(together((channel, unit(a, channel)), frequency, values, [None, None]))
    };
    a.channels.iter().filter(is_of_b).filter_map(ratio).collect()
}

/// Measured channels of a campaign, with both models.
///
/// # Errors
/// Fails if a run cannot be read.
pub(super) fn of_campaign(sides: &[Side; 2], campaign: &Campaign) -> Result<Vec<Ratio>, InputError> {
    let about = sides[0].model.about();
    let measure = |on_progress: OnProgress<'_>| levels(campaign, about, None, &Options::default(), on_progress);
    let levels = while_counting(format!("{}: transmissibilities of run", campaign.name), measure)?;
    let mut models = [swept(&sides[0], campaign)?, swept(&sides[1], campaign)?];
    let [first, second] = sides.each_ref().map(|side| &side.model.about().excitations);
    let mut ratios = Vec::new();
    for level in &levels {
        let driven = &first[level.excitation].name;
        let Some(same) = second.iter().position(|excitation| excitation.name == *driven) else {
            continue;
        };
        let runs = [(level.name.as_str(), level.excitation), (level.name.as_str(), same)];
        let ratio = |own: &Observation| in_run(&mut models, about, (level, runs), own, None);
        ratios.extend(level.observations.iter().filter_map(ratio));
    }
    Ok(ratios)
}

/// Channels that both campaigns have measured in similar runs.
///
/// # Errors
/// Fails if a run cannot be read.
pub(super) fn of_campaigns(sides: &[Side; 2], [a, b]: [&Measured; 2]) -> Result<Vec<Ratio>, InputError> {
    let about = sides[0].model.about();
    let mut models = [swept(&sides[0], &a.campaign)?, swept(&sides[1], &b.campaign)?];
    let mut ratios = Vec::new();
    for level in &a.levels {
        let mut others = b.levels.iter();
        let Some(other) = others.find(|other| alike(&a.campaign, level, &b.campaign, other)) else {
            continue;
        };
        let runs = [
            (level.name.as_str(), level.excitation),
            (other.name.as_str(), other.excitation),
        ];
        for own in &level.observations {
            let mut others = other.observations.iter();
            if let Some(second) = others.find(|second| second.channel.name == own.channel.name) {
                ratios.extend(in_run(&mut models, about, (level, runs), own, Some(second)));
            }
        }
    }
    Ok(ratios)
}

/// Two runs with equal excitation.
fn alike(a: &Campaign, first: &Level, b: &Campaign, second: &Level) -> bool {
    let test = |campaign: &Campaign, level: &Level| {
        let run = campaign.runs.iter().find(|run| run.name == level.name);
        run.map(|run| run.test.clone())
    };
    match (test(a, first), test(b, second)) {
        (Some(Test::Sweep(a)), Some(Test::Sweep(b))) => (a.peak_velocity / b.peak_velocity - 1.0).abs() < 0.02,
        (Some(Test::TimeHistory(_)), Some(Test::TimeHistory(_))) => first.name == second.name,
        _ => false,
    }
}

/// A channel of a run of A and of a run of B, each run with its excitation.
fn in_run(
    models: &mut [LevelResponses; 2],
    about: &About,
    (level, runs): (&Level, [(&str, usize); 2]),
    own: &Observation,
    other: Option<&Observation>,
) -> Option<Ratio> {
    let mut value = |side: usize| models[side].ratio(runs[side].0, runs[side].1, &own.channel, &own.frequency);
    let channel = (&own.channel, unit(about, &own.channel));
    let ratio = together(channel, &own.frequency, [value(0)?, value(1)?], [Some(own), other]);
    Some(Ratio {
        run: Some(level.name.clone()),
        role: Some(if level.role == Role::Fit { "fit" } else { "held_out" }),
        ..ratio
    })
}

fn together(
    (channel, unit): (&Channel, String),
    frequency: &[f64],
    [a, b]: [Vec<Complex<f64>>; 2],
    observed: [Option<&Observation>; 2],
) -> Ratio {
    let measured: Vec<Vec<Complex<f64>>> = observed.iter().flatten().map(|own| at(own, frequency)).collect();
    let first = measured.first().map_or(unwrapped(&a), |own| unwrapped(own));
    let beside = |values: &[Complex<f64>]| Polar::new(values, &nearest(values, &first));
    let quality_of = |(model, place): (&Vec<Complex<f64>>, usize)| {
        let own = measured.get(place).or(measured.first())?;
        Some(met(frequency, model, own))
    };
    Ratio {
        channel: channel.name.to_string(),
        unit,
        run: None,
        role: None,
        frequency: curve(frequency.iter().copied()),
        change: over(&b, &a),
        quality: [(&a, 0), (&b, 1)].into_iter().filter_map(quality_of).collect(),
        measured_change: match measured.as_slice() {
            [a, b] => Some(over(b, a)),
            _ => None,
        },
        measured: measured
            .iter()
            .zip(observed.iter().flatten())
            .map(|(values, own)| Curve {
                value: beside(values),
                band: band_at(own, frequency),
                coherence: curve(coherence_at(own, frequency)),
            })
            .collect(),
        a: beside(&a),
        b: beside(&b),
    }
}

/// Fit of a model to a measurement, at the lines where both are known.
fn met(frequency: &[f64], model: &[Complex<f64>], measured: &[Complex<f64>]) -> Quality {
    let known = |line: &usize| model[*line].is_finite() && measured[*line].is_finite();
    let lines: Vec<usize> = (0..frequency.len()).filter(known).collect();
    let at = |values: &[Complex<f64>]| lines.iter().map(|&line| values[line]).collect::<Vec<_>>();
    let frequency: Vec<f64> = lines.iter().map(|&line| frequency[line]).collect();
    quality(&frequency, &at(model), &at(measured))
}

/// Quotient of two ratios, with its phase within ±180°.
fn over(above: &[Complex<f64>], below: &[Complex<f64>]) -> Polar {
    let ratio: Vec<_> = above.iter().zip(below).map(|(above, below)| above / below).collect();
    let phase: Vec<f64> = ratio.iter().map(|value| value.arg().clamp(-PI, PI)).collect();
    Polar::new(&ratio, &phase)
}

/// Measured values at the lines of another run.
fn at(own: &Observation, frequency: &[f64]) -> Vec<Complex<f64>> {
    frequency
        .iter()
        .map(|&f| between(&own.frequency, &own.value, f))
        .collect()
}

fn coherence_at(own: &Observation, frequency: &[f64]) -> impl Iterator<Item = f64> {
    let lines: Vec<Complex<f64>> = own.coherence.iter().map(|&share| share.into()).collect();
    frequency.iter().map(move |&f| between(&own.frequency, &lines, f).re)
}

fn band_at(own: &Observation, frequency: &[f64]) -> Polar {
    let Polar { magnitude, phase } = band(own);
    let lines: Vec<Complex<f64>> = magnitude
        .iter()
        .zip(&phase)
        .map(|(&m, &p)| Complex::new(m, p))
        .collect();
    let values: Vec<_> = frequency.iter().map(|&f| between(&own.frequency, &lines, f)).collect();
    Polar {
        magnitude: curve(values.iter().map(|value| value.re)),
        phase: curve(values.iter().map(|value| value.im)),
    }
}
