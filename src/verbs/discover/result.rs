//! The answer of a search as JSON.

use std::collections::BTreeMap;

use qcar_runtime::discover::answer::{DetectionLimit, Finding, Probable, Rival, Verdict};
use qcar_runtime::discover::observe::Kind;
use qcar_runtime::discover::posterior::{Misfit, Tile};
use qcar_runtime::mean::rms_or_nan;
use qcar_runtime::transmissibility::Point;
use serde::Serialize;

use super::Answer;
use super::fitted::{Offset, at_bound, offsets};
use super::learned;
use super::nuisances::{self, Nuisance};
use super::places::{self, PlaceStiffness, missing};
use super::verdict::is_partly_explained;
use crate::json::{self, Ordered};
use crate::sensor_residuals::{BeforeAfter, SensorResidual, channel, left};

/// The answer as `docs/json.md` describes it.
#[derive(Serialize)]
pub(crate) struct Result<'a> {
    campaign: &'a str,
    model: &'a str,
    verdict: Verdict,
    /// True if the findings leave large residuals.
    partly_explained: bool,
    /// Probability of the answer.
    probability: Option<f64>,
    /// The most probable effects.
    candidates: &'a [Probable],
    /// Residual of each sensor on the runs that judge a model.
    left: Vec<SensorResidual>,
    effects: Vec<Effect<'a>>,
    /// Nuisance effects that were fitted with the findings.
    nuisances: Vec<Nuisance<'a>>,
    r#where: Vec<ResidualPart>,
    remains: Vec<ResidualPart>,
    places: Vec<PlaceStiffness>,
    visible: Vec<Limit<'a>>,
    learned: Option<learned::Learned<'a>>,
    gap: Gaps,
    by_channel: Ordered<BeforeAfter>,
    offsets: Vec<Offset>,
    at_bound: Ordered<&'static str>,
    model_file: Option<String>,
    notices: &'a [String],
    seconds: f64,
}

#[derive(Serialize)]
struct Effect<'a> {
    name: &'a str,
    at: &'a str,
    form: Option<&'a str>,
    /// True for an effect of an alternative of a class.
    one_of: bool,
    /// Number of that alternative, 0 for the most probable one.
    alternative: Option<usize>,
    parameters: Ordered<f64>,
    stderr: Ordered<Option<f64>>,
    units: &'a BTreeMap<String, String>,
    evidence: Evidence,
    rivals: &'a [Rival],
}

/// Detection limit of an effect that was not found.
#[derive(Serialize)]
struct Limit<'a> {
    name: &'a str,
    at: &'a str,
    usual: Ordered<f64>,
    times_the_limit: f64,
}

#[derive(Serialize)]
struct Evidence {
    /// Increase of the log evidence by all findings.
    log_evidence: f64,
    /// Share of the excess residual that the findings explain; `null` if there is none.
    gap_closed: Option<f64>,
    /// Share of the sweeps' residual that is explained, relative to the largest share that any effect at this place
    /// could explain; `null` if there are several findings.
    of_ceiling: Option<f64>,
}

#[derive(Serialize)]
struct ResidualPart {
    channel: String,
    /// Its file.
    run: String,
    harmonic: Option<usize>,
    band_hz: Option<(f64, f64)>,
    /// For values over time.
    window_s: Option<(f64, f64)>,
    /// For values over the travel of the wheel.
    travel_m: Option<(f64, f64)>,
    speed_m_per_s: Option<(f64, f64)>,
    level: f64,
    strength: f64,
}

#[derive(Serialize)]
struct Gaps {
    fit: BeforeAfter,
    held_out: BeforeAfter,
}

/// Number of listed tiles.
const LISTED: usize = 24;

pub(super) fn json(of: &Answer) -> String {
    json::line(&result(of))
}

pub(crate) fn result(of: &Answer) -> Result<'_> {
    let (before, after) = (&of.discovery.before.misfit, &of.discovery.after.misfit);
    Result {
        campaign: &of.campaign,
        model: &of.base_model,
        verdict: of.discovery.verdict,
        partly_explained: is_partly_explained(of),
        probability: of.discovery.probability,
        candidates: &of.discovery.candidates,
        left: left(&of.evidence, [&of.discovery.before, &of.discovery.after]),
        effects: of
            .discovery
            .findings
            .iter()
            .zip(&of.units)
            .map(|own| effect(of, own))
            .collect(),
        nuisances: nuisances::json(of),
        r#where: parts(before, of),
        remains: parts(after, of),
        places: missing(of),
        visible: of.detection_limits().map(limit).collect(),
        learned: learned::learned(of),
        gap: Gaps {
            fit: BeforeAfter::new(before.fit, after.fit),
            held_out: BeforeAfter::new(before.held_out, after.held_out),
        },
        by_channel: by_channel(of),
        offsets: offsets(&of.discovery.after),
        at_bound: at_bound(&of.discovery.after).collect(),
        model_file: of
            .model
            .as_ref()
            .and_then(|model| model.file.as_ref())
            .map(|file| file.display().to_string()),
        notices: &of.evidence.notices,
        seconds: of.seconds,
    }
}

fn effect<'a>(of: &'a Answer, (finding, units): (&'a Finding, &'a BTreeMap<String, String>)) -> Effect<'a> {
    let alone = of.discovery.findings.len() == 1;
    let each = |value: fn(&(String, f64, f64)) -> f64| {
        let named = finding.parameters.iter().map(move |p| (p.0.clone(), value(p)));
        named.collect::<Vec<_>>()
    };
    Effect {
        name: &finding.effect,
        at: &finding.at,
        form: finding.form.as_deref(),
        one_of: finding.alternative.is_some(),
        alternative: finding.alternative,
        parameters: each(|p| p.1).into_iter().collect(),
        stderr: each(|p| p.2)
            .into_iter()
            .map(|(name, e)| (name, e.is_finite().then_some(e)))
            .collect(),
        units,
        evidence: Evidence {
            log_evidence: finding.evidence,
            gap_closed: finding.explained,
            of_ceiling: places::of_ceiling(of, &finding.at).filter(|_| alone),
        },
        rivals: &finding.rivals,
    }
}

fn limit(of: &DetectionLimit) -> Limit<'_> {
    Limit {
        name: &of.effect,
        at: &of.at,
        usual: of.default_size.iter().cloned().collect(),
        times_the_limit: of.over_limit,
    }
}

/// The largest parts of a residual.
fn parts(misfit: &Misfit, of: &Answer) -> Vec<ResidualPart> {
    let largest = misfit.tiles.iter().take(LISTED);
    largest
        .map(|tile| part(tile, &of.evidence.runs[tile.run].name))
        .collect()
}

fn part(tile: &Tile, run: &str) -> ResidualPart {
    ResidualPart {
        channel: channel(&tile.sensor),
        run: run.into(),
        harmonic: tile.kind.order(),
        band_hz: tile.kind.order().map(|_| tile.span),
        window_s: matches!(tile.kind, Kind::Time | Kind::Passage).then_some(tile.span),
        travel_m: matches!(tile.kind, Kind::Travel | Kind::Width).then_some(tile.span),
        speed_m_per_s: (tile.kind == Kind::Speed).then_some(tile.span),
        level: tile.level,
        strength: tile.strength,
    }
}

/// RMS of the normalised residuals of each sensor over all runs.
fn by_channel(of: &Answer) -> Ordered<BeforeAfter> {
    let mut sensors: Vec<&Point> = of.evidence.series.iter().map(|series| &series.sensor).collect();
    sensors.sort();
    sensors.dedup();
    let rms = |sensor: &Point, residuals: &[Vec<f64>]| {
        let of_sensor = of
            .evidence
            .series
            .iter()
            .zip(residuals)
            .filter(|(series, _)| series.sensor == *sensor);
        rms_or_nan(of_sensor.flat_map(|(_, residuals)| residuals.iter().copied()))
    };
    let (before, after) = (&of.discovery.before.misfit, &of.discovery.after.misfit);
    let named = sensors.into_iter().map(|sensor| {
        let both = BeforeAfter::new(rms(sensor, &before.residuals), rms(sensor, &after.residuals));
        (channel(sensor), both)
    });
    named.collect()
}
