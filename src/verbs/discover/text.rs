//! The answer of a search as text.

use std::fmt::Write;

use qcar_runtime::discover::answer::{Finding, Verdict};
use qcar_runtime::discover::numbers::LARGE;
use qcar_runtime::discover::observe::Kind;
use qcar_runtime::discover::posterior::{Explanation, Misfit};

use super::Answer;
use super::finding::{described, rivals};
use super::fitted::{at_bound, offsets_table};
use super::learned;
use super::nuisances;
use super::places::{PlaceStiffness, missing};
use super::verdict::{choice, sentence};
use crate::effects;
use crate::sensor_residuals::{SensorResidual, channel, left};
use crate::table::{Table, noted, number, or_dash};
use crate::units;

pub(super) fn text(of: &Answer) -> String {
    let (column, last) = last(of);
    let (before, after) = (&of.discovery.before.misfit, &last.misfit);
    let mut out = format!("{}: {}\n{}\n", of.campaign, sentence(of), noted(&of.evidence.notices));
    let mut residuals = Table::new(["residual_in_sd", "before", column]);
    for (name, before, after) in [
        ("fit", before.fit, after.fit),
        ("held_out", before.held_out, after.held_out),
    ] {
        let [before, after] = [before, after].map(|value| or_dash(value.is_finite().then_some(value), 3));
        residuals.row(vec![name.into(), before, after]);
    }
    out += &residuals.text();
    if let Some(probability) = of.discovery.probability {
        let _ = writeln!(out, "\nprobability of this answer: {probability:.3}");
    }
    out += &candidates(of);
    out += &remaining(of);
    let findings = &of.discovery.findings;
    for (place, (finding, units)) in findings.iter().zip(&of.units).enumerate() {
        let is_beside = |other: &&Finding| other.alternative.is_none() || other.alternative == finding.alternative;
        let among = findings.iter().filter(is_beside).count();
        out += &format!(
            "\n{}{}",
            choice(findings, place),
            described(finding, among, of.evidence.judging(), units)
        );
        // Effects of one set have the same rivals.
        let next = findings.get(place + 1);
        if next.is_none_or(|next| next.rivals != finding.rivals) {
            out += &rivals(finding);
        }
    }
    out += &error_of_form(of);
    out += &nuisances::text(of);
    for (name, end) in at_bound(&of.discovery.after) {
        let _ = writeln!(out, "\n{name} is at the {end} end of its range");
    }
    if let Some(offsets) = offsets_table(&of.discovery.after) {
        out += &format!("\nzero offsets of the sensors of records\n{offsets}");
    }
    if of.discovery.verdict != Verdict::None {
        out += &format!("\nlargest residuals of the campaign's model\n{}", tiles(of, before));
    }
    if of.discovery.verdict == Verdict::Found || of.discovery.learned.is_some() {
        out += &format!("\nlargest residuals that remain\n{}", tiles(of, after));
    }
    if of.discovery.verdict == Verdict::Unknown {
        out += &missing(of).first().map_or_else(String::new, PlaceStiffness::sentence);
    }
    out += &learned::text(of);
    if of.detection_limits().next().is_some() {
        out += &format!(
            "\ndetection limits: a usual size of each effect, relative to the smallest that would be found\n{}",
            detection_limits(of)
        );
    }
    if let Some(file) = of.model.as_ref().and_then(|model| model.file.as_ref()) {
        let _ = writeln!(out, "\nmodel file: {}", file.display());
    }
    out
}

/// What the standard errors leave out, if the answer leaves more than noise; else empty.
fn error_of_form(of: &Answer) -> String {
    let left = of.discovery.after.misfit.judged(&of.evidence);
    if of.discovery.findings.is_empty() || left <= LARGE {
        return String::new();
    }
    format!(
        "\n{} standard deviations remain: a law may have another form, and the standard errors do not include that\n",
        number(left, 3)
    )
}

/// What the base model is compared with, and the title of its column: the model with the learned law, or else the answer.
fn last(of: &Answer) -> (&'static str, &Explanation) {
    match &of.discovery.learned {
        Some(law) => ("with_law", &law.explanation),
        None => ("after", &of.discovery.after),
    }
}

/// The most probable effects as a table; empty without any. An effect of an answer with several may explain little
/// alone, so the columns say that they are of the effect alone. If a law was learned or the answer has no probability, the
/// title says that the probabilities only compare the effects.
fn candidates(of: &Answer) -> String {
    let all = &of.discovery.candidates;
    if all.is_empty() {
        return String::new();
    }
    let title = match (&of.discovery.learned, of.discovery.probability) {
        (Some(_), _) => "effects of the catalogue, compared with each other and not with the law\n",
        (None, None) => "effects of the catalogue, compared with each other; none of them is an answer\n",
        (None, _) => "",
    };
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
            or_dash(own.log_evidence, 4),
        ]);
    }
    format!("\n{title}{}", table.text())
}

/// Residual of each sensor.
fn remaining(of: &Answer) -> String {
    let (column, last) = last(of);
    let mut table = Table::new(["residual_in_%_of_signal", "run", "before", column]);
    let left = left(&of.evidence, [&of.discovery.before, last]);
    for own in &left {
        let is_alike = |other: &&SensorResidual| (&other.channel, other.kind) == (&own.channel, own.kind);
        let sensor = match left.iter().filter(is_alike).count() {
            1 => own.channel.clone(),
            _ => format!("{} {}", own.channel, own.quantity),
        };
        let (before, after) = (number(own.before_percent, 3), number(own.after_percent, 3));
        table.row(vec![sensor, own.kind.into(), before, after]);
    }
    format!("\n{}", table.text())
}

/// Detection limits as a table.
fn detection_limits(of: &Answer) -> String {
    let mut table = Table::new(["effect", "at", "times_the_limit", "of_this_size"]);
    for own in of.detection_limits() {
        let of_effect = effects::units(&own.effect, &own.at, &of.base);
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

/// Number of listed parts of a residual.
const LISTED: usize = 5;

fn tiles(of: &Answer, misfit: &Misfit) -> String {
    let mut table = Table::new([
        "channel",
        "run",
        "harmonic",
        "from",
        "to",
        "unit",
        "times_the_uncertainty",
    ]);
    for tile in misfit.tiles.iter().take(LISTED) {
        let unit = unit_of_span(tile.kind);
        table.row(vec![
            channel(&tile.sensor),
            of.evidence.runs[tile.run].name.clone(),
            tile.kind.order().map_or("-".into(), |order| order.to_string()),
            number(units::value(tile.span.0, unit), 3),
            number(units::value(tile.span.1, unit), 3),
            units::name(unit).into(),
            number(tile.strength, 3),
        ]);
    }
    table.text()
}
