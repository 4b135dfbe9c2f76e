//! The answer in a few numbers, for the head of the report and for the terminal.

use std::collections::BTreeMap;
use std::fmt::Write;
use std::path::Path;

use qcar_runtime::discover::search::Verdict;
use qcar_runtime::fit::report::ChannelFit;
use serde::Serialize;

use super::gather::{Study, Track};
use crate::table::{Table, number};
use crate::verbs::discover::render::sentence;
use crate::verbs::simulate::compared::Sizes;

/// The answer.
#[derive(Serialize)]
pub struct Summary {
    /// In words.
    pub missing: String,
    /// The words' first one: `none`, `found`, `class`, `unknown`.
    pub verdict: Verdict,
    /// Fit percentages of the fitted and of the held-out runs.
    pub fit: BTreeMap<&'static str, Percent>,
}

/// The lowest and the mean of the fit percentages over all channels.
#[derive(Serialize)]
pub struct Percent {
    mean_magnitude: f64,
    worst_magnitude: f64,
    mean_phase: f64,
}

/// The answer of a study.
pub fn summary(of: &Study) -> Summary {
    let roles = ["fit", "held_out"].into_iter();
    Summary {
        missing: sentence(&of.answer),
        verdict: of.answer.discovery.verdict,
        fit: roles
            .filter_map(|role| Some((role, percent(&of.fitted.fit.channels, role)?)))
            .collect(),
    }
}

fn percent(of: &[ChannelFit], role: &str) -> Option<Percent> {
    let of: Vec<&ChannelFit> = of.iter().filter(|channel| channel.role == role).collect();
    let mean = |value: fn(&ChannelFit) -> f64| of.iter().map(|channel| value(channel)).sum::<f64>() / of.len() as f64;
    let magnitudes = of.iter().map(|channel| channel.quality.fit_magnitude);
    (!of.is_empty()).then(|| Percent {
        mean_magnitude: mean(|channel| channel.quality.fit_magnitude),
        mean_phase: mean(|channel| channel.quality.fit_phase),
        worst_magnitude: magnitudes.fold(f64::INFINITY, f64::min),
    })
}

/// What the terminal gets.
pub fn text(of: &Study, folder: &Path) -> String {
    let summary = summary(of);
    let mut out = format!("{}: {}\n\n", of.fitted.campaign.name, summary.missing);
    out += &fits(&summary);
    if let Some(track) = &of.track {
        let _ = write!(out, "\n{}", cleats(track));
    }
    let _ = write!(out, "\n{}", gaps(of));
    for finding in &of.answer.discovery.findings {
        let known = finding.parameters.iter().filter(|parameter| parameter.2.is_finite());
        let values: Vec<String> = known
            .map(|(name, value, error)| format!("{name} = {} ± {}", number(*value, 4), number(*error, 2)))
            .collect();
        let _ = writeln!(out, "\n{} at {}: {}", finding.effect, finding.at, values.join(", "));
    }
    if let Some(file) = of.answer.model.as_ref().and_then(|model| model.file.as_ref()) {
        let _ = writeln!(out, "model:  {}", file.display());
    }
    let _ = writeln!(out, "report: {}", folder.join("report.html").display());
    out
}

fn fits(of: &Summary) -> String {
    let mut table = Table::new(["rig_fit", "magnitude_%", "worst_%", "phase_%"]);
    for (role, percent) in &of.fit {
        let numbers = [percent.mean_magnitude, percent.worst_magnitude, percent.mean_phase];
        let cells = numbers.map(|value| format!("{value:.1}"));
        table.row(std::iter::once(role.to_string()).chain(cells).collect());
    }
    table.text()
}

fn cleats(of: &Track) -> String {
    let mut table = Table::new([
        "cleat_error_%",
        "peak_before",
        "peak_after",
        "shake_before",
        "shake_after",
    ]);
    for (name, before) in &of.before.compared.summary {
        let after = of.after.as_ref().and_then(|driven| driven.compared.summary.get(name));
        let peak = |of: Option<&Sizes>| median(of.and_then(|sizes| sizes.peak));
        let shake = |of: Option<&Sizes>| median(of.and_then(|sizes| sizes.after_shake));
        let cells = [peak(Some(before)), peak(after), shake(Some(before)), shake(after)];
        table.row(std::iter::once(name.clone()).chain(cells).collect());
    }
    table.text()
}

fn median(of: Option<qcar_runtime::compare::Summary>) -> String {
    of.map_or("-".into(), |summary| format!("{:.1}", 100.0 * summary.median))
}

fn gaps(of: &Study) -> String {
    let (before, after) = (&of.answer.discovery.before.gap, &of.answer.discovery.after.gap);
    let mut table = Table::new(["gap_over_noise", "before", "after"]);
    for (name, before, after) in [
        ("fit", before.fit, after.fit),
        ("held_out", before.held_out, after.held_out),
    ] {
        if before.is_finite() {
            table.row(vec![name.into(), number(before, 3), number(after, 3)]);
        }
    }
    table.text()
}
