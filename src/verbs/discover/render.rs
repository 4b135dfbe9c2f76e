//! The answer of a search, as text and as JSON.

use std::cmp::Ordering;
use std::collections::BTreeMap;
use std::fmt::Write;

use qcar_runtime::discover::answer::{DetectionLimit, Finding, Probable, Rival, Verdict};
use qcar_runtime::discover::numbers::DOUBTFUL_BELOW;
use qcar_runtime::discover::observe::Kind;
use qcar_runtime::discover::posterior::{Explanation, Tile};
use qcar_runtime::mean::rms_or_nan;
use qcar_runtime::transmissibility::Point;
use serde::Serialize;

use super::Answer;
use super::finding::described;
use super::learned;
use super::nuisances::{self, Nuisance};
use super::places::{self, PlaceStiffness};
use crate::effects;
use crate::json::{self, Ordered};
use crate::sensor_residuals::{BeforeAfter, SensorResidual, channel, left};
use crate::table::{Table, noted, number, or_dash};
use crate::units;

/// The answer as `docs/json.md` describes it.
#[derive(Serialize)]
pub(crate) struct Result<'a> {
    campaign: &'a str,
    model: &'a str,
    verdict: Verdict,
    /// Probability of the answer.
    probability: Option<f64>,
    /// The most probable effects.
    candidates: &'a [Probable],
    /// Residual of each sensor on the held-out runs, or on the fitted runs if none is held out.
    left: Vec<SensorResidual>,
    effects: Vec<Effect<'a>>,
    /// Nuisance effects that were fitted with the findings.
    nuisances: Vec<Nuisance<'a>>,
    r#where: Vec<ResidualPart>,
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
    /// True for an alternative of a class.
    one_of: bool,
    parameters: Ordered<f64>,
    stderr: Ordered<Option<f64>>,
    units: &'a BTreeMap<String, String>,
    evidence: Evidence,
    rivals: &'a [Rival],
}

/// Zero offset of the sensor of a record.
#[derive(Serialize)]
struct Offset {
    channel: String,
    quantity: &'static str,
    offset: f64,
    stderr: Option<f64>,
    unit: &'static str,
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
        probability: of.discovery.probability,
        candidates: &of.discovery.candidates,
        left: left(&of.evidence, [&of.discovery.before, &of.discovery.after]),
        effects: of
            .discovery
            .findings
            .iter()
            .zip(&of.units)
            .enumerate()
            .map(|(place, own)| effect(of, place, own))
            .collect(),
        nuisances: nuisances::json(of),
        r#where: before.tiles.iter().take(LISTED).map(place).collect(),
        places: missing(of),
        visible: of.discovery.detection_limits.iter().map(limit).collect(),
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

/// Places that explain the residuals; none if the verdict is `None`.
fn missing(of: &Answer) -> Vec<PlaceStiffness> {
    match of.discovery.verdict {
        Verdict::None => Vec::new(),
        _ => places::places(of),
    }
}

fn effect<'a>(
    of: &'a Answer,
    place: usize,
    (finding, units): (&'a Finding, &'a BTreeMap<String, String>),
) -> Effect<'a> {
    let alone = of.discovery.findings.len() == 1;
    let each = |value: fn(&(String, f64, f64)) -> f64| {
        let named = finding.parameters.iter().map(move |p| (p.0.clone(), value(p)));
        named.collect::<Vec<_>>()
    };
    Effect {
        name: &finding.effect,
        at: &finding.at,
        form: finding.form.as_deref(),
        one_of: place >= of.discovery.certain_and_alternatives().0.len(),
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

fn place(tile: &Tile) -> ResidualPart {
    ResidualPart {
        channel: channel(&tile.sensor),
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

/// Zero offsets of the sensors of records.
fn offsets(of: &Explanation) -> Vec<Offset> {
    let offsets = of.refit.offsets().into_iter();
    let offset = |(sensor, offset, stderr): (Point, f64, f64)| Offset {
        channel: channel(&sensor),
        quantity: sensor.quantity.name(),
        offset,
        stderr: stderr.is_finite().then_some(stderr),
        unit: sensor.quantity.unit(),
    };
    offsets.map(offset).collect()
}

/// The parameters at a bound of their range, each with the name of the bound.
fn at_bound(of: &Explanation) -> impl Iterator<Item = (String, &'static str)> {
    let free = of.refit.free.iter().zip(&of.refit.at_bound);
    free.filter_map(|(free, side)| {
        let name = of.named[free.parameter].0.clone();
        match side.cmp(&0) {
            Ordering::Less => Some((name, "lower")),
            Ordering::Equal => None,
            Ordering::Greater => Some((name, "upper")),
        }
    })
}

/// A parameter file for `--params`, with the zero offsets of the sensors as comments.
pub(super) fn parameters(heading: &str, of: &Explanation) -> String {
    let mut out = format!("# {heading}\n\n[parameters]\n");
    let ends: BTreeMap<String, &str> = at_bound(of).collect();
    for (name, value) in &of.named {
        let end = ends.get(name);
        let remark = end.map_or(String::new(), |end| format!(" # at the {end} end of its range"));
        let _ = writeln!(out, "{name} = {value:?}{remark}");
    }
    for own in offsets(of) {
        let error = own
            .stderr
            .map_or(String::new(), |error| format!(", standard error {error:.2e}"));
        let Offset {
            channel,
            quantity,
            offset,
            unit,
            ..
        } = own;
        let _ = writeln!(out, "# offset of {channel} {quantity}: {offset:.4e} {unit}{error}");
    }
    out
}

fn offsets_table(of: &Explanation) -> String {
    let mut table = Table::new(["channel", "quantity", "unit", "offset", "stderr"]);
    for own in offsets(of) {
        let shown = |value| units::value(value, own.unit);
        let numbers = [number(shown(own.offset), 4), or_dash(own.stderr.map(shown), 2)];
        let names = [own.channel, own.quantity.into(), units::name(own.unit).into()];
        table.row(names.into_iter().chain(numbers).collect());
    }
    table.text()
}

pub(super) fn text(of: &Answer) -> String {
    let (before, after) = (&of.discovery.before.misfit, &of.discovery.after.misfit);
    let mut out = format!("{}: {}\n{}\n", of.campaign, sentence(of), noted(&of.evidence.notices));
    let mut residuals = Table::new(["residual_in_sd", "before", "after"]);
    for (name, before, after) in [
        ("fit", before.fit, after.fit),
        ("held_out", before.held_out, after.held_out),
    ] {
        residuals.row(vec![name.into(), number(before, 3), number(after, 3)]);
    }
    out += &residuals.text();
    if let Some(probability) = of.discovery.probability {
        let _ = writeln!(out, "\nprobability of this answer: {probability:.3}");
    }
    out += &candidates(&of.discovery.candidates);
    out += &remaining(of);
    let certain = of.discovery.certain_and_alternatives().0.len();
    for (place, (finding, units)) in of.discovery.findings.iter().zip(&of.units).enumerate() {
        let among = if place < certain { certain } else { certain + 1 };
        out += &format!("\n{}{}", choice(of, place), described(finding, among, units));
    }
    out += &nuisances::text(of);
    for (name, end) in at_bound(&of.discovery.after) {
        let _ = writeln!(out, "\n{name} is at the {end} end of its range");
    }
    if !of.discovery.after.refit.offsets().is_empty() {
        out += &format!(
            "\nzero offsets of the sensors of records\n{}",
            offsets_table(&of.discovery.after)
        );
    }
    if of.discovery.verdict != Verdict::None {
        out += &format!("\nlargest residuals of the campaign's model\n{}", tiles(of));
        out += &missing(of).first().map_or_else(String::new, PlaceStiffness::sentence);
    }
    out += &learned::text(of);
    if !of.discovery.detection_limits.is_empty() {
        out += &format!(
            "\neffects that would have been found: their size relative to the smallest that is certain\n{}",
            detection_limits(of)
        );
    }
    if let Some(file) = of.model.as_ref().and_then(|model| model.file.as_ref()) {
        let _ = writeln!(out, "\nmodel file: {}", file.display());
    }
    out
}

/// The most probable effects as a table; empty without any. An effect of an answer with several may explain little
/// alone, so the columns say that they are of the effect alone.
fn candidates(all: &[Probable]) -> String {
    if all.is_empty() {
        return String::new();
    }
    let mut table = Table::new([
        "candidate",
        "at",
        "probability",
        "explains_alone_%",
        "log_evidence_alone",
    ]);
    for own in all {
        table.row(vec![
            own.effect.clone(),
            own.at.clone(),
            format!("{:.3}", own.probability),
            or_dash(own.explained.map(|share| 100.0 * share), 3),
            number(own.log_evidence, 4),
        ]);
    }
    format!("\n{}", table.text())
}

/// Residual of each sensor.
fn remaining(of: &Answer) -> String {
    let mut table = Table::new(["residual_in_%_of_signal", "run", "before", "after"]);
    for own in left(&of.evidence, [&of.discovery.before, &of.discovery.after]) {
        let (before, after) = (number(own.before_percent, 3), number(own.after_percent, 3));
        table.row(vec![own.channel, own.kind.into(), before, after]);
    }
    format!("\n{}", table.text())
}

/// The verdict as a sentence.
pub(crate) fn sentence(of: &Answer) -> String {
    let (found, class) = of.discovery.certain_and_alternatives();
    match of.discovery.verdict {
        Verdict::None => nothing_found(of),
        Verdict::Found => format!("found {}", listed(found)),
        Verdict::Class if found.is_empty() => format!("these data cannot distinguish {}", listed(class)),
        Verdict::Class => format!(
            "found {}, and in addition these data cannot distinguish {}",
            listed(found),
            listed(class)
        ),
        Verdict::Unknown => "something is missing that no effect of the catalogue explains".into(),
    }
}

/// RMS residual in standard deviations above which noise does not explain it. Sensors with errors beyond their data
/// sheets leave less. `LARGE` in the report's `judgement.js` is the same limit.
const LARGE: f64 = 2.0;

/// The verdict `None` as a sentence. It depends on the held-out runs: if the fitted runs show no effect, the model may
/// still predict others badly.
fn nothing_found(of: &Answer) -> String {
    let gap = &of.discovery.before.misfit;
    let (runs, left) = match gap.held_out.is_finite() {
        true => ("held-out", gap.held_out),
        false => ("fitted", gap.fit),
    };
    if left > LARGE {
        let left = number(left, 3);
        format!("no effect found, but the {runs} runs have residuals of {left} standard deviations")
    } else if is_doubtful(of) {
        "no effect is certain: small residuals above noise remain".into()
    } else {
        "no effect found: noise explains the residuals".into()
    }
}

/// True if the probability of the answer is below one half.
fn is_doubtful(of: &Answer) -> bool {
    of.discovery
        .probability
        .is_some_and(|probability| probability < DOUBTFUL_BELOW)
}

/// Word before the name of a finding: `either` or `or` for an alternative.
pub(crate) fn choice(of: &Answer, place: usize) -> &'static str {
    let found = of.discovery.certain_and_alternatives().0.len();
    match place.cmp(&found) {
        Ordering::Less => "",
        Ordering::Equal => "either ",
        Ordering::Greater => "or ",
    }
}

fn listed(findings: &[Finding]) -> String {
    let names = findings.iter().map(|own| format!("{} at {}", own.effect, own.at));
    names.collect::<Vec<_>>().join(" and ")
}

/// Detection limits as a table.
fn detection_limits(of: &Answer) -> String {
    let mut table = Table::new(["effect", "at", "times_the_limit", "of_this_size"]);
    for own in &of.discovery.detection_limits {
        let of_effect = effects::units(&own.effect);
        let usual = own.default_size.iter().map(|(name, value)| {
            let si = of_effect.get(name).map_or("1", String::as_str);
            units::with_unit(&format!("{name} {}", number(units::value(*value, si), 3)), si)
        });
        table.row(vec![
            own.effect.clone(),
            own.at.clone(),
            number(own.over_limit, 2),
            usual.collect::<Vec<_>>().join(", "),
        ]);
    }
    table.text()
}

/// Unit of the span of a tile.
fn unit_of_span(kind: Kind) -> &'static str {
    match kind {
        Kind::Harmonic(_) | Kind::Cycle(_) => "Hz",
        Kind::Time | Kind::Passage => "s",
        Kind::Travel | Kind::Width => "m",
        Kind::Speed => "m/s",
    }
}

fn tiles(of: &Answer) -> String {
    let mut table = Table::new([
        "channel",
        "harmonic",
        "from",
        "to",
        "unit",
        "level",
        "times_the_uncertainty",
    ]);
    for tile in of.discovery.before.misfit.tiles.iter().take(8) {
        let unit = unit_of_span(tile.kind);
        table.row(vec![
            channel(&tile.sensor),
            tile.kind.order().map_or("-".into(), |order| order.to_string()),
            number(units::value(tile.span.0, unit), 3),
            number(units::value(tile.span.1, unit), 3),
            units::name(unit).into(),
            number(tile.level, 3),
            number(tile.strength, 3),
        ]);
    }
    table.text()
}
