//! Sensitivities as text and CSV.

use std::fmt::Write;

use super::gather::{MetricResult, Sensitivity, UncertainMetric};
use crate::table::{Table, counted, noted, number, or_dash};
use crate::units;

/// As text for the terminal.
pub(super) fn text(of: &Sensitivity) -> String {
    let mut out = format!("{}: {}\n", of.subject, runs(of));
    out += &noted(&of.notices);
    if of.metrics.is_empty() {
        let why = match of.runs.is_empty() {
            true => {
                "No metric has a value: a mode must vibrate, a channel needs damping, and a ride needs a rolling tyre"
            }
            false => "It has no metric that could be measured on these runs",
        };
        return format!("{out}{why}.\n");
    }
    if of.parameters.is_empty() {
        return out
            + "No parameter can vary: all are known or zero; name some with --parameters.\n\n"
            + &values(of).text();
    }
    out += "Elasticities: percent of a metric per percent of a parameter, the largest first.\n\n";
    out += &tables(of, |metric, k| or_dash(known(metric, k), 2));
    out += "\n";
    out += &values(of).text();
    if let Some(global) = &of.global {
        let _ = write!(
            out,
            "\nShare of the variance in percent, alone / with others, over ± {} % of each parameter ({}",
            number(100.0 * global.spread, 3),
            counted(global.designs, "design")
        );
        let _ = writeln!(out, "{}).\n", failed(global.failed));
        let share = |metric: &MetricResult, k: usize| match &metric.sobol {
            Some(sobol) => format!("{:.0} / {:.0}", 100.0 * sobol.0[k].1.first, 100.0 * sobol.0[k].1.total),
            None => "-".into(),
        };
        out += &tables(of, share);
    }
    out
}

/// The elasticity of a metric, if it has one.
pub(super) fn known(metric: &MetricResult, k: usize) -> Option<f64> {
    Some(metric.elasticities.0[k].1).filter(|own| own.is_finite())
}

fn failed(count: usize) -> String {
    match count {
        0 => String::new(),
        count => format!(", {count} of the base designs could not be simulated and are left out"),
    }
}

fn runs(of: &Sensitivity) -> String {
    match of.runs.len() {
        0 => format!("{}, without rides", of.model),
        1 => format!("{} over 1 run", of.model),
        count => format!("{}, metrics of rides are means over {count} runs", of.model),
    }
}

/// Number of metrics side by side.
const ACROSS: usize = 8;

/// Tables with a row for each parameter and a column for each metric, as many as the metrics need.
fn tables(of: &Sensitivity, cell: impl Fn(&MetricResult, usize) -> String) -> String {
    let order = by_weight(of);
    let table = |metrics: &[MetricResult]| {
        let names = metrics.iter().map(|metric| metric.name.clone());
        let mut table = Table::with_headings(std::iter::once("parameter".into()).chain(names).collect());
        for &k in &order {
            let cells = metrics.iter().map(|metric| cell(metric, k));
            table.row(std::iter::once(of.parameters[k].name.clone()).chain(cells).collect());
        }
        table.text()
    };
    of.metrics.chunks(ACROSS).map(table).collect::<Vec<_>>().join("\n")
}

/// Positions of the parameters, by their largest elasticity of any metric.
pub(super) fn by_weight(of: &Sensitivity) -> Vec<usize> {
    let weight = |k: usize| {
        of.metrics
            .iter()
            .map(|metric| metric.elasticities.0[k].1.abs())
            .fold(0.0, f64::max)
    };
    let mut order: Vec<usize> = (0..of.parameters.len()).collect();
    order.sort_by(|a, b| weight(*b).total_cmp(&weight(*a)));
    order
}

fn values(of: &Sensitivity) -> Table {
    let mut table = Table::new(["metric", "value", "unit", "± (95 %)", "most of that by"]);
    for metric in &of.metrics {
        let shown = |value: f64| number(units::value(value, &metric.unit), 4);
        let uncertainty = metric.uncertainty.as_ref();
        table.row(vec![
            metric.name.clone(),
            shown(metric.value),
            units::name(&metric.unit).into(),
            uncertainty.map_or("-".into(), |uncertainty| reach(metric.value, uncertainty, &metric.unit)),
            uncertainty.map_or("-".into(), |uncertainty| largest(&uncertainty.shares.0)),
        ]);
    }
    table
}

/// The interval of a value, with the difference of its mean if that is visible.
pub(crate) fn reach(value: f64, uncertainty: &UncertainMetric, unit: &str) -> String {
    const SEEN: f64 = 0.02;
    let [low, high] = uncertainty.interval;
    let (shift, reach) = (0.5 * (low + high) - value, 0.5 * (high - low));
    let shown = |value: f64| number(units::value(value, unit), 2);
    match shift.abs() > SEEN * reach {
        true => format!(
            "{}{} ± {}",
            if shift < 0.0 { "−" } else { "+" },
            shown(shift.abs()),
            shown(reach)
        ),
        false => shown(reach),
    }
}

/// The two parameters with the largest shares.
fn largest(shares: &[(String, f64)]) -> String {
    let mut order: Vec<&(String, f64)> = shares.iter().filter(|(_, share)| *share > 0.005).collect();
    order.sort_by(|a, b| b.1.total_cmp(&a.1));
    let words = order
        .iter()
        .take(2)
        .map(|(name, share)| format!("{name} {:.0} %", 100.0 * share));
    words.collect::<Vec<_>>().join(", ")
}

/// A row for each metric and parameter.
pub(super) fn csv(of: &Sensitivity) -> String {
    let mut out = String::from(
        "metric,metric_unit,metric_value,parameter,parameter_unit,parameter_value,elasticity,share_of_variance,sobol_first,sobol_total\n",
    );
    for metric in &of.metrics {
        for (k, parameter) in of.parameters.iter().enumerate() {
            let share = metric.uncertainty.as_ref().map(|uncertainty| uncertainty.shares.0[k].1);
            let sobol = metric.sobol.as_ref().map(|sobol| sobol.0[k].1);
            let optional = |value: Option<f64>| value.map_or(String::new(), |value| value.to_string());
            let _ = writeln!(
                out,
                "{},{},{},{},{},{},{},{},{},{}",
                metric.name,
                units::name(&metric.unit),
                units::value(metric.value, &metric.unit),
                parameter.name,
                units::name(&parameter.unit),
                units::value(parameter.value, &parameter.unit),
                optional(known(metric, k)),
                optional(share),
                optional(sobol.map(|sobol| sobol.first)),
                optional(sobol.map(|sobol| sobol.total)),
            );
        }
    }
    out
}
