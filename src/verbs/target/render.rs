//! The result as text.

use std::collections::BTreeMap;
use std::fmt::Write;

use qcar_runtime::campaign::unit_of_fact;
use qcar_runtime::model::About;
use qcar_runtime::response::parameters::Values;

use super::design_uncertainty::DesignUncertainty;
use super::gather::{Answer, FrontAnswer, SpaceAnswer, Target};
use crate::table::{Table, counted, noted, number, or_dash};
use crate::units;
use crate::verbs::sensitivity::render::reach;

/// Least share in a conflict of a target that is met and named.
const LEAST_SHARE: f64 = 0.01;

/// As text for the terminal.
pub(super) fn text(of: &Answer) -> String {
    let mut out = format!("{} ({})\n", of.subject, of.model);
    out += &noted(&of.notices);
    out += "\n";
    out += &verdict(of);
    out += &of.uncertainty.as_ref().map_or(String::new(), sureness);
    out += "\n";
    out += &targets(of).text();
    out += "\n";
    out += &parameters(of).text();
    if let Some(space) = &of.space {
        out += &space_words(space);
    } else if !of.met {
        out += "\nNo solution space: no design meets the targets.\n";
    }
    if let Some(front) = &of.front {
        out += &front_words(of, front);
    }
    out
}

fn verdict(of: &Answer) -> String {
    if of.met {
        let has_wishes = of.targets.iter().any(|own| own.wish.is_some());
        let targets = if has_wishes {
            "targets that must hold"
        } else {
            "targets"
        };
        return format!("All {targets} are met at a cost of {}.\n", number(of.cost, 3));
    }
    let mut missed: Vec<&Target> = of.targets.iter().filter(|own| !own.met && own.wish.is_none()).collect();
    missed.sort_by(|a, b| b.multiplier.total_cmp(&a.multiplier));
    let named = |own: &Target| {
        let run = own.run.as_ref().map_or(String::new(), |run| format!(" on {run}"));
        format!("{}{run}", own.metric)
    };
    let words = missed.iter().take(3);
    let words = words.map(|own| format!("{}, missed by {} %", named(own), number(100.0 * own.excess, 2)));
    let limiting = of.targets.iter().filter(|own| own.met && own.multiplier >= LEAST_SHARE);
    let limiting: Vec<String> = limiting.map(named).collect();
    let bounds = of
        .parameters
        .iter()
        .filter_map(|own| Some(format!("{} ({})", own.name, own.at_bound?)));
    let bounds: Vec<String> = bounds.collect();
    let mut out = format!(
        "No design was found that meets all targets; the best misses {} of {}. In conflict: {}.\n",
        missed.len(),
        of.targets.len(),
        words.collect::<Vec<_>>().join("; ")
    );
    if !limiting.is_empty() {
        let _ = writeln!(out, "Met, but in the way of these: {}.", limiting.join("; "));
    }
    if !bounds.is_empty() {
        let _ = writeln!(out, "At an end of their range: {}.", bounds.join(", "));
    }
    out
}

/// How often the design meets its targets with uncertain parameters.
fn sureness(of: &DesignUncertainty) -> String {
    let words = of.parameters.0.iter().filter(|(_, names)| !names.is_empty());
    let words: Vec<String> = words
        .map(|(source, names)| format!("{source} ({})", names.join(", ")))
        .collect();
    let wanted = of.wanted.map_or(String::new(), |wanted| {
        format!(" Each shall hold with {} %.", number(100.0 * wanted, 3))
    });
    format!(
        "With uncertain parameters, the design meets all targets that must hold in {} % of {} draws.{wanted} Sources of uncertainty: {}.\n",
        number(100.0 * of.all, 3),
        of.draws,
        words.join(", ")
    )
}

fn targets(of: &Answer) -> Table {
    let is_uncertain = of.uncertainty.is_some();
    let uncertainty: &[&str] = if is_uncertain { &["± (95 %)", "holds %"] } else { &[] };
    let headings = ["target", "run", "limit", "unit", "today", "design"]
        .iter()
        .chain(uncertainty);
    let headings = headings.chain(&["met", "multiplier", "in space %"]);
    let mut table = Table::with_headings(headings.map(|own| own.to_string()).collect());
    for own in &of.targets {
        let shown = |value: f64| number(units::value(value, &own.unit), 4);
        let sign = if own.sense == "at_most" { "≤" } else { "≥" };
        let met = match (own.met, own.wish) {
            (true, None) => "yes",
            (true, Some(_)) => "yes (wish)",
            (false, None) => "no",
            (false, Some(_)) => "wish missed",
        };
        let mut row = vec![
            own.metric.clone(),
            own.run.clone().unwrap_or_default(),
            format!("{sign} {}", shown(own.limit)),
            units::name(&own.unit).into(),
            shown(own.today),
            shown(own.design),
        ];
        if is_uncertain {
            let uncertainty = own.uncertainty.as_ref();
            row.push(uncertainty.map_or("-".into(), |uncertainty| reach(own.design, uncertainty, &own.unit)));
            row.push(or_dash(own.holds.map(|share| 100.0 * share), 3));
        }
        row.extend([
            met.into(),
            number(own.multiplier, 2),
            or_dash(own.in_space.map(|share| 100.0 * share), 3),
        ]);
        table.row(row);
    }
    table
}

fn parameters(of: &Answer) -> Table {
    let mut table = Table::new([
        "parameter",
        "unit",
        "range",
        "today",
        "design",
        "change %",
        "solution space",
    ]);
    for own in &of.parameters {
        let shown = |value: f64| number(units::value(value, &own.unit), 4);
        let span = |[low, high]: [f64; 2]| format!("{} … {}", shown(low), shown(high));
        table.row(vec![
            own.name.clone(),
            units::name(&own.unit).into(),
            span(own.range),
            shown(own.today),
            shown(own.design),
            number(100.0 * (own.design / own.today - 1.0), 3),
            own.interval.map_or("-".into(), span),
        ]);
    }
    table
}

fn space_words(of: &SpaceAnswer) -> String {
    let percent = |part: f64| number(100.0 * part, 3);
    let judged = format!(
        "\nIn the solution space {} % of the designs meet all targets (at least {} % with 95 % confidence; wanted: {} %). It \
         contains {} % of all designs in range ({} evaluated).\n",
        percent(of.probability),
        percent(of.at_least),
        percent(of.wanted),
        percent(of.volume),
        counted(of.evaluated, "design")
    );
    let short = "This is less than wanted: loosen targets or narrow ranges.\n";
    judged + if of.at_least < of.wanted { short } else { "" }
}

/// Largest number of printed rows of the front.
const ROWS: usize = 12;

fn front_words(of: &Answer, front: &FrontAnswer) -> String {
    if front.points.is_empty() {
        return "\nNo front: no design is found that meets all targets.\n".into();
    }
    let headings = front
        .metrics
        .iter()
        .map(|metric| units::heading(&metric.name, &metric.unit));
    let names = of.parameters.iter().map(|own| units::heading(&own.name, &own.unit));
    let mut table = Table::with_headings(headings.chain(names).chain(["cost".into()]).collect());
    let every = front.points.len().div_ceil(ROWS).max(1);
    for point in front.points.iter().step_by(every) {
        let values = point
            .values
            .iter()
            .zip(&front.metrics)
            .map(|(value, metric)| number(units::value(*value, &metric.unit), 4));
        let own = point
            .parameters
            .0
            .iter()
            .zip(&of.parameters)
            .map(|((_, value), own)| number(units::value(*value, &own.unit), 4));
        table.row(values.chain(own).chain([number(point.cost, 3)]).collect());
    }
    let designs = counted(front.points.len(), "design");
    let none = match front.points.len() {
        1 => "no other is better in every metric",
        _ => "none is better than another in every metric",
    };
    format!(
        "\nFront of {designs}: {none} (means over the runs):\n\n{}",
        table.text()
    )
}

/// A parameter file for `--params`, with the values and the vehicle data.
pub(super) fn parameter_file(about: &About, design: &Values, vehicle: &BTreeMap<String, f64>) -> String {
    let mut out = format!("# {}: the design that meets its targets\n\n[parameters]\n", about.name);
    for (place, (own, value)) in about.parameters.iter().zip(design.as_slice()).enumerate() {
        if design.leader(place) == place {
            let _ = writeln!(out, "{} = {value:?} # {}", own.name, own.unit);
        }
    }
    if !vehicle.is_empty() {
        out += "\n[vehicle]\n";
    }
    for (name, value) in vehicle {
        let unit = unit_of_fact(name).map_or(String::new(), |unit| format!(" # {unit}"));
        let _ = writeln!(out, "{name} = {value:?}{unit}");
    }
    out
}
