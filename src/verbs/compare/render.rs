//! A comparison as text and CSV.

use std::collections::BTreeMap;
use std::fmt::Write;
use std::path::Path;

use super::contents::{Changes, Result, Spread};
use super::gather::Comparison;
use super::modes::Pair;
use super::parameters::Parameter;
use super::ratios::Largest;
use crate::table::{Table, noted, number, or_dash};
use crate::units;
use crate::verbs::study::shapes::Shape;

/// The text for the terminal.
pub(super) fn text(of: &Comparison, result: &Result, folder: Option<&Path>) -> String {
    let [a, b] = [&result.a, &result.b];
    let models = match a.model == b.model {
        true => format!("model {}", a.model),
        false => format!("models {} and {}", a.model, b.model),
    };
    let mut out = format!("{} (A) and {} (B), {models}\n", a.name, b.name);
    let sections = [
        parameters(&of.parameters),
        modes(&of.modes),
        of.difference
            .to_string()
            .lines()
            .next()
            .map_or(String::new(), |_| changes(of)),
        transmissibility(result),
        gradients(of),
        cleat("cleat_change_%", Some(&result.cleat.summary)),
        cleat("measured_change_%", result.cleat.measured.as_ref()),
        noted(&of.notices),
    ];
    for section in sections.iter().filter(|section| !section.is_empty()) {
        let _ = write!(out, "\n{section}");
    }
    if let Some(folder) = folder {
        let _ = write!(out, "\nreport: {}\n", folder.join("report.html").display());
    }
    out
}

/// Parameters that differ, and the number of the others.
fn parameters(of: &[Parameter]) -> String {
    let own: Vec<&Parameter> = of.iter().filter(|own| own.tied_to.is_none()).collect();
    let shown: Vec<&&Parameter> = own.iter().filter(|own| own.differs()).collect();
    if shown.is_empty() {
        return "all parameters are equal\n".into();
    }
    let mut table = Table::new([
        "parameter",
        "unit",
        "A",
        "B",
        "difference",
        "change_%",
        "standard_errors",
    ]);
    for own in &shown {
        let shown = |value| units::value(value, &own.unit);
        table.row(vec![
            own.name.clone(),
            units::name(&own.unit).into(),
            or_dash(own.a.map(shown), 5),
            or_dash(own.b.map(shown), 5),
            or_dash(own.difference.map(shown), 4),
            percent(own.relative),
            or_dash(own.standard_errors, 3),
        ]);
    }
    let rest = match own.len() - shown.len() {
        0 => String::new(),
        equal => format!("equal: {equal} other parameters\n"),
    };
    table.text() + &rest
}

fn modes(of: &[Pair]) -> String {
    if of.is_empty() {
        return String::new();
    }
    let mut table = Table::new([
        "A_mode",
        "B_mode",
        "A_Hz",
        "B_Hz",
        "change_%",
        "A_damping_%",
        "B_damping_%",
    ]);
    // Each side counts its own modes from the lowest, as the metrics `mode.N.frequency` do.
    let count = |side: fn(&Pair) -> Option<&Shape>, place: usize| {
        let own = side(&of[place])?.frequency;
        let all = of.iter().enumerate();
        let others = all.filter_map(|(at, pair)| Some((at, side(pair)?.frequency)));
        let before = others.filter(|&(at, other)| other < own || other == own && at < place);
        Some((before.count() + 1).to_string())
    };
    for (place, pair) in of.iter().enumerate() {
        let numbers = [
            count(|pair| pair.a.as_ref(), place),
            count(|pair| pair.b.as_ref(), place),
        ];
        let [first, second] = numbers.map(|number| number.unwrap_or("-".into()));
        let [a, b] = [&pair.a, &pair.b].map(|mode| mode.as_ref().map(|mode| (mode.frequency, mode.damping)));
        table.row(vec![
            first,
            second,
            or_dash(a.map(|mode| mode.0), 4),
            or_dash(b.map(|mode| mode.0), 4),
            percent(a.zip(b).map(|(a, b)| b.0 / a.0 - 1.0)),
            percent(a.map(|mode| mode.1)),
            percent(b.map(|mode| mode.1)),
        ]);
    }
    table.text()
}

/// Number of differences between the models; `qcar diff` prints them.
fn changes(of: &Comparison) -> String {
    // Headings are plurals, such as `parameters`.
    let line = |part: &qcar_dsl::difference::Part| match part.changes.len() {
        1 => format!("1 {}", part.heading.strip_suffix('s').unwrap_or(part.heading)),
        count => format!("{count} {}", part.heading),
    };
    let counts: Vec<String> = of.difference.parts.iter().map(line).collect();
    match counts.as_slice() {
        [] => String::new(),
        counts => format!("the models differ in {} (see `qcar diff`)\n", counts.join(", ")),
    }
}

/// Difference of B from A, and the fit of each to the measurement.
fn transmissibility(of: &Result) -> String {
    let all = &of.transmissibility;
    let (measured, fits) = (
        all.iter().any(|own| own.measured.is_some()),
        all.iter().any(|own| own.fit.is_some()),
    );
    let mut headings = vec!["channel", "run", "change_dB", "at_Hz", "rms_dB"];
    headings.extend(["measured_dB", "at_Hz", "rms_dB"].iter().filter(|_| measured));
    headings.extend(["fit_A_%", "fit_B_%"].iter().filter(|_| fits));
    let campaigns = all.iter().map(|own| own.coherence.len()).max().unwrap_or(0);
    headings.extend([&[][..], &["coherence"], &["coherence_A", "coherence_B"]][campaigns]);
    let mut table = Table::with_headings(headings.into_iter().map(String::from).collect());
    for own in all {
        let mut cells = vec![own.channel.into(), own.run.unwrap_or("-").into()];
        cells.extend(change(own.change.as_ref()));
        cells.extend(change(own.measured.as_ref()).into_iter().filter(|_| measured));
        let fits_of = own.fit.map_or([None; 2], |fit| fit.map(Some));
        cells.extend(
            fits_of
                .map(|fit| fit.map_or("-".into(), |fit| format!("{fit:.1}")))
                .into_iter()
                .filter(|_| fits),
        );
        cells.extend((0..campaigns).map(|place| or_dash(own.coherence.get(place).copied(), 4)));
        table.row(cells);
    }
    if all.is_empty() { String::new() } else { table.text() }
}

fn change(of: Option<&Largest>) -> [String; 3] {
    let of = of.map(|own| [own.magnitude, own.frequency, own.rms]);
    of.map_or(["-".into(), "-".into(), "-".into()], |own| {
        own.map(|value| number(value, 3))
    })
}

fn gradients(of: &Comparison) -> String {
    if of.gradients.is_empty() {
        return String::new();
    }
    let mut table = Table::new(["curve", "quantity", "unit", "A", "B", "change_%", "standard_errors"]);
    for own in &of.gradients {
        let shown = |value| units::value(value, own.unit);
        table.row(vec![
            own.test.into(),
            own.quantity.into(),
            units::name(own.unit).into(),
            or_dash(own.a.map(|own| shown(own.value)), 4),
            or_dash(own.b.map(|own| shown(own.value)), 4),
            percent(own.relative),
            or_dash(own.standard_errors, 3),
        ]);
    }
    table.text()
}

fn cleat(heading: &str, of: Option<&BTreeMap<String, Changes>>) -> String {
    let Some(summary) = of.filter(|summary| !summary.is_empty()) else {
        return String::new();
    };
    let mut table = Table::new([
        heading,
        "peak_least",
        "peak_median",
        "peak_greatest",
        "shake_least",
        "shake_median",
        "shake_greatest",
    ]);
    for (name, changes) in summary {
        let cells = [changes.peak, changes.after_shake].into_iter().flat_map(three);
        table.row(std::iter::once(name.clone()).chain(cells).collect());
    }
    table.text()
}

fn three(of: Option<Spread>) -> [String; 3] {
    let own = |value: fn(&Spread) -> f64| percent(of.as_ref().map(value));
    [own(|own| own.least), own(|own| own.median), own(|own| own.greatest)]
}

fn percent(share: Option<f64>) -> String {
    let finite = share.filter(|share| share.is_finite());
    // Avoids a negative zero after rounding.
    let tenths = |share: f64| (1000.0 * share).round() / 10.0 + 0.0;
    finite.map_or("-".into(), |share| format!("{:.1}", tenths(share)))
}

/// A cell of a number that may be missing.
fn cell(value: Option<f64>) -> String {
    let finite = value.filter(|value| value.is_finite());
    finite.map_or(String::new(), |value| value.to_string())
}

/// All parameters.
pub(super) fn parameters_csv(of: &Comparison) -> String {
    let mut out = "parameter,unit,a,b,difference,relative,stderr_a,stderr_b,standard_errors\n".to_string();
    for own in &of.parameters {
        let shown = |value: Option<f64>| value.map(|value| units::value(value, &own.unit));
        let numbers = [
            shown(own.a),
            shown(own.b),
            shown(own.difference),
            own.relative,
            shown(own.stderr_a),
            shown(own.stderr_b),
            own.standard_errors,
        ];
        let unit = units::name(&own.unit);
        let _ = writeln!(out, "{},{unit},{}", own.name, numbers.map(cell).join(","));
    }
    out
}

/// Every channel line by line: decibels, relative to 1 of the unit in which a ratio is shown, and degrees.
pub(super) fn ratios_csv(of: &Comparison) -> String {
    let frequency = units::heading("frequency", "Hz");
    let mut out = format!(
        "run,channel,unit,{frequency},a_dB,a_deg,b_dB,b_deg,measured_a_dB,measured_a_deg,measured_b_dB,measured_b_deg,\
         coherence_a,coherence_b\n"
    );
    for ratio in &of.ratios {
        let run = ratio.run.as_deref().unwrap_or("");
        let measured = |place: usize| ratio.measured.get(place).map(|own| &own.value);
        let polars = [Some(&ratio.a), Some(&ratio.b), measured(0), measured(1)];
        let (unit, shift) = (
            units::decibels(&ratio.unit),
            20.0 * units::value(1.0, &ratio.unit).log10(),
        );
        for (line, frequency) in ratio.frequency.iter().enumerate() {
            let cells = polars.iter().flat_map(|polar| {
                [
                    polar.map(|own| own.magnitude[line] + shift),
                    polar.map(|own| own.phase[line]),
                ]
            });
            let coherences = [0, 1].map(|place| ratio.measured.get(place).map(|own| own.coherence[line]));
            let cells: Vec<String> = cells.chain(coherences).map(cell).collect();
            let frequency = units::value(*frequency, "Hz");
            let _ = writeln!(out, "{run},{},{unit},{frequency},{}", ratio.channel, cells.join(","));
        }
    }
    out
}

/// Peaks and after-shakes, speeds and heights.
pub(super) fn cleat_runs_csv(of: &Comparison) -> String {
    let sides = ["a", "b", "measured_a", "measured_b"];
    let of_metric = |metric: &str| {
        sides
            .map(|side| units::heading(&format!("{metric}_{side}"), "m/s^2"))
            .join(",")
    };
    let mut out = format!(
        "run,{},{},mass,axis,{},{}\n",
        units::heading("speed", "m/s"),
        units::heading("height", "m"),
        of_metric("peak"),
        of_metric("after_shake")
    );
    for cleat_run in &of.cleat_runs {
        for own in &cleat_run.compared.metrics {
            let metric = |of: &super::records::Metric| {
                let measured = |place: usize| of.measured.get(place).copied();
                let shown = |value: Option<f64>| cell(value.map(|value| units::value(value, "m/s^2")));
                [Some(of.a), Some(of.b), measured(0), measured(1)].map(shown).join(",")
            };
            let (peak, shake) = (metric(&own.peak), metric(&own.after_shake));
            let (speed, height) = (
                units::value(cleat_run.speed, "m/s"),
                units::value(cleat_run.height, "m"),
            );
            let name = &cleat_run.name;
            let _ = writeln!(out, "{name},{speed},{height},{},{},{peak},{shake}", own.mass, own.axis);
        }
    }
    out
}
