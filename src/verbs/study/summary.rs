//! Summary of a study, for the head of the report and the terminal.

use std::collections::BTreeMap;
use std::fmt::Write;
use std::path::Path;

use qcar_runtime::discover::answer::Verdict;
use qcar_runtime::fit::quality::Quality;
use serde::Serialize;

use super::gather::{Study, Track};
use super::rig::Ratio;
use crate::table::{Table, number, or_dash};
use crate::units;
use crate::verbs::discover::verdict::{choice, sentence};
use crate::verbs::simulate::comparison::Sizes;

/// The summary.
#[derive(Serialize)]
pub struct Summary {
    /// The verdict as a sentence.
    pub missing: String,
    /// The verdict: `none`, `found`, `class`, `unknown`.
    pub verdict: Verdict,
    /// Mean fit percentages of the channels of the fitted and of the held-out runs.
    pub rig_fit: BTreeMap<&'static str, Percent>,
}

/// Values of the fitted model, and of the extended model.
#[derive(Serialize)]
pub struct Percent {
    magnitude: BeforeAfter,
    phase: BeforeAfter,
}

#[derive(Serialize)]
struct BeforeAfter {
    before: f64,
    after: Option<f64>,
}

/// Summary of a study with these ratios.
pub fn summary(of: &Study, ratios: &[Ratio]) -> Summary {
    let roles = ["fit", "held_out"].into_iter();
    Summary {
        missing: sentence(&of.answer),
        verdict: of.answer.discovery.verdict,
        rig_fit: roles.filter_map(|role| Some((role, percent(ratios, role)?))).collect(),
    }
}

fn percent(of: &[Ratio], role: &str) -> Option<Percent> {
    let of: Vec<&Ratio> = of.iter().filter(|ratio| ratio.role == role).collect();
    let both = |value: fn(&Quality) -> f64| {
        let before: f64 = of.iter().map(|ratio| value(&ratio.quality_before)).sum();
        let after: Option<f64> = of.iter().map(|ratio| ratio.quality_after.as_ref().map(value)).sum();
        BeforeAfter {
            before: before / of.len() as f64,
            after: after.map(|after| after / of.len() as f64),
        }
    };
    (!of.is_empty()).then(|| Percent {
        magnitude: both(|quality| quality.fit_magnitude),
        phase: both(|quality| quality.fit_phase),
    })
}

/// Text for the terminal.
pub fn text(of: &Study, summary: &Summary, folder: &Path) -> String {
    let mut out = format!("{}: {}\n", of.fitted.campaign.name, summary.missing);
    if !summary.rig_fit.is_empty() {
        let _ = write!(out, "\n{}", fits(summary));
    }
    if let Some(track) = &of.track {
        let _ = write!(out, "\n{}{}", cleats(track), at_start(&track.at_start));
    }
    let _ = write!(out, "\n{}", residuals(of));
    for (place, (finding, of_names)) in of.answer.discovery.findings.iter().zip(&of.answer.units).enumerate() {
        let known = finding.parameters.iter().filter(|parameter| parameter.2.is_finite());
        let value = |(name, value, error): &(String, f64, f64)| {
            let si = of_names.get(name).map_or("1", String::as_str);
            let [value, error] = [value, error].map(|value| units::value(*value, si));
            units::with_unit(&format!("{name} = {} ± {}", number(value, 4), number(error, 2)), si)
        };
        let values: Vec<String> = known.map(value).collect();
        let (choice, values) = (choice(&of.answer.discovery.findings, place), values.join(", "));
        let _ = writeln!(out, "\n{choice}{} at {}: {values}", finding.effect, finding.at);
    }
    if let Some(file) = of.answer.model.as_ref().and_then(|model| model.file.as_ref()) {
        let _ = writeln!(out, "model:  {}", file.display());
    }
    let _ = writeln!(out, "report: {}", folder.join("report.html").display());
    out
}

fn fits(of: &Summary) -> String {
    let mut table = Table::new([
        "rig_fit_%",
        "magnitude_before",
        "magnitude_after",
        "phase_before",
        "phase_after",
    ]);
    for (role, percent) in &of.rig_fit {
        let cells = [&percent.magnitude, &percent.phase].into_iter().flat_map(|own| {
            let after = own.after.map_or("-".into(), |after| format!("{after:.1}"));
            [format!("{:.1}", own.before), after]
        });
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

/// Names parameters that no rig run determines: the rides of the rig fit use their start values.
fn at_start(names: &[String]) -> String {
    let (keeps, them) = if names.len() == 1 {
        ("keeps its start value", "it")
    } else {
        ("keep their start values", "them")
    };
    match names {
        [] => String::new(),
        names => format!("before: {} {keeps} (no rig run determines {them})\n", names.join(", ")),
    }
}

fn median(of: Option<qcar_runtime::compare::Summary>) -> String {
    of.map_or("-".into(), |summary| format!("{:.1}", 100.0 * summary.median))
}

fn residuals(of: &Study) -> String {
    let (before, after) = (&of.answer.discovery.before.misfit, &of.answer.discovery.after.misfit);
    let changed = !of.answer.discovery.findings.is_empty();
    let mut table = Table::new(["residual_in_sd", "before", "after"]);
    for (name, before, after) in [
        ("fit", before.fit, after.fit),
        ("held_out", before.held_out, after.held_out),
    ] {
        if before.is_finite() {
            table.row(vec![
                name.into(),
                number(before, 3),
                or_dash(changed.then_some(after), 3),
            ]);
        }
    }
    table.text()
}
