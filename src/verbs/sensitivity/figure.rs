//! Figures of sensitivities: a tornado plot for each metric, and a heat map of all.

use std::fmt::Write;

use super::gather::{MetricResult, Sensitivity};
use super::render::{by_weight, known};
use crate::figure::{CSS, escaped, text};

/// Number of bars of a tornado plot.
const BARS: usize = 8;
/// Width of a tornado plot without its names, and its height.
const PANEL: [f64; 2] = [220.0, 210.0];
const COLUMNS: usize = 3;
/// Least width of the names of parameters, and the width of a letter of the longest name.
const LABELS: f64 = 110.0;
const LETTER: f64 = 7.0;
const ROW: f64 = 20.0;
/// Size of a cell of the heat map.
const CELL: [f64; 2] = [64.0, 20.0];
/// Height for the names of metrics, which are vertical.
const HEAD: f64 = 170.0;

/// The figure as SVG.
pub(super) fn svg(of: &Sensitivity) -> String {
    let labels = labels(of);
    let panel = [labels + PANEL[0], PANEL[1]];
    let rows = of.metrics.len().div_ceil(COLUMNS) as f64;
    let order = by_weight(of);
    let heat = HEAD + CELL[1] * order.len() as f64;
    let width = (panel[0] * COLUMNS as f64).max(labels + 20.0 + CELL[0] * of.metrics.len() as f64);
    let height = 40.0 + rows * PANEL[1] + heat + 20.0;
    let title = format!("{}: percent of a metric per percent of a parameter", of.subject);
    let mut out = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width} {height}\" width=\"{width}\" height=\"{height}\" \
         role=\"img\">\n<title>{}</title>\n<style>{CSS}.up{{fill:#0068b5}}.down{{fill:#c77700}}</style>\n",
        escaped(&title)
    );
    text(&mut out, 10.0, 20.0, "start", "title", &title);
    for (at, metric) in of.metrics.iter().enumerate() {
        let (left, top) = (
            panel[0] * (at % COLUMNS) as f64,
            40.0 + PANEL[1] * (at / COLUMNS) as f64,
        );
        let _ = writeln!(out, "<g transform=\"translate({left} {top})\">");
        tornado(&mut out, metric, labels);
        out.push_str("</g>\n");
    }
    let _ = writeln!(out, "<g transform=\"translate(0 {})\">", 40.0 + rows * PANEL[1]);
    heat_map(&mut out, of, &order, labels);
    out.push_str("</g>\n</svg>\n");
    out
}

/// Width of the names of all parameters.
fn labels(of: &Sensitivity) -> f64 {
    let letters = of.parameters.iter().map(|own| own.name.chars().count()).max();
    LABELS.max(12.0 + LETTER * letters.unwrap_or(0) as f64)
}

/// A tornado plot: the parameters with the largest elasticities of a metric.
fn tornado(out: &mut String, metric: &MetricResult, labels: f64) {
    let mut bars: Vec<&(String, f64)> = metric
        .elasticities
        .0
        .iter()
        .filter(|(_, own)| own.is_finite())
        .collect();
    bars.sort_by(|a, b| b.1.abs().total_cmp(&a.1.abs()));
    bars.truncate(BARS);
    let most = bars.first().map_or(1.0, |bar| bar.1.abs()).max(f64::MIN_POSITIVE);
    text(out, labels, 12.0, "start", "title", &metric.name);
    let middle = labels + (PANEL[0] - 20.0) / 2.0;
    for (at, (name, value)) in bars.iter().enumerate() {
        let y = 22.0 + ROW * at as f64;
        let length = (PANEL[0] - 90.0) / 2.0 * value.abs() / most;
        let (x, class) = if *value < 0.0 {
            (middle - length, "down")
        } else {
            (middle, "up")
        };
        text(out, labels - 6.0, y + 12.0, "end", "", name);
        let _ = writeln!(
            out,
            "<rect class=\"{class}\" x=\"{x:.1}\" y=\"{y:.1}\" width=\"{length:.1}\" height=\"{}\"/>",
            ROW - 5.0
        );
        let (at, anchor) = if *value < 0.0 {
            (x - 4.0, "end")
        } else {
            (x + length + 4.0, "start")
        };
        text(out, at, y + 12.0, anchor, "", &format!("{value:.2}"));
    }
    let _ = writeln!(
        out,
        "<path class=\"grid\" d=\"M{middle:.1} 18V{:.1}\"/>",
        22.0 + ROW * bars.len() as f64
    );
}

/// A heat map: a row for each parameter, a column for each metric.
fn heat_map(out: &mut String, of: &Sensitivity, order: &[usize], labels: f64) {
    for (column, metric) in of.metrics.iter().enumerate() {
        let x = labels + 10.0 + CELL[0] * (column as f64 + 0.5);
        let _ = writeln!(
            out,
            "<text transform=\"translate({:.1} {}) rotate(-60)\">{}</text>",
            x,
            HEAD - 8.0,
            escaped(&metric.name)
        );
    }
    for (row, &k) in order.iter().enumerate() {
        let y = HEAD + CELL[1] * row as f64;
        text(out, labels + 4.0, y + 14.0, "end", "", &of.parameters[k].name);
        for (column, metric) in of.metrics.iter().enumerate() {
            let Some(value) = known(metric, k) else { continue };
            let x = labels + 10.0 + CELL[0] * column as f64;
            let _ = writeln!(
                out,
                "<rect class=\"{}\" fill-opacity=\"{:.2}\" x=\"{x:.1}\" y=\"{y:.1}\" width=\"{}\" height=\"{}\"/>",
                if value < 0.0 { "down" } else { "up" },
                value.abs().min(1.0) * 0.85,
                CELL[0] - 2.0,
                CELL[1] - 2.0
            );
            text(out, x + CELL[0] / 2.0, y + 13.0, "middle", "", &format!("{value:.2}"));
        }
    }
}
